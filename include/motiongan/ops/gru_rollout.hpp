// A GRU that reads a motion and goes on by itself (Martinez, Black & Romero 2017; SPEC 7.7).
//
// In every step  r, z, n = x_t + [W_h h + b_h],  h' = (1 - z) n + z h  with PyTorch's gates. The first n
// steps see what is given; the last of them and all after it make a pose, a = a_before + h' Wd^T + bd, which
// the next step sees.
#pragma once
#include "motiongan/ops/composed.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// The weights of a rollout; M numbers a pose, k hidden ones.
struct GruRolloutWeights {
  Var recurrent;       ///< W_h [3k, k]
  Var recurrent_bias;  ///< b_h [3k]
  Var pose;            ///< what a pose does to the gates, [3k, M]
  Var diff;            ///< Wd [M, k]
  Var diff_bias;       ///< bd [M]
};

namespace detail {

/// One vector, [n], for each of `rows` rows: [rows, n].
inline Var repeat_rows(const Var& x, std::size_t rows) {
  return expand(x, 1, rows, x.size(), 1, {rows, x.size()});
}

/// gru_rollout out of elementary operations; every derivative exists.
inline Var gru_rollout_composed(const Var& x_gates, const Var& each, const Var& last,
                                const GruRolloutWeights& w, std::size_t frames) {
  const std::size_t given = x_gates.dim(0), batch = x_gates.dim(1), k = w.recurrent.dim(1),
                    dof = w.diff.dim(0);
  const Var h_bias = repeat_rows(w.recurrent_bias, batch), pose_bias = repeat_rows(w.diff_bias, batch);
  Var h = zeros(x_gates.context(), {batch, k}), a = last;
  std::vector<Var> motion;
  for (std::size_t t = 0; t + 1 < given + frames; ++t) {
    const Var x =
        t < given ? reshape(slice(x_gates, 0, t, 1), {batch, 3 * k}) : matmul(a, w.pose, false, true) + each;
    const Var s = matmul(h, w.recurrent, false, true) + h_bias;
    const auto part = [&](const Var& gates, std::size_t i) { return slice(gates, 1, i * k, k); };
    const Var r = sigmoid(part(x, 0) + part(s, 0)), z = sigmoid(part(x, 1) + part(s, 1)),
              n = tanh(part(x, 2) + r * part(s, 2));
    h = n + z * (h - n);
    if (t + 1 < given) continue;
    a = a + matmul(h, w.diff, false, true) + pose_bias;
    motion.push_back(reshape(a, {1, batch, dof}));
  }
  return concat_axis(motion, 0);
}

}  // namespace detail

/// The `frames` poses [frames, B, M] that follow `last` [B, M]. `x_gates` [n, B, 3k] is W_i x + b_i of the
/// poses given, `last` among them; `each` [B, 3k] what the gates of every later step see beside the pose.
/// The state begins at zero.
inline Var gru_rollout(const Var& x_gates, const Var& each, const Var& last, const GruRolloutWeights& w,
                       std::size_t frames) {
  const std::size_t k = w.recurrent.dim(1), dof = w.diff.dim(0), batch = last.dim(0);
  require(x_gates.value().rank() == 3 && x_gates.dim(0) > 0 && frames > 0 && x_gates.dim(1) == batch &&
              x_gates.dim(2) == 3 * k && each.shape() == Shape{batch, 3 * k} &&
              last.shape() == Shape{batch, dof} && w.recurrent.dim(0) == 3 * k &&
              w.pose.shape() == Shape{3 * k, dof} && w.diff.dim(1) == k,
          "gru_rollout: gates ", x_gates.shape(), " and ", each.shape(), ", last pose ", last.shape(),
          ", weights ", w.recurrent.shape(), ", ", w.pose.shape(), ", ", w.diff.shape(), ", ", frames,
          " frames");
  return detail::gru_rollout_composed(x_gates, each, last, w, frames);
}

}  // namespace motiongan
