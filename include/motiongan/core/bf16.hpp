// Weights of 16 bits: a bfloat16 is the upper half of a float, with its range and 8 bits of precision.
#pragma once
#include "motiongan/core/keep_packed.hpp"

namespace motiongan {

/// Rounds every element to the nearest bfloat16, ties to even.
inline void round_to_bf16(const Tensor& x) {
  if (x.size() == 0) return;
  const Context& context = x.context();
  detail::forget_packed(x);
  context.launch("bf16", "round_to_bf16",
                 LaunchGrid::items((x.size() + context.vector_width() - 1) / context.vector_width()), x,
                 x.size());
}

}  // namespace motiongan
