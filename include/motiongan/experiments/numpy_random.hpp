// NumPy's legacy random integers, which the motion-prediction protocol draws its tests with.
#pragma once
#include <cstdint>
#include <random>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// Reproduces the sequence of NumPy's `RandomState(seed).randint(low, high)`: MT19937, seeded with
/// init_genrand as std::mt19937 is, and masked rejection sampling: the low bits that the range needs, redrawn
/// while out of range.
class NumpyRandom {
 public:
  /// As numpy.random.RandomState(seed).
  explicit NumpyRandom(std::uint32_t seed) : engine_(seed) {}

  /// An integer in [low, high). A range of one value draws nothing from the generator; a range of more than
  /// 2^32 values draws two words per try, the upper half first. Throws Error if the range is empty.
  std::int64_t randint(std::int64_t low, std::int64_t high) {
    require(low < high, "randint(", low, ", ", high, "): the range is empty, expected low < high");
    const std::uint64_t largest = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) - 1;
    if (largest == 0) return low;
    std::uint64_t mask = largest;
    for (unsigned shift = 1; shift < 64; shift *= 2) mask |= mask >> shift;
    std::uint64_t drawn = 0;
    do {
      drawn = engine_();
      if (largest > 0xffffffffu) drawn = drawn << 32 | engine_();
      drawn &= mask;
    } while (drawn > largest);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + drawn);
  }

 private:
  std::mt19937 engine_;
};

}  // namespace motiongan
