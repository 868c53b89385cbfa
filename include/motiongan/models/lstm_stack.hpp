// What ERD and LSTM-3LR share (Fragkiadaki et al. 2015): layers of LSTM that tell the next pose in every
// step.
#pragma once
#include "motiongan/nn/lstm.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// h and c of every layer after a run, [B, k] each.
struct LstmState {
  std::vector<Var> h, c;
};

/// h of the last layer, [T, B, k], of layers that go on from `state` (empty: from zeros), which is moved on.
inline Var run_lstm(const Lstm& lstm, const Var& x, LstmState& state) {
  const std::size_t frames = x.dim(0);
  if (state.h.empty()) {
    const Var zero = zeros(x.context(), {x.dim(1), lstm.hidden()});
    state.h.assign(lstm.layers.size(), zero);
    state.c = state.h;
  }
  Var input = x;
  for (std::size_t l = 0; l < lstm.layers.size(); ++l) {
    const Lstm::Layer& layer = lstm.layers[l];
    const Var w = reshape(layer.weight_ih, {1, layer.weight_ih.dim(0), layer.weight_ih.dim(1)});
    const Var gates = taps(input, w, {0}, frames, false, {.bias = layer.bias_ih + layer.bias_hh});
    const Var states = lstm_layer(gates, layer.weight_hh, state.h[l], state.c[l]);
    state.h[l] = last_state(states, 0);
    state.c[l] = last_state(states, 1);
    input = hidden_states(states);
  }
  return input;
}

/// The `frames` poses that follow a prefix [n, B, M] when `model` is fed with its own output. It has
/// next_poses(x, state).
template <class Model>
Var closed_loop(const Model& model, const Var& prefix, std::size_t frames) {
  require(frames > 0, "0 frames were asked for");
  LstmState state;
  const Var told = model.next_poses(prefix, state);
  std::vector<Var> made{slice(told, 0, prefix.dim(0) - 1, 1)};
  while (made.size() < frames) made.push_back(model.next_poses(made.back(), state));
  return concat_axis(made, 0);
}

}  // namespace motiongan
