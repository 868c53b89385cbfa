// The two convolutions of a residual step, and the number of levels: shared by generator, critic and ranker.
#pragma once
#include <bit>

#include "motiongan/nn/linear.hpp"

namespace motiongan {

/// The convolutions of a residual step, k channels in and out; each owner says how they are combined.
struct Residual {
  Conv1d conv1, conv2;

  Residual() = default;
  Residual(Initializer& init, std::size_t k, std::size_t taps_count)
      : conv1(init, k, k, taps_count), conv2(init, k, k, taps_count) {}

  void list_parameters(ParameterList& list) {
    list.add_module("conv1", conv1);
    list.add_module("conv2", conv2);
  }
};

/// log2 of a number of frames. Throws Error, naming the nearest powers of two, if it is not a power of two.
inline std::size_t levels_of(std::size_t frames) {
  if (frames >= 1 && std::has_single_bit(frames)) return static_cast<std::size_t>(std::countr_zero(frames));
  const std::size_t below = frames < 1 ? 1 : std::bit_floor(frames);
  throw Error("the CNN models need a power of two as frames, found ", frames, "; the nearest are ", below,
              " and ", frames < 1 ? 2 : 2 * below);
}

}  // namespace motiongan
