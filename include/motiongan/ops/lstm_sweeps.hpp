// Forward, backward and double-backward passes of one LSTM layer on tensors; lstm.hpp turns them into
// differentiable operations. Each step is one matrix product and one pointwise kernel of cl/lstm.cl.
#pragma once
#include "motiongan/ops/lstm_step.hpp"
#include "motiongan/ops/reduce.hpp"

namespace motiongan::detail {

/// Inputs and results of the forward pass, kept for the derivatives.
struct LstmPass {
  Tensor w_hh, h_first, c_first;  // [4k, k], [B, k], [B, k]
  Indices lengths;                // [B] or empty
  Tensor gates;                   // activations, [T, B, 4k]
  Tensor states;                  // h of every step, then c of every step, [2, T, B, k]

  const Context& context() const { return states.context(); }
  std::size_t frames() const { return states.dim(1); }
  std::size_t batch() const { return states.dim(2); }
  std::size_t hidden() const { return states.dim(3); }
  std::size_t slab() const { return batch() * hidden(); }
  LaunchGrid grid() const { return LaunchGrid::items(batch() * vectors(context(), hidden())); }

  /// Step t of `all` [T, B, 4k]: [B, 4k].
  Tensor gates_at(const Tensor& all, std::size_t t) const {
    return all.view(t * 4 * slab(), {batch(), 4 * hidden()});
  }
  /// Step t of `all` [T, B, k], or of its second half (kind 1) if `all` is [2, T, B, k]: [B, k].
  Tensor state_at(const Tensor& all, std::size_t t, std::size_t kind = 0) const {
    return all.view((kind * frames() + t) * slab(), {batch(), hidden()});
  }
  Tensor c_at(std::size_t t) const { return state_at(states, t, 1); }
  Tensor c_before(std::size_t t) const { return t > 0 ? c_at(t - 1) : c_first; }
  Tensor h_before(std::size_t t) const { return t > 0 ? state_at(states, t - 1) : h_first; }
};

/// Packs the weights once for all steps, if there are enough steps to amortise it.
inline void pack_weights(const LstmPass& pass, GemmCall& call) {
  if (pass.frames() > 2) call.b_panels = pack_b(pass.context(), call);
}

/// to[t] = h W_hh^T + from[t], the gates of step t; run_step() sets h [B, k] and t.
inline GemmCall recurrence(const LstmPass& pass, const Tensor& from, const Tensor& to) {
  GemmCall call;
  call.m = pass.batch();
  call.n = call.c_ld = call.residual_ld = 4 * pass.hidden();
  call.k = call.a_ld = call.b_ld = pass.hidden();
  call.b = pass.w_hh;
  call.b_transposed = true;
  call.c = to;
  call.residual = from;
  pack_weights(pass, call);
  return call;
}
inline void run_step(const LstmPass& pass, GemmCall& recurrence, const Tensor& h, std::size_t t) {
  recurrence.a = h;
  recurrence.c_offset = recurrence.residual_offset = t * 4 * pass.slab();
  gemm(pass.context(), recurrence);
}

/// to = rows W_hh, or += with `accumulate`: the gradient of the previous state, [B, k], from that of the
/// gates; run_step() sets rows [B, 4k].
inline GemmCall recurrence_gradient(const LstmPass& pass, const Tensor& to, bool accumulate) {
  GemmCall call;
  call.m = pass.batch();
  call.n = call.b_ld = call.c_ld = pass.hidden();
  call.k = call.a_ld = 4 * pass.hidden();
  call.b = pass.w_hh;
  call.c = to;
  call.accumulate = accumulate;
  pack_weights(pass, call);
  return call;
}
inline void run_step(const LstmPass& pass, GemmCall& recurrence_gradient, const Tensor& rows) {
  recurrence_gradient.a = rows;
  gemm(pass.context(), recurrence_gradient);
}

/// The gradient of the recurrent weights, sum over t of rows[t]^T h[t-1], [4k, k], in one product over all
/// steps. `first` is h before the first step; if empty, that step is left out. rows is [T, B, 4k], h
/// [T, B, k] or longer.
inline Tensor weight_gradient(const LstmPass& pass, const Tensor& rows, const Tensor& h,
                              const Tensor& first) {
  const std::size_t k = pass.hidden();
  GemmCall call{.m = 4 * k, .n = k, .k = (pass.frames() - 1) * pass.batch(), .a = rows, .b = h};
  call.c = Tensor(pass.context(), {4 * k, k});
  call.a_ld = 4 * k, call.b_ld = call.c_ld = k;
  call.a_transposed = true;
  call.a_offset[0] = call.k > 0 ? 4 * pass.slab() : 0;
  gemm(pass.context(), call);
  if (first.empty()) return call.c;
  call.k = pass.batch();
  call.a_offset[0] = 0;
  call.b = first;
  call.accumulate = true;
  gemm(pass.context(), call);
  return call.c;
}

/// Runs the layer over x_gates [T, B, 4k], see lstm_layer.
inline LstmPass lstm_forward(const Tensor& x_gates, const Tensor& w_hh, const Tensor& h_first,
                             const Tensor& c_first, const Indices& lengths) {
  const std::size_t frames = x_gates.dim(0), batch = x_gates.dim(1), k = w_hh.dim(1);
  const Context& context = x_gates.context();
  LstmPass pass{.w_hh = w_hh,
                .h_first = h_first,
                .c_first = c_first,
                .lengths = lengths,
                .gates = Tensor(context, {frames, batch, 4 * k}),
                .states = Tensor(context, {2, frames, batch, k})};
  const LstmStepper layer(context, w_hh);
  for (std::size_t t = 0; t < frames; ++t)
    layer.step({.batch = batch,
                .rows = {t > 0 ? pass.states : h_first, t > 0 ? (t - 1) * pass.slab() : 0},
                .width = k,
                .extra = {x_gates, t * 4 * pass.slab()},
                .extra_is_bias = false,
                .c_before = {t > 0 ? pass.states : c_first, t > 0 ? (frames + t - 1) * pass.slab() : 0},
                .h = {pass.states, t * pass.slab()},
                .c = {pass.states, (frames + t) * pass.slab()},
                .gates = {pass.gates, t * 4 * pass.slab()},
                .keep_gates = true,
                .lengths = lengths,
                .number = t});
  return pass;
}

struct LstmGradients {
  Tensor gates;             // of the pre-activation gates, [T, B, 4k]
  Tensor h_first, c_first;  // [B, k]; h_first only on request
  Tensor totals;            // on request: total gradients of h, then of c, of every step, [2, T, B, k]
};

struct LstmBackward {
  bool h_first = false, keep_totals = false;
};

/// Gradients of <g, states>; g is [2, T, B, k], or [T, B, k] if it has no part for c.
inline LstmGradients lstm_backward(const LstmPass& pass, const Tensor& g, const LstmBackward& options) {
  const Context& context = pass.context();
  const std::size_t frames = pass.frames(), batch = pass.batch(), k = pass.hidden();
  LstmGradients out{.gates = Tensor(context, {frames, batch, 4 * k}),
                    .h_first = Tensor(context, {batch, k}),
                    .c_first = Tensor(context, {batch, k}),
                    .totals = options.keep_totals ? Tensor(context, {2, frames, batch, k}) : Tensor()};
  const bool of_c = g.size() == 2 * frames * pass.slab();
  GemmCall product = recurrence_gradient(pass, out.h_first, !pass.lengths.empty());
  for (std::size_t t = frames; t-- > 0;) {
    const Tensor now = pass.gates_at(out.gates, t);
    const Tensor h_total = options.keep_totals ? pass.state_at(out.totals, t) : Tensor(),
                 c_total = options.keep_totals ? pass.state_at(out.totals, t, 1) : Tensor();
    context.launch("lstm", "lstm_cell_backward", pass.grid(), pass.gates_at(pass.gates, t), pass.c_at(t),
                   pass.c_before(t), pass.state_at(g, t), k,
                   Maybe<Tensor>{of_c ? pass.state_at(g, t, 1) : Tensor()}, Maybe<Indices>{pass.lengths}, t,
                   std::size_t{t + 1 == frames}, out.h_first, out.c_first, now, Maybe<Tensor>{h_total},
                   Maybe<Tensor>{c_total}, batch, k);
    if (t > 0 || options.h_first) run_step(pass, product, now);
  }
  return out;
}

struct LstmDoubleBackward {
  Tensor g;      // [2, T, B, k]
  Tensor gates;  // of x_gates, [T, B, 4k]; on request
  Tensor w_hh;   // [4k, k]; on request
};

/// Gradients of <u, gradient> with respect to g, x_gates and w_hh, where gradient(g, x_gates, w_hh)
/// [T, B, 4k] is `gates` of lstm_backward and `totals` what that kept. Initial states are constant and there
/// are no `lengths`.
inline LstmDoubleBackward lstm_double_backward(const LstmPass& pass, const Tensor& gradient,
                                               const Tensor& totals, const Tensor& u, bool of_gates,
                                               bool of_w_hh) {
  const Context& context = pass.context();
  const std::size_t frames = pass.frames(), batch = pass.batch(), k = pass.hidden();
  LstmDoubleBackward out{.g = Tensor(context, {2, frames, batch, k}), .gates = {}, .w_hh = {}};
  const Tensor gates(context, {frames, batch, 4 * k}), direct(context, {frames, batch, k});
  GemmCall onward = recurrence(pass, u, gates);
  for (std::size_t t = 0; t < frames; ++t) {
    const Tensor now = pass.gates_at(gates, t);
    if (t > 0) run_step(pass, onward, pass.state_at(out.g, t - 1), t);
    const Tensor c_before = t > 0 ? pass.state_at(out.g, t - 1, 1) : Tensor(),
                 direct_before = t > 0 ? pass.state_at(direct, t - 1) : Tensor();
    context.launch("lstm", "lstm_grad_forward", pass.grid(), t > 0 ? now : pass.gates_at(u, t),
                   pass.gates_at(pass.gates, t), pass.c_at(t), pass.c_before(t), pass.state_at(totals, t),
                   pass.state_at(totals, t, 1), Maybe<Tensor>{c_before}, Maybe<Tensor>{direct_before},
                   pass.state_at(out.g, t), pass.state_at(out.g, t, 1), now, pass.state_at(direct, t), batch,
                   k);
  }
  if (!of_gates && !of_w_hh) return out;
  const Tensor h_carry(context, {batch, k}), c_carry(context, {batch, k}), none;
  GemmCall back = recurrence_gradient(pass, h_carry, false);
  for (std::size_t t = frames; t-- > 0;) {
    const Tensor now = pass.gates_at(gates, t);
    context.launch("lstm", "lstm_grad_backward", pass.grid(), pass.gates_at(pass.gates, t), pass.c_at(t),
                   pass.c_before(t), pass.state_at(direct, t), Maybe<Tensor>{t + 1 < frames ? h_carry : none},
                   c_carry, now, batch, k);
    if (t > 0) run_step(pass, back, now);
  }
  out.gates = gates;
  if (of_w_hh) {
    const Var of_activations = Var::constant(weight_gradient(pass, gates, pass.states, pass.h_first)),
              of_gradient = Var::constant(weight_gradient(pass, gradient, out.g, {}));
    out.w_hh = (of_activations + of_gradient).value();
  }
  return out;
}

}  // namespace motiongan::detail
