// The convolutional trunk shared by DVGAN's CNN critic and CNN ranker (Lin & Amer, eq. 6 and 8).
#pragma once
#include "motiongan/networks/residual.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// `encode`, then residual steps that halve the frames: level levels() has N frames, level 0 has one.
///
/// encode() and the layers that read its result are linear, so those layers are applied to the motion itself,
/// with their weights multiplied by encode's. A pose has fewer values than a hidden state, and the largest
/// activation is never stored. A channel of ones carries encode's bias, through the zero padding too.
class CnnTrunk {
 public:
  CnnTrunk() = default;
  /// Throws Error if frames (N) is not a power of two.
  CnnTrunk(Initializer& init, std::size_t dof, std::size_t frames, std::size_t hidden, std::size_t taps_count)
      : encode_(init, dof, hidden) {
    const std::size_t levels = levels_of(frames);
    for (std::size_t i = 0; i < levels; ++i) residual_.emplace_back(init, hidden, taps_count);
  }

  std::size_t levels() const { return residual_.size(); }

  /// The motion [N, B, M] with a channel of ones appended, [N, B, M + 1]: the input that encoding() expects.
  static Var with_ones(const Var& motion) {
    return concatenate({motion, ones(motion.context(), {motion.dim(0), motion.dim(1), 1})}, 2);
  }

  /// The hidden states [N, B, k] of the motion: for frames of more values than a hidden state, with which
  /// composed weights would be larger.
  Var encoded(const Var& motion) const { return encode_(motion); }

  /// Weight and bias of `encode`, concatenated: [k, M + 1].
  Var encoding() const {
    const std::size_t out = encode_.weight.dim(1), in = encode_.weight.dim(2);
    return concatenate({reshape(encode_.weight, {out, in}), reshape(encode_.bias, {out, 1})}, 1);
  }

  /// The weights of `conv` composed with encoding(): [taps, out, M + 1].
  static Var after(const Conv1d& conv, const Var& encoding) {
    const std::size_t count = conv.weight.dim(0), out = conv.weight.dim(1), k = conv.weight.dim(2);
    return reshape(matmul(reshape(conv.weight, {count * out, k}), encoding), {count, out, encoding.dim(1)});
  }

  /// Level i from level i + 1, with half the frames: Down(h) + conv2(ReLU(Down(conv1(h)))), Down being the
  /// mean of pairs of frames. At the finest level h is with_ones(motion), to which `encoding` is still to be
  /// applied; without an encoding it is encoded(motion).
  Var halve(std::size_t i, const Var& h, const Var& encoding) const {
    const Residual& r = residual_[i];
    const bool finest = i + 1 == levels() && !encoding.empty();
    const std::size_t frames = h.dim(0), half = frames / 2;
    const Var pairs = pair_means(h), weight = finest ? after(r.conv1, encoding) : r.conv1.weight;
    Var down = slice(pairs, 0, half + 1, half);
    if (finest) down = linear(down, encoding);
    const Var inner =
        weight.dim(0) == 3
            ? conv_down(pairs, weight, r.conv1.bias, frames, {.relu = true})
            : relu(sum_pool(conv1d(h, weight, r.conv1.offsets(), frames, false, {.bias = r.conv1.bias}), 2,
                            0.5));
    return r.conv2(inner, {.residual = down});
  }

  /// Adds `encode` and `residual.{i}` to the owner's list, without a prefix.
  void list_parameters(ParameterList& list) {
    list.add_module("encode", encode_);
    for (std::size_t i = 0; i < levels(); ++i) list.add_module("residual." + std::to_string(i), residual_[i]);
  }

 private:
  Conv1d encode_;
  std::vector<Residual> residual_;  // residual_[i] computes level i from level i + 1
};

}  // namespace motiongan
