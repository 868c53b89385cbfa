// Autoregressive rollout of DVGAN's RNN generator (Lin & Amer, eq. 4): all steps as one operation, with fused
// value and first derivative and a composed form for higher ones.
//
// In step t two LSTM layers of hidden size k read the previous pose and predict the change of pose:
//   gates0_t = x_t + [a_{t-1} | h0_{t-1}] W0^T        h0_t, c0_t = cell(gates0_t, c0_{t-1})
//   gates1_t = b1  + [h0_t | h1_{t-1}] W1^T           h1_t, c1_t = cell(gates1_t, c1_{t-1})
//   a_t = (1 - leak) a_{t-1} + h1_t Wd^T + bd         (or the given pose, for seed frames)
// The rows of a step are stored as [a_t | h0_t | h1_{t-1}], so that the input of each layer is contiguous
// within a row and needs one matrix product.
#pragma once
#include "motiongan/ops/fused.hpp"
#include "motiongan/ops/lstm_step.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// The weights of rollout, for poses of M dimensions and hidden size k.
struct RolloutWeights {
  Var layer0;     ///< W0 [4k, M + k]: from [pose | h0] to the first layer's gates
  Var layer1;     ///< W1 [4k, 2k]: from [h0 | h1] to the second layer's gates
  Var bias1;      ///< b1 [4k]
  Var diff;       ///< Wd [M, k]
  Var diff_bias;  ///< bd [M]
  /// Share of the pose that is lost from one frame to the next: 0 in the paper. With it the pose is a leaky
  /// integral of the changes, so that their errors do not add up.
  double leak = 0;
};

