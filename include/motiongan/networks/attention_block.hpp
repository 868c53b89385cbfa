// The residual block of the attention models (SPEC 5): Block(h) = h + conv2(ReLU(conv1(ReLU(h)))), 3 taps.
#pragma once
#include <optional>

#include "motiongan/networks/residual.hpp"
#include "motiongan/nn/self_attention.hpp"

namespace motiongan {

/// Block(h), [T, B, C] -> [T, B, C]; ReLU follows if asked.
inline Var residual_block(const Residual& block, const Var& h, bool with_relu = false) {
  return block.conv2(block.conv1(relu(h), {.relu = true}), {.residual = h, .relu = with_relu});
}

/// Mean of pairs along time, an odd last frame dropped: [T, B, C] -> [T / 2, B, C] (SPEC 0).
inline Var down(const Var& h) {
  return sum_pool(h.dim(0) % 2 == 0 ? h : slice(h, 0, 0, h.dim(0) - 1), 2, 0.5);
}

/// down(residual_block(h)), with half of conv2's arithmetic: convolving and taking means are exchanged.
inline Var residual_block_down(const Residual& block, const Var& h) {
  const Var inner = block.conv1(relu(h), {.relu = true});
  return conv_down(pair_means(inner), block.conv2.weight, block.conv2.bias, h.dim(0), {.residual = down(h)});
}

/// Where a layer of attention may be missing (the ablation of the paper): then it is the identity.
inline Var attend(const std::optional<SelfAttention>& attention, const Var& h) {
  return attention ? (*attention)(h) : h;
}

/// A vector for each sample, [B, n], repeated on `frames` frames and joined to the channels of x [T, B, C].
inline Var with_constant_channels(const Var& x, const Var& constants) {
  const std::size_t frames = x.dim(0), batch = x.dim(1), count = constants.dim(1);
  require(constants.dim(0) == batch, "constants for ", constants.dim(0), " samples beside a motion of ",
          batch);
  return concatenate({x, broadcast_to(constants, {frames, batch, count})}, 2);
}

}  // namespace motiongan
