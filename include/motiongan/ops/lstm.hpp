// One LSTM layer over time: a fused form for values and first derivatives, a composed one for higher
// derivatives.
#pragma once
#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

namespace detail {

/// The layer out of elementary operations; every derivative exists. Arguments and result as lstm_layer.
inline Var lstm_layer_composed(const Var& x_gates, const Var& w_hh, const Var& h_first, const Var& c_first,
                               const Indices& lengths) {
  const std::size_t frames = x_gates.dim(0), batch = x_gates.dim(1), k = w_hh.dim(1);
  std::vector<cl_int> length(batch, static_cast<cl_int>(frames));
  if (!lengths.empty()) length = lengths.to_host();
  Var h = h_first, c = c_first;
  std::vector<Var> all_h, all_c;
  for (std::size_t t = 0; t < frames; ++t) {
    const Var gates = reshape(slice(x_gates, 0, t, 1), {batch, 4 * k}) + matmul(h, w_hh, false, true);
    const auto gate = [&](std::size_t index) { return slice(gates, 1, index * k, k); };
    const Var c_new = sigmoid(gate(1)) * c + sigmoid(gate(0)) * tanh(gate(2));
    const Var h_new = sigmoid(gate(3)) * tanh(c_new);
    bool everybody = true;
    std::vector<double> keep(batch * k, 0.0);
    for (std::size_t b = 0; b < batch; ++b)
      if (length[b] <= static_cast<cl_int>(t)) {
        everybody = false;
        std::fill_n(keep.begin() + static_cast<std::ptrdiff_t>(b * k), k, 1.0);
      }
    if (everybody) {
      h = h_new;
      c = c_new;
    } else {
      const Var over = Var::constant(Tensor::from(x_gates.context(), {batch, k}, keep)),
                running = affine(over, -1, 1);
      h = running * h_new + over * h;
      c = running * c_new + over * c;
    }
    all_h.push_back(reshape(h, {1, 1, batch, k}));
    all_c.push_back(reshape(c, {1, 1, batch, k}));
  }
  return concat_axis({concat_axis(all_h, 1), concat_axis(all_c, 1)}, 0);
}

/// First derivative of lstm_layer by its four inputs, fused; `gates` are the activations of the forward pass.
inline std::vector<Var> lstm_layer_backward(const Node& self, const Tensor& g, const Tensor& gates,
                                            const Indices& lengths, const Needs& needs) {
  const Tensor &w_hh = self.inputs[1].value(), &h_first = self.inputs[2].value(),
               &c_first = self.inputs[3].value(), &states = self.value;
  const Context& context = g.context();
  const std::size_t frames = states.dim(1), batch = states.dim(2), k = states.dim(3), slab = batch * k;
  const auto state_at = [&](const Tensor& s, std::size_t kind, std::size_t t) {
    return s.view((kind * frames + t) * slab, {batch, k});
  };
  Tensor gate_gradient(context, {frames, batch, 4 * k});
  const Tensor dh = filled(context, {batch, k}, 0), dc = filled(context, {batch, k}, 0);
  const Grid grid = Grid::items(batch * vectors(context, k));
  GemmCall recurrent;  // gradient of the gates, times W_hh, goes to h of the step before
  recurrent.m = batch;
  recurrent.n = k;
  recurrent.k = 4 * k;
  recurrent.b = w_hh;
  recurrent.c = dh;
  recurrent.a_ld = 4 * k;
  recurrent.b_ld = recurrent.c_ld = k;
  recurrent.accumulate = true;
  for (std::size_t t = frames; t-- > 0;) {
    const Tensor now = gate_gradient.view(t * 4 * slab, {batch, 4 * k});
    const Tensor c_before = t > 0 ? state_at(states, 1, t - 1) : c_first;
    const Tensor activations = gates.view(t * 4 * slab, {batch, 4 * k});
    if (lengths.empty())
      context.launch("lstm", "lstm_cell_backward", grid, activations, state_at(states, 1, t), c_before,
                     state_at(g, 0, t), state_at(g, 1, t), static_cast<cl_mem>(nullptr), t, dh, dc, now,
                     batch, k);
    else
      context.launch("lstm", "lstm_cell_backward", grid, activations, state_at(states, 1, t), c_before,
                     state_at(g, 0, t), state_at(g, 1, t), lengths, t, dh, dc, now, batch, k);
    if (t > 0 || needs[2]) {
      recurrent.a = now;
      gemm(context, recurrent);
    }
  }
  Var by_weights;
  if (needs[1]) {  // sum over t of (gate gradient)_t^T h_{t-1}, all steps in one product, the first from
                   // h_first
    Tensor w(context, {4 * k, k});
    GemmCall call;
    call.m = 4 * k;
    call.n = k;
    call.a_ld = 4 * k;
    call.b_ld = call.c_ld = k;
    call.a_transposed = true;
    call.c = w;
    call.k = batch;
    call.a = gate_gradient;
    call.b = h_first;
    gemm(context, call);
    if (frames > 1) {
      call.k = (frames - 1) * batch;
      call.a_offset[0] = 4 * slab;
      call.b = states;
      call.accumulate = true;
      gemm(context, call);
    }
    by_weights = Var::constant(w);
  }
  return {Var::constant(gate_gradient), by_weights, needs[2] ? Var::constant(dh) : Var(),
          needs[3] ? Var::constant(dc) : Var()};
}

}  // namespace detail

