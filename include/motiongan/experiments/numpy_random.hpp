// numpy's old random numbers, for protocols that are written in terms of them (SPEC section 7, item 2).
#pragma once
#include <cstdint>
#include <random>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// The whole numbers that numpy's `RandomState(seed)` draws with `randint(low, high)`: the same ones in the
/// same order. The generator is MT19937, seeded as its authors did (init_genrand, which std::mt19937 does
/// too); a draw takes as many low bits of the next number as the range needs, and draws again while they
/// are out of range.
class NumpyRandom {
 public:
  explicit NumpyRandom(std::uint32_t seed) : engine_(seed) {}

  /// A whole number of [low, high), high itself left out. A range of one number takes nothing from the
  /// generator, one of more than 2^32 takes two of its numbers for each try, the upper half first. Error for
  /// an empty range.
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
