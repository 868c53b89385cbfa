// Linear layers and convolutions along time, with PyTorch's default initialisation U(+-1/sqrt(fan_in)).
#pragma once
#include <cmath>

#include "motiongan/nn/module.hpp"
#include "motiongan/ops/conv1d.hpp"

namespace motiongan {

/// Convolution along time, stride 1, zero "same" padding: [T, B, in] -> [T, B, out]. With one tap it is a
/// linear layer on the last axis, for any rank: [..., in] -> [..., out]. `weight` is [taps, out, in] in
/// memory and [out, in, taps] in files; `bias` is [out].
struct Conv1d {
  Var weight, bias;

  Conv1d() = default;
  /// Throws Error if the number of taps is even.
  Conv1d(Initializer& init, std::size_t in, std::size_t out, std::size_t taps_count = 1) {
    require(taps_count % 2 == 1, "Conv1d: taps is ", taps_count, ", expected an odd number for same padding");
    const double bound = 1 / std::sqrt(static_cast<double>(in * taps_count));
    weight = init.uniform({taps_count, out, in}, bound);
    bias = init.uniform({out}, bound);
  }

  std::size_t out_channels() const { return weight.dim(1); }

  /// Frame offsets of the taps, e.g. -1, 0, 1.
  Offsets offsets() const {
    const int reach = static_cast<int>(weight.dim(0) / 2);
    Offsets list;
    for (int s = -reach; s <= reach; ++s) list.push_back(s);
    return list;
  }

  /// conv(x) + bias + extras.residual, then ReLU if extras.relu; extras.bias is ignored.
  Var operator()(const Var& x, const Conv1dEpilogue& extras = {}) const {
    return conv1d(x, weight, offsets(), x.dim(0), false,
                  {.bias = bias, .residual = extras.residual, .relu = extras.relu});
  }

  void list_parameters(ParameterList& list) {
    list.add("weight", weight, ParameterLayout::convolution);
    list.add("bias", bias);
  }
};

/// Down(conv(x)) for a convolution with 3 taps at half the cost: the mean of two neighbouring outputs is the
/// convolution of the means of neighbouring inputs. `pairs` is pair_means(x) of x [frames, B, in]; the result
/// is [frames / 2, B, out], with optional residual and ReLU (extras.bias is ignored). Throws Error unless
/// there are 3 taps and `pairs` are of that many frames.
inline Var conv_down(const Var& pairs, const Var& weight, const Var& bias, std::size_t frames,
                     const Conv1dEpilogue& extras = {}) {
  require(weight.dim(0) == 3, "conv_down: weight has ", weight.dim(0), " taps, expected 3");
  require(pairs.dim(0) == 2 * (frames / 2) + 1, "conv_down: pairs ", pairs.shape(), " of ", frames,
          " frames, expected ", 2 * (frames / 2) + 1);
  const int half = static_cast<int>(frames / 2);
  return conv1d(pairs, weight, {0, half + 1, 1}, frames / 2, false,
                {.bias = bias, .residual = extras.residual, .relu = extras.relu});
}

/// y = x W^T + b on the last axis, then ReLU if asked: [..., in] -> [..., out]. `weight` is [out, in], `bias`
/// [out].
struct Linear {
  Var weight, bias;

  Linear() = default;
  Linear(Initializer& init, std::size_t in, std::size_t out) {
    const double bound = 1 / std::sqrt(static_cast<double>(in));
    weight = init.uniform({out, in}, bound);
    bias = init.uniform({out}, bound);
  }

  Var operator()(const Var& x, bool with_relu = false) const {
    return linear(x, weight, {.bias = bias, .relu = with_relu});
  }

  void list_parameters(ParameterList& list) {
    list.add("weight", weight);
    list.add("bias", bias);
  }
};

}  // namespace motiongan
