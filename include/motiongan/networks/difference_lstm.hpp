// Frame differences through an LSTM, shared by the RNN critic and the RNN ranker (Lin & Amer, eq. 9 and 10).
#pragma once
#include "motiongan/nn/lstm.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// Frame differences a_{t+1} - a_t: [N, B, M] -> [N - 1, B, M], N >= 2.
inline Var frame_differences(const Var& motion) {
  const std::size_t frames = motion.dim(0);
  return slice(motion, 0, 1, frames - 1) - slice(motion, 0, 0, frames - 1);
}

/// Hidden states of the top layer of lstm(diff(differences)): [N - 1, B, M] -> [N - 1, B, k].
inline Var difference_lstm(const Linear& diff, const Lstm& lstm, const Var& differences) {
  const std::size_t k = lstm.hidden();
  Var h;
  for (const Lstm::Layer& layer : lstm.layers) {
    const bool lowest = h.empty();
    // `diff` and the bottom layer's input weights are both linear, so they are multiplied into one matrix.
    const Var weight = lowest ? matmul(layer.weight_ih, diff.weight) : layer.weight_ih;
    Var bias = layer.bias_ih + layer.bias_hh;
    if (lowest)
      bias = bias + reshape(matmul(reshape(diff.bias, {1, k}), layer.weight_ih, false, true), {4 * k});
    const Var& x = lowest ? differences : h;
    h = lstm_hidden(linear(x, weight, {.bias = bias}), layer.weight_hh);
  }
  return h;
}

}  // namespace motiongan
