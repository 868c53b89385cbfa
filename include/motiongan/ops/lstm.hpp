// One LSTM layer over time. Values, first derivatives and the second derivative needed by a gradient penalty
// are fused; all other derivatives are composed of elementary operations.
#pragma once
#include "motiongan/ops/fused.hpp"
#include "motiongan/ops/lstm_sweeps.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// h of every step, [T, B, k], from the states of lstm_layer.
inline Var hidden_states(const Var& states) {
  const std::size_t frames = states.dim(1), batch = states.dim(2), k = states.dim(3);
  return slice(reshape(states, {2 * frames, batch, k}), 0, 0, frames);
}

namespace detail {

/// lstm_layer composed of elementary operations, with derivatives of every order.
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
  return concatenate({concatenate(all_h, 1), concatenate(all_c, 1)}, 0);
}

/// The gradient of lstm_layer with respect to its gates, [T, B, 4k], as an operation: a gradient penalty
/// differentiates it again. Initial states are constant and there are no `lengths`. Its first derivative is
/// fused, higher ones are composed.
inline Var lstm_layer_grad(const Var& g, const Var& x_gates, const Var& w_hh, const LstmPass& pass,
                           bool only_h) {
  const LstmGradients first = lstm_backward(pass, g.value(), {.keep_totals = true});
  return fused(
      "lstm_layer_grad", {g, x_gates, w_hh}, first.gates,
      [pass, only_h, totals = first.totals](const Node& self, const Tensor& u, const Needs& needs) {
        const LstmDoubleBackward found =
            lstm_double_backward(pass, self.value, totals, u, needs[1], needs[2]);
        return std::vector<Tensor>{
            only_h ? found.g.view(0, {pass.frames(), pass.batch(), pass.hidden()}) : found.g,
            needs[1] ? found.gates : Tensor(), needs[2] ? found.w_hh : Tensor()};
      },
      [pass, only_h](const std::vector<Var>& v) {
        const Var states =
            lstm_layer_composed(v[1], v[2], Var::constant(pass.h_first), Var::constant(pass.c_first), {});
        return grad({only_h ? hidden_states(states) : states}, {v[0]}, {v[1]}, {.create_graph = true})[0];
      });
}

/// lstm_layer, or with `only_h` only the h of its states.
inline Var lstm_layer_fused(const Var& x_gates, const Var& w_hh, const Var& h_first, const Var& c_first,
                            const Indices& lengths, bool only_h) {
  const std::size_t batch = x_gates.dim(1), k = w_hh.dim(1), slab = batch * k;
  require(x_gates.dim(2) == 4 * k && w_hh.dim(0) == 4 * k && h_first.size() == slab && c_first.size() == slab,
          "lstm_layer: gates ", x_gates.shape(), ", weights ", w_hh.shape(), ", first state ",
          h_first.shape());
  require(x_gates.dim(0) > 0 && k > 0, "lstm_layer: gates ", x_gates.shape(), ", weights ", w_hh.shape(),
          "; give at least one step and one hidden unit");
  require(lengths.empty() || lengths.size() == batch, "lstm_layer: ", lengths.size(), " lengths for ", batch,
          " samples");
  if (!lengths.empty()) lengths.check_range("lstm_layer, lengths", 0, static_cast<long long>(x_gates.dim(0)));
  const LstmPass pass =
      lstm_forward(x_gates.value(), w_hh.value(), h_first.value(), c_first.value(), lengths);
  return fused(
      "lstm_layer", {x_gates, w_hh, h_first, c_first},
      only_h ? pass.states.view(0, {x_gates.dim(0), batch, k}) : pass.states,
      [pass](const Node&, const Tensor& g, const Needs& needs) {
        const LstmGradients found = lstm_backward(pass, g, {.h_first = needs[2]});
        return std::vector<Tensor>{
            found.gates, needs[1] ? weight_gradient(pass, found.gates, pass.states, pass.h_first) : Tensor(),
            needs[2] ? found.h_first : Tensor(), needs[3] ? found.c_first : Tensor()};
      },
      [pass, only_h](const std::vector<Var>& v) {
        const Var states = lstm_layer_composed(v[0], v[1], v[2], v[3], pass.lengths);
        return only_h ? hidden_states(states) : states;
      },
      [pass, only_h](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
        // With respect to the gates alone, as in a gradient penalty, the second derivative is fused too.
        const auto& in = self.inputs;
        if (needs != Needs{true, false, false, false} || !pass.lengths.empty() || in[2].requires_grad() ||
            in[3].requires_grad())
          return {};
        return {lstm_layer_grad(g, in[0], in[1], pass, only_h), {}, {}, {}};
      });
}

}  // namespace detail

/// One LSTM layer as in PyTorch (gate order i, f, g, o). `x_gates` [T, B, 4k] is W_ih x + b_ih + b_hh, `w_hh`
/// is [4k, k], `h_first` and `c_first` are [B, k]. Sample b keeps its state after lengths[b] steps, 0 to T
/// (empty: all run for T steps). Returns all states, [2, T, B, k]: h of every step, then c of every step.
/// Throws Error if the shapes or lengths do not fit, or for no steps or hidden units.
inline Var lstm_layer(const Var& x_gates, const Var& w_hh, const Var& h_first, const Var& c_first,
                      const Indices& lengths = {}) {
  return detail::lstm_layer_fused(x_gates, w_hh, h_first, c_first, lengths, false);
}

/// h of every step, [T, B, k], of an LSTM layer with zero initial state: hidden_states() of lstm_layer, but
/// without carrying c and its gradient along.
inline Var lstm_hidden(const Var& x_gates, const Var& w_hh) {
  const Var zero = zeros(x_gates.context(), {x_gates.dim(1), w_hh.dim(1)});
  return detail::lstm_layer_fused(x_gates, w_hh, zero, zero, {}, true);
}

/// The final h (kind 0) or c (kind 1) of every sample, [B, k], from the states of lstm_layer.
inline Var last_state(const Var& states, std::size_t kind) {
  const std::size_t frames = states.dim(1), batch = states.dim(2), k = states.dim(3);
  require(frames > 0, "last_state: states ", states.shape(), " of no step");
  return reshape(slice(reshape(states, {2 * frames, batch, k}), 0, kind * frames + frames - 1, 1),
                 {batch, k});
}

}  // namespace motiongan
