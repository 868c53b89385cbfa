// Closed-loop generation for ERD and LSTM-3LR (Fragkiadaki et al. 2015).
#pragma once
#include "motiongan/nn/lstm.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// The `frames` poses [frames, B, M] that follow a prefix [n, B, M] when `model`, which has
/// next_poses(x, state), is fed with its own output. Throws Error if frames is 0.
template <class Model>
Var closed_loop(const Model& model, const Var& prefix, std::size_t frames) {
  require(frames > 0, "frames is 0, expected at least 1");
  LstmState state;
  const Var told = model.next_poses(prefix, state);
  std::vector<Var> made{slice(told, 0, prefix.dim(0) - 1, 1)};
  while (made.size() < frames) made.push_back(model.next_poses(made.back(), state));
  return concatenate(made, 0);
}

}  // namespace motiongan