namespace detail {

/// Sizes and offsets of a rollout: rows [a_t | h0_t | h1_{t-1}] of all samples, for t = 0 .. N.
struct RolloutShape {
  std::size_t frames, batch, dof, k, given;
  std::size_t width() const { return dof + 2 * k; }
  std::size_t slab() const { return batch * width(); }
  std::size_t pose_at(std::size_t t) const { return t * slab(); }
  std::size_t h0_at(std::size_t t) const { return t * slab() + dof; }
  /// h1 of step t is stored in the rows of step t + 1.
  std::size_t h1_at(std::size_t t) const { return (t + 1) * slab() + dof + k; }
  std::size_t state_at(std::size_t t) const { return t * batch * k; }
  std::size_t gates_at(std::size_t t) const { return (t - 1) * batch * 4 * k; }  // t >= 1
  LaunchGrid cells(const Context& context) const { return LaunchGrid::items(batch * vectors(context, k)); }
};

/// What the forward pass keeps for the backward pass: rows [N + 1, B, M + 2k], and activated gates
/// [N - 1, B, 4k] and cell states [N, B, k] of both layers.
struct RolloutTrace {
  RolloutShape shape;
  Tensor rows, gates0, gates1, c0, c1;
};

/// The two LSTM layers with packed weights.
struct RolloutLayers {
  LstmStepper first, second;
  RolloutLayers() = default;
  RolloutLayers(const Context& context, const RolloutWeights& w, bool in_16_bits = false)
      : first(context, w.layer0.value(), in_16_bits), second(context, w.layer1.value(), in_16_bits) {}
};

/// The row `out` += factor x, for poses of M values in rows of `width` values.
inline void add_poses(const Context& context, const Tensor& rows, std::size_t x, std::size_t out,
                      std::size_t batch, std::size_t dof, std::size_t width, double factor) {
  context.launch("layout", "add_rows", LaunchGrid::items(batch * vectors(context, dof)),
                 At{rows, x, batch * dof}, width, KernelReal{factor}, At{rows, out, batch * dof}, width,
                 batch, dof);
}

/// Runs all steps. `keep` keeps the gates of all steps, as rollout_backward needs them.
inline RolloutTrace rollout_forward(const Tensor& given, const Tensor& x_gates, const RolloutWeights& w,
                                    bool keep) {
  const Context& context = given.context();
  const std::size_t k = w.diff.dim(1), batch = given.dim(1), frames = x_gates.dim(0) + 1;
  const RolloutShape s{frames, batch, given.dim(2), k, given.dim(0)};
  RolloutTrace trace{s,
                     Tensor(context, {frames + 1, batch, s.width()}),
                     Tensor(context, {keep ? frames - 1 : 1, batch, 4 * k}),
                     Tensor(context, {keep ? frames - 1 : 1, batch, 4 * k}),
                     Tensor(context, {frames, batch, k}),
                     Tensor(context, {frames, batch, k})};
  fill(trace.rows.view(0, {2 * s.slab()}), 0);  // the initial states
  fill(trace.c0.view(0, {batch * k}), 0);
  fill(trace.c1.view(0, {batch * k}), 0);
  copy_runs(given, 0, s.dof, trace.rows, 0, s.width(), s.given * batch, s.dof);
  const RolloutLayers layers(context, w);
  GemmCall move{.m = batch, .n = s.dof, .k = k, .a = trace.rows, .b = w.diff.value(), .c = trace.rows};
  move.a_ld = move.c_ld = move.residual_ld = s.width(), move.b_ld = k;
  move.b_transposed = true;
  move.bias = w.diff_bias.value(), move.residual = trace.rows;
  move.b_panels = pack_b(context, move);
  for (std::size_t t = 1; t < frames; ++t) {
    layers.first.step({.batch = batch,
                       .rows = {trace.rows, s.pose_at(t - 1)},
                       .width = s.width(),
                       .extra = {x_gates, s.gates_at(t)},
                       .extra_is_bias = false,
                       .c_before = {trace.c0, s.state_at(t - 1)},
                       .h = {trace.rows, s.h0_at(t)},
                       .c = {trace.c0, s.state_at(t)},
                       .gates = {trace.gates0, keep ? s.gates_at(t) : 0},
                       .keep_gates = keep});
    layers.second.step({.batch = batch,
                        .rows = {trace.rows, s.h0_at(t)},
                        .width = s.width(),
                        .extra = {w.bias1.value(), 0},
                        .extra_is_bias = true,
                        .c_before = {trace.c1, s.state_at(t - 1)},
                        .h = {trace.rows, s.h1_at(t)},
                        .c = {trace.c1, s.state_at(t)},
                        .gates = {trace.gates1, keep ? s.gates_at(t) : 0},
                        .keep_gates = keep});
    if (t < s.given) continue;
    move.a_offset[0] = s.h1_at(t);
    move.c_offset = s.pose_at(t);
    move.residual_offset = s.pose_at(t - 1);
    gemm(context, move);
    if (w.leak > 0)
      add_poses(context, trace.rows, s.pose_at(t - 1), s.pose_at(t), batch, s.dof, s.width(), -w.leak);
  }
  return trace;
}

/// Gradients with respect to given, x_gates, W0, W1, b1, Wd and bd, given the motion's gradient g [N, B, M].
inline std::vector<Tensor> rollout_backward(const RolloutTrace& trace, double leak, const Node& self,
                                            const Tensor& g, const Needs& needs) {
  const Context& context = g.context();
  const RolloutShape& s = trace.shape;
  const std::size_t k = s.k, batch = s.batch, frames = s.frames;
  // Gradients of the rows, accumulated from the steps that read them.
  const Tensor rows = full(context, trace.rows.shape(), 0);
  copy_runs(g, 0, s.dof, rows, 0, s.width(), frames * batch, s.dof);
  const Tensor gates0(context, trace.gates0.shape()), gates1(context, trace.gates1.shape()),
      dc0 = full(context, {batch, k}, 0), dc1 = full(context, {batch, k}, 0);
  GemmCall move{.m = batch, .n = k, .k = s.dof}, second{.m = batch, .n = 2 * k, .k = 4 * k},
      first{.m = batch, .n = s.dof + k, .k = 4 * k};
  for (GemmCall* call : {&move, &second, &first}) {
    call->c = rows;
    call->c_ld = s.width();
    call->accumulate = true;
  }
  move.a = rows, move.a_ld = s.width(), move.b = self.inputs[5].value(), move.b_ld = k;
  second.a = gates1, second.a_ld = 4 * k, second.b = self.inputs[3].value(), second.b_ld = 2 * k;
  first.a = gates0, first.a_ld = 4 * k, first.b = self.inputs[2].value(), first.b_ld = s.dof + k;
  for (GemmCall* call : {&move, &second, &first}) call->b_panels = pack_b(context, *call);
  const cl_mem none = nullptr;
  const auto cell = [&](const Tensor& activated, const Tensor& c, std::size_t h, const Tensor& dc,
                        const Tensor& gradient, std::size_t t) {
    const std::size_t cells = batch * k;
    context.launch("lstm", "lstm_cell_backward", s.cells(context), At{activated, s.gates_at(t), 4 * cells},
                   At{c, s.state_at(t), cells}, At{c, s.state_at(t - 1), cells}, At{rows, h, cells},
                   s.width(), none, std::size_t{0}, none, t, std::size_t{0}, none, std::size_t{0}, dc,
                   At{gradient, s.gates_at(t), 4 * cells}, none, std::size_t{0}, none, std::size_t{0}, batch,
                   k);
  };
  for (std::size_t t = frames; t-- > 1;) {
    if (t >= s.given) {
      move.a_offset[0] = s.pose_at(t);
      move.c_offset = s.h1_at(t);
      gemm(context, move);
      add_poses(context, rows, s.pose_at(t), s.pose_at(t - 1), batch, s.dof, s.width(), 1 - leak);
    }
    cell(trace.gates1, trace.c1, s.h1_at(t), dc1, gates1, t);
    second.a_offset[0] = s.gates_at(t);
    second.c_offset = s.h0_at(t);
    gemm(context, second);
    cell(trace.gates0, trace.c0, s.h0_at(t), dc0, gates0, t);
    first.a_offset[0] = s.gates_at(t);
    first.c_offset = s.pose_at(t - 1);
    gemm(context, first);
  }
  // Weight gradients: one product each over all steps.
  const auto by_weight = [&](const Tensor& gradient, std::size_t first_gradient, std::size_t gradient_ld,
                             std::size_t seen, std::size_t m, std::size_t n, std::size_t steps) {
    GemmCall call{.m = m, .n = n, .k = steps * batch};
    call.a = gradient, call.a_offset[0] = first_gradient, call.a_ld = gradient_ld, call.a_transposed = true;
    call.b = trace.rows, call.b_offset[0] = seen, call.b_ld = s.width();
    call.c = Tensor(context, {m, n}), call.c_ld = n;
    gemm(context, call);
    return call.c;
  };
  const std::size_t free_steps = frames > s.given ? frames - s.given : 0;
  std::vector<Tensor> out(7);
  const auto poses = [&](std::size_t t, std::size_t count) {  // gradients of a_t .. as [count, B, M]
    Tensor part(context, {count, batch, s.dof});
    copy_runs(rows, s.pose_at(t), s.width(), part, 0, s.dof, count * batch, s.dof);
    return part;
  };
  if (needs[0]) out[0] = poses(0, s.given);
  if (needs[1]) out[1] = gates0;
  if (needs[2]) out[2] = by_weight(gates0, 0, 4 * k, s.pose_at(0), 4 * k, s.dof + k, frames - 1);
  if (needs[3]) out[3] = by_weight(gates1, 0, 4 * k, s.h0_at(1), 4 * k, 2 * k, frames - 1);
  if (needs[4]) out[4] = sum_axis_value(gates1, 1, (frames - 1) * batch, 4 * k, 1, {4 * k});
  if (needs[5] && free_steps > 0)
    out[5] = by_weight(rows, s.pose_at(s.given), s.width(), s.h1_at(s.given), s.dof, k, free_steps);
  if (needs[6] && free_steps > 0)
    out[6] = sum_axis_value(poses(s.given, free_steps), 1, free_steps * batch, s.dof, 1, {s.dof});
  return out;
}

/// rollout composed of elementary operations, with derivatives of every order.
inline Var rollout_composed(const Var& given, const Var& x_gates, const RolloutWeights& w) {
  const std::size_t frames = x_gates.dim(0) + 1, batch = given.dim(1), dof = given.dim(2), k = w.diff.dim(1);
  const Context& context = given.context();
  const auto cell = [&](const Var& gates, Var& h, Var& c) {
    const auto gate = [&](std::size_t index) { return slice(gates, 1, index * k, k); };
    c = sigmoid(gate(1)) * c + sigmoid(gate(0)) * tanh(gate(2));
    h = sigmoid(gate(3)) * tanh(c);
  };
  const auto rows = [&](const Var& bias) { return broadcast_to(bias, {batch, bias.size()}); };
  Var h0 = zeros(context, {batch, k}), c0 = h0, h1 = h0, c1 = h0;
  Var a = reshape(slice(given, 0, 0, 1), {batch, dof});
  std::vector<Var> motion{slice(given, 0, 0, 1)};
  for (std::size_t t = 1; t < frames; ++t) {
    cell(reshape(slice(x_gates, 0, t - 1, 1), {batch, 4 * k}) +
             matmul(concatenate({a, h0}, 1), w.layer0, false, true),
         h0, c0);
    cell(rows(w.bias1) + matmul(concatenate({h0, h1}, 1), w.layer1, false, true), h1, c1);
    a = t < given.dim(0)
            ? reshape(slice(given, 0, t, 1), {batch, dof})
            : (w.leak > 0 ? (1 - w.leak) * a : a) + matmul(h1, w.diff, false, true) + rows(w.diff_bias);
    motion.push_back(reshape(a, {1, batch, dof}));
  }
  return concatenate(motion, 0);
}

}  // namespace detail

