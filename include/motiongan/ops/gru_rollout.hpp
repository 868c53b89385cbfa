// Autoregressive rollout of a GRU with residual pose output (Martinez, Black & Romero 2017).
//
// Every step is a GRU step in PyTorch's convention (see Gru). The first n steps read the given poses; the
// last of them and all later ones predict a pose, a_t = a_{t-1} + h_t Wd^T + bd, which the next step reads.
#pragma once
#include "motiongan/ops/fused.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// The weights of gru_rollout, for poses of M dimensions and hidden size k.
struct GruRolloutWeights {
  Var recurrent;       ///< W_h [3k, k]
  Var recurrent_bias;  ///< b_h [3k]
  Var pose;            ///< from a pose to the gates, [3k, M]
  Var diff;            ///< Wd [M, k]
  Var diff_bias;       ///< bd [M]
};

namespace detail {

/// gru_rollout composed of elementary operations, with derivatives of every order.
inline Var gru_rollout_composed(const Var& x_gates, const Var& each, const Var& last,
                                const GruRolloutWeights& w, std::size_t frames) {
  const std::size_t given = x_gates.dim(0), batch = x_gates.dim(1), k = w.recurrent.dim(1),
                    dof = w.diff.dim(0);
  const Var h_bias = broadcast_to(w.recurrent_bias, {batch, 3 * k}),
            pose_bias = broadcast_to(w.diff_bias, {batch, dof});
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
  return concatenate(motion, 0);
}

/// What the forward pass keeps for the backward pass. S = n - 1 + frames steps.
struct GruTrace {
  std::size_t given, frames, batch, dof, k;
  Tensor states;  // initial h and h after every step, [S + 1, B, k]
  Tensor kept;    // r, z, n and W_h h + b_h of gate n, [S, B, 4k]
  Tensor poses;   // the last given pose, then the predicted ones, [frames + 1, B, M]

  std::size_t steps() const { return given - 1 + frames; }
  std::size_t state_at(std::size_t t) const { return t * batch * k; }
  std::size_t gates_at(std::size_t t) const { return t * batch * 3 * k; }
  std::size_t pose_at(std::size_t j) const { return j * batch * dof; }
  LaunchGrid cells() const { return LaunchGrid::items(batch * vectors(states.context(), k)); }
};

/// rows * W^T if `transposed`, else rows * W, with W [out, in]; the caller sets the offsets and addends.
inline GemmCall product_with(const Tensor& w, bool transposed, std::size_t rows) {
  GemmCall call{.m = rows, .n = w.dim(transposed ? 0 : 1), .k = w.dim(transposed ? 1 : 0), .b = w};
  call.a_ld = call.k, call.b_ld = w.dim(1), call.c_ld = call.residual_ld = call.n;
  call.b_transposed = transposed;
  call.b_panels = pack_b(w.context(), call);  // packed once for all steps
  return call;
}

inline GruTrace gru_rollout_forward(const Tensor& x_gates, const Tensor& each, const Tensor& last,
                                    const GruRolloutWeights& w, std::size_t frames, bool keep) {
  const Context& context = x_gates.context();
  GruTrace t{x_gates.dim(0), frames, last.dim(0), last.dim(1), w.recurrent.dim(1), {}, {}, {}};
  t.states = Tensor(context, {t.steps() + 1, t.batch, t.k});
  t.kept = Tensor(context, {keep ? t.steps() : 1, t.batch, 4 * t.k});
  t.poses = Tensor(context, {frames + 1, t.batch, t.dof});
  fill(t.states.view(0, {t.batch, t.k}), 0);
  copy_tensor(last, t.poses.view(0, last.shape()));
  const Tensor s(context, {t.batch, 3 * t.k}), x(context, {t.batch, 3 * t.k});
  GemmCall recur = product_with(w.recurrent.value(), true, t.batch),
           see = product_with(w.pose.value(), true, t.batch),
           move = product_with(w.diff.value(), true, t.batch);
  recur.a = t.states, recur.c = s, recur.bias = w.recurrent_bias.value();
  see.a = t.poses, see.c = x, see.residual = each;
  move.a = t.states, move.c = move.residual = t.poses, move.bias = w.diff_bias.value();
  for (std::size_t i = 0; i < t.steps(); ++i) {
    if (i >= t.given) {
      see.a_offset[0] = t.pose_at(i - t.given + 1);
      gemm(context, see);
    }
    recur.a_offset[0] = t.state_at(i);
    gemm(context, recur);
    context.launch("gru", "gru_cell", t.cells(),
                   At{i < t.given ? x_gates : x, i < t.given ? t.gates_at(i) : 0, t.gates_at(1)}, s,
                   At{t.states, t.state_at(i), t.state_at(1)},
                   At{t.kept, keep ? 4 * t.state_at(i) : 0, keep ? 4 * t.state_at(1) : 0},
                   static_cast<cl_uint>(keep), At{t.states, t.state_at(i + 1), t.state_at(1)}, t.batch, t.k);
    if (i + 1 < t.given) continue;
    const std::size_t j = i + 1 - t.given;
    move.a_offset[0] = t.state_at(i + 1);
    move.residual_offset = t.pose_at(j);
    move.c_offset = t.pose_at(j + 1);
    gemm(context, move);
  }
  return t;
}

/// Gradients with respect to x_gates, each, last, W_h, b_h, w.pose, Wd and bd, given the gradient g
/// [frames, B, M] of the predicted poses.
inline std::vector<Tensor> gru_rollout_backward(const GruTrace& t, const Node& self, const Tensor& g,
                                                const Needs& needs) {
  const Context& context = g.context();
  const std::size_t steps = t.steps(), own = t.frames - 1;  // steps that read a predicted pose
  const Tensor poses(context, g.shape()), dx(context, {steps, t.batch, 3 * t.k}), ds(context, dx.shape()),
      dh = full(context, {t.batch, t.k}, 0);
  copy_tensor(g, poses);  // accumulates the total gradients
  GemmCall recur = product_with(self.inputs[3].value(), false, t.batch),
           see = product_with(self.inputs[5].value(), false, t.batch),
           move = product_with(self.inputs[6].value(), false, t.batch);
  recur.a = ds, see.a = dx, move.a = poses;
  recur.c = move.c = dh, see.c = see.residual = poses;
  recur.accumulate = see.accumulate = move.accumulate = true;
  for (std::size_t i = steps; i-- > 0;) {
    if (i + 1 >= t.given) {
      const std::size_t j = i + 1 - t.given;
      if (j < own) {  // the next step reads this pose and adds to it
        see.a_offset[0] = t.gates_at(i + 1);
        see.c_offset = t.pose_at(j);
        see.residual_offset = t.pose_at(j + 1);
        gemm(context, see);
      }
      move.a_offset[0] = t.pose_at(j);
      gemm(context, move);
    }
    context.launch("gru", "gru_cell_backward", t.cells(), At{t.kept, 4 * t.state_at(i), 4 * t.state_at(1)},
                   At{t.states, t.state_at(i), t.state_at(1)}, dh, At{dx, t.gates_at(i), t.gates_at(1)},
                   At{ds, t.gates_at(i), t.gates_at(1)}, t.batch, t.k);
    if (i == 0) break;  // the initial state is a constant
    recur.a_offset[0] = t.gates_at(i);
    gemm(context, recur);
  }
  // Weight gradients: one product each over all steps.
  const auto by_weight = [&](const Tensor& gradient, std::size_t first, const Tensor& rows,
                             std::size_t first_row, std::size_t count) {
    GemmCall call{.m = gradient.dim(2), .n = rows.dim(2), .k = count * t.batch, .a = gradient, .b = rows};
    call.c = Tensor(context, {call.m, call.n});
    call.a_ld = call.m, call.b_ld = call.c_ld = call.n, call.a_transposed = true;
    call.a_offset[0] = first, call.b_offset[0] = first_row;
    if (count == 0) call.a_offset[0] = call.b_offset[0] = 0;
    gemm(context, call);
    return call.c;
  };
  const auto sum_of = [&](const Tensor& rows, std::size_t n) {
    return sum_axis_value(rows, 1, rows.size() / n, n, 1, {n});
  };
  std::vector<Tensor> found(8);
  if (needs[0]) found[0] = dx.view(0, {t.given, t.batch, 3 * t.k});
  if (needs[1] && own > 0)
    found[1] = sum_axis_value(dx.view(t.gates_at(t.given), {own, t.batch, 3 * t.k}), 1, own,
                              t.batch * 3 * t.k, 1, {t.batch, 3 * t.k});
  if (needs[2]) found[2] = poses.view(0, {t.batch, t.dof});
  if (needs[3]) found[3] = by_weight(ds, 0, t.states, 0, steps);
  if (needs[4]) found[4] = sum_of(ds, 3 * t.k);
  if (needs[5]) found[5] = by_weight(dx, t.gates_at(t.given), t.poses, t.pose_at(1), own);
  if (needs[6]) found[6] = by_weight(poses, 0, t.states, t.state_at(t.given), t.frames);
  if (needs[7]) found[7] = sum_of(poses, t.dof);
  return found;
}

}  // namespace detail

