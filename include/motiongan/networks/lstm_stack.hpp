// What ERD and LSTM-3LR share (Fragkiadaki et al. 2015): layers of LSTM that tell the next pose in every
// step.
#pragma once
#include "motiongan/nn/lstm.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// The `frames` poses that follow a prefix [n, B, M] when `model` is fed with its own output. It has
/// next_poses(x, state).
template <class Model>
Var closed_loop(const Model& model, const Var& prefix, std::size_t frames) {
  require(frames > 0, "0 frames were asked for");
  LstmState state;
  const Var told = model.next_poses(prefix, state);
  std::vector<Var> made{slice(told, 0, prefix.dim(0) - 1, 1)};
  while (made.size() < frames) made.push_back(model.next_poses(made.back(), state));
  return concatenate(made, 0);
}

}  // namespace motiongan