/// Generates a motion [N, B, M] that continues the seed frames `given` [n, B, M], 1 <= n <= N (Lin & Amer,
/// eq. 4). `x_gates` [N-1, B, 4k] is added to the first layer's gates of steps 1 .. N-1: plots and biases.
/// Initial states are zero; the LSTM also runs over the seed frames. Throws Error if the shapes do not fit
/// or if the leak is not in [0, 1).
inline Var rollout(const Var& given, const Var& x_gates, const RolloutWeights& w) {
  const std::size_t k = w.diff.dim(1), dof = w.diff.dim(0), frames = x_gates.dim(0) + 1;
  require(given.value().rank() == 3 && given.dim(2) == dof && given.dim(0) >= 1 && given.dim(0) <= frames &&
              x_gates.dim(1) == given.dim(1) && x_gates.dim(2) == 4 * k && k > 0 && dof > 0 &&
              w.layer0.shape() == Shape{4 * k, dof + k} && w.layer1.shape() == Shape{4 * k, 2 * k},
          "rollout: given ", given.shape(), ", gates ", x_gates.shape(), ", weights ", w.layer0.shape(), ", ",
          w.layer1.shape(), ", ", w.diff.shape());
  require(w.leak >= 0 && w.leak < 1, "rollout: leak ", w.leak, ", expected at least 0 and below 1");
  if (frames == 1) return given;
  const detail::RolloutTrace trace =
      detail::rollout_forward(given.value(), x_gates.value(), w, detail::recording());
  const detail::RolloutShape& s = trace.shape;
  Tensor motion(given.context(), {frames, s.batch, dof});
  detail::copy_runs(trace.rows, 0, s.width(), motion, 0, dof, frames * s.batch, dof);
  return detail::fused(
      "rollout", {given, x_gates, w.layer0, w.layer1, w.bias1, w.diff, w.diff_bias}, std::move(motion),
      [trace, leak = w.leak](const Node& self, const Tensor& g, const Needs& needs) {
        return detail::rollout_backward(trace, leak, self, g, needs);
      },
      [leak = w.leak](const std::vector<Var>& in) {
        return detail::rollout_composed(in[0], in[1], {in[2], in[3], in[4], in[5], in[6], leak});
      });
}

}  // namespace motiongan