/// Predicts the `frames` poses [frames, B, M] that follow `last` [B, M]. `x_gates` [n, B, 3k] is W_i x + b_i
/// for the given poses, of which `last` is the last; `each` [B, 3k] is added to the gates of every later step
/// besides the pose's part. The initial state is zero. Throws Error if the shapes do not fit or there is no
/// given or predicted frame.
inline Var gru_rollout(const Var& x_gates, const Var& each, const Var& last, const GruRolloutWeights& w,
                       std::size_t frames) {
  const std::size_t k = w.recurrent.dim(1), dof = w.diff.dim(0), batch = last.dim(0);
  require(x_gates.value().rank() == 3 && x_gates.dim(0) > 0 && frames > 0 && k > 0 && dof > 0 &&
              x_gates.dim(1) == batch && x_gates.dim(2) == 3 * k && each.shape() == Shape{batch, 3 * k} &&
              last.shape() == Shape{batch, dof} && w.recurrent.dim(0) == 3 * k &&
              w.pose.shape() == Shape{3 * k, dof} && w.diff.dim(1) == k,
          "gru_rollout: gates ", x_gates.shape(), " and ", each.shape(), ", last pose ", last.shape(),
          ", weights ", w.recurrent.shape(), ", ", w.pose.shape(), ", ", w.diff.shape(), ", ", frames,
          " frames");
  const detail::GruTrace trace = detail::gru_rollout_forward(x_gates.value(), each.value(), last.value(), w,
                                                             frames, detail::recording());
  return detail::fused(
      "gru_rollout", {x_gates, each, last, w.recurrent, w.recurrent_bias, w.pose, w.diff, w.diff_bias},
      trace.poses.view(trace.pose_at(1), {frames, batch, dof}),
      [trace](const Node& self, const Tensor& g, const Needs& needs) {
        return detail::gru_rollout_backward(trace, self, g, needs);
      },
      [frames](const std::vector<Var>& in) {
        return detail::gru_rollout_composed(in[0], in[1], in[2], {in[3], in[4], in[5], in[6], in[7]}, frames);
      });
}

}  // namespace motiongan