/// One LSTM layer as PyTorch's (gates i, f, g, o). `x_gates` [T, B, 4k] is W_ih x + b_ih + b_hh, `w_hh` [4k,
/// k], `h_first`, `c_first` [B, k]. A sample keeps its state from step lengths[b] on (`lengths` may be empty:
/// all run to T). Returns all states, [2, T, B, k]: h of every step, then c of every step.
inline Var lstm_layer(const Var& x_gates, const Var& w_hh, const Var& h_first, const Var& c_first,
                      const Indices& lengths = {}) {
  const std::size_t frames = x_gates.dim(0), batch = x_gates.dim(1), k = w_hh.dim(1), slab = batch * k;
  require(x_gates.dim(2) == 4 * k && w_hh.dim(0) == 4 * k && h_first.size() == slab && c_first.size() == slab,
          "lstm_layer: gates ", x_gates.shape(), ", weights ", w_hh.shape(), ", first state ",
          h_first.shape());
  const Context& context = x_gates.context();
  Tensor states(context, {2, frames, batch, k});
  const Tensor gates(context, {frames, batch, 4 * k});
  GemmCall call;
  call.m = batch;
  call.n = 4 * k;
  call.k = k;
  call.b = w_hh.value();
  call.c = gates;
  call.residual = x_gates.value();
  call.a_ld = call.b_ld = k;
  call.c_ld = call.residual_ld = 4 * k;
  call.b_transposed = true;
  const auto state_at = [&](std::size_t kind, std::size_t t) {
    return states.view((kind * frames + t) * slab, {batch, k});
  };
  for (std::size_t t = 0; t < frames; ++t) {
    const Tensor h_before = t > 0 ? state_at(0, t - 1) : h_first.value(),
                 c_before = t > 0 ? state_at(1, t - 1) : c_first.value();
    const Tensor now = gates.view(t * 4 * slab, {batch, 4 * k});
    call.a = h_before;
    call.c_offset = call.residual_offset = t * 4 * slab;
    gemm(context, call);
    const Grid grid = Grid::items(batch * detail::vectors(context, k));
    if (lengths.empty())
      context.launch("lstm", "lstm_cell", grid, now, c_before, h_before, static_cast<cl_mem>(nullptr), t,
                     state_at(0, t), state_at(1, t), batch, k);
    else
      context.launch("lstm", "lstm_cell", grid, now, c_before, h_before, lengths, t, state_at(0, t),
                     state_at(1, t), batch, k);
  }
  return record("lstm_layer", {x_gates, w_hh, h_first, c_first}, std::move(states),
                [gates, lengths](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  if (!detail::recording())
                    return detail::lstm_layer_backward(self, g.value(), gates, lengths, needs);
                  // A higher derivative is asked: differentiate the composed form. The copies of the inputs
                  // are younger than what they copy, so the sweep stops at them and gives partial
                  // derivatives.
                  std::vector<Var> copies, wanted;
                  for (const Var& input : self.inputs) copies.push_back(reshape(input, input.shape()));
                  for (std::size_t i = 0; i < copies.size(); ++i)
                    if (needs[i]) wanted.push_back(copies[i]);
                  const Var composed =
                      detail::lstm_layer_composed(copies[0], copies[1], copies[2], copies[3], lengths);
                  const std::vector<Var> found = grad({composed}, {g}, wanted, {.create_graph = true});
                  std::vector<Var> result(self.inputs.size());
                  for (std::size_t i = 0, j = 0; i < result.size(); ++i)
                    if (needs[i]) result[i] = found[j++];
                  return result;
                });
}

/// The last h or c of every sample, [B, k], out of lstm_layer's states; kind 0 is h, 1 is c.
inline Var last_state(const Var& states, std::size_t kind) {
  const std::size_t frames = states.dim(1), batch = states.dim(2), k = states.dim(3);
  return reshape(slice(reshape(states, {2 * frames, batch, k}), 0, kind * frames + frames - 1, 1),
                 {batch, k});
}

/// h of every step, [T, B, k].
inline Var hidden_states(const Var& states) {
  const std::size_t frames = states.dim(1), batch = states.dim(2), k = states.dim(3);
  return slice(reshape(states, {2 * frames, batch, k}), 0, 0, frames);
}

}  // namespace motiongan
