// Splitting clips into training and test parts, identically on every machine.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

/// The next number of the splitmix64 sequence (Steele, Lea & Flood 2014).
inline std::uint64_t splitmix64(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/// Whether each of `count` clips is for training: a seeded Fisher-Yates shuffle whose first `train_share` (a
/// fraction; rounded, and leaving at least one clip in each part if there are two) are. Throws Error unless 0
/// < train_share <= 1.
inline std::vector<bool> split_clips(std::size_t count, double train_share, std::uint64_t seed) {
  require(train_share > 0 && train_share <= 1, "train_share is ", train_share,
          ", expected more than 0 and at most 1");
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(splitmix64(seed) % i)]);
  auto train = static_cast<std::size_t>(std::lround(train_share * static_cast<double>(count)));
  if (count >= 2) train = std::clamp<std::size_t>(train, 1, count - 1);
  if (count == 1) train = 1;
  std::vector<bool> is_train(count, false);
  for (std::size_t i = 0; i < train; ++i) is_train[order[i]] = true;
  return is_train;
}

}  // namespace motiongan::motion
