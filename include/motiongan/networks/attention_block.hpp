// Building blocks of the attention models: the residual block, pooling, and the class as extra channels.
#pragma once
#include <optional>

#include "motiongan/networks/residual.hpp"
#include "motiongan/nn/self_attention.hpp"

namespace motiongan {

/// Block(h) = h + conv2(ReLU(conv1(ReLU(h)))), [T, B, C] -> [T, B, C]; `with_relu` applies a final ReLU.
inline Var residual_block(const Residual& block, const Var& h, bool with_relu = false) {
  return block.conv2(block.conv1(relu(h), {.relu = true}), {.residual = h, .relu = with_relu});
}

/// Average pooling of pairs of frames; an odd last frame is dropped: [T, B, C] -> [T / 2, B, C].
inline Var down(const Var& h) {
  return sum_pool(h.dim(0) % 2 == 0 ? h : slice(h, 0, 0, h.dim(0) - 1), 2, 0.5);
}

/// down(residual_block(h)) with half of conv2's arithmetic: pooling commutes with the convolution.
inline Var residual_block_down(const Residual& block, const Var& h) {
  const Var inner = block.conv1(relu(h), {.relu = true});
  return conv_down(pair_means(inner), block.conv2.weight, block.conv2.bias, h.dim(0), {.residual = down(h)});
}

/// The attention layer, or the identity where there is none (the paper's ablation).
inline Var attend(const std::optional<SelfAttention>& attention, const Var& h) {
  return attention ? (*attention)(h) : h;
}

/// Concatenates one vector per sample, `constants` [B, n], to the channels of every frame of x [T, B, C];
/// the result is [T, B, C + n]. Throws Error if the batch sizes differ.
inline Var with_constant_channels(const Var& x, const Var& constants) {
  const std::size_t frames = x.dim(0), batch = x.dim(1), count = constants.dim(1);
  require(constants.dim(0) == batch, "constants for ", constants.dim(0), " samples, expected ", batch);
  return concatenate({x, broadcast_to(constants, {frames, batch, count})}, 2);
}

}  // namespace motiongan
