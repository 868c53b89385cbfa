// Diversity and multimodality: how much motions differ overall, and within one description.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/split.hpp"

namespace motiongan {

namespace diversity_detail {

inline double apart(std::span<const float> features, std::size_t k, std::size_t a, std::size_t b) {
  double squares = 0;
  for (std::size_t d = 0; d < k; ++d) {
    const double difference =
        static_cast<double>(features[a * k + d]) - static_cast<double>(features[b * k + d]);
    squares += difference * difference;
  }
  return std::sqrt(squares);
}

/// Sum of the distances of `pairs` random pairs, or of all pairs if there are no more, and the number of
/// pairs.
inline std::pair<double, std::size_t> pair_distances(std::span<const float> features, std::size_t k,
                                                     std::size_t pairs, std::uint64_t& state) {
  const std::size_t n = features.size() / k, all = n * (n - 1) / 2;
  double sum = 0;
  if (pairs >= all) {
    for (std::size_t a = 1; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b) sum += apart(features, k, a, b);
    return {sum, all};
  }
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto a = static_cast<std::size_t>(motion::splitmix64(state) % n);
    const auto other = static_cast<std::size_t>(motion::splitmix64(state) % (n - 1));
    sum += apart(features, k, a, other < a ? other : other + 1);
  }
  return {sum, pairs};
}

inline void check_samples(std::span<const float> features, std::size_t k, std::size_t pairs) {
  require(k > 0 && features.size() % k == 0, "found ", features.size(), " values, expected rows of ", k,
          " features");
  require(pairs > 0, "pairs is 0, expected at least 1");
}

}  // namespace diversity_detail

/// Diversity: mean Euclidean distance of `pairs` random pairs of the features [n, dimensions] of motions of
/// all descriptions (Guo et al. 2020, Action2Motion, section 5.1, with S_d = 200), in the features' unit. It
/// should be close to that of real motion; higher is not better. Unlike the paper's, a motion is never paired
/// with itself, and if there are at most `pairs` pairs, each is used once. The same seed gives the same
/// pairs. Throws Error if the sizes do not fit or there are fewer than 2 motions.
inline double diversity(std::span<const float> features, std::size_t dimensions, std::size_t pairs = 200,
                        std::uint64_t seed = 1) {
  diversity_detail::check_samples(features, dimensions, pairs);
  require(features.size() >= 2 * dimensions, "found the features of ", features.size() / dimensions,
          " motions, expected at least 2");
  const auto [sum, count] = diversity_detail::pair_distances(features, dimensions, pairs, seed);
  return sum / static_cast<double>(count);
}

/// Multimodality: the same distance among motions of one description, averaged over descriptions (Guo et al.
/// 2020, with S_l = 20 pairs each). `features` are [n, dimensions], `descriptions` [n] the index of each
/// motion's description; a description with a single motion is left out. It is 0 for a generator that ignores
/// its noise. Throws Error if the sizes do not fit or no description has two motions.
inline double multimodality(std::span<const float> features, std::size_t dimensions,
                            std::span<const std::size_t> descriptions, std::size_t pairs = 20,
                            std::uint64_t seed = 1) {
  diversity_detail::check_samples(features, dimensions, pairs);
  require(features.size() == dimensions * descriptions.size(), "found the features of ",
          features.size() / dimensions, " motions and the descriptions of ", descriptions.size(),
          ", expected the same number");
  std::map<std::size_t, std::vector<float>> by_description;
  for (std::size_t i = 0; i < descriptions.size(); ++i) {
    const std::span<const float> row = features.subspan(i * dimensions, dimensions);
    std::vector<float>& rows = by_description[descriptions[i]];
    rows.insert(rows.end(), row.begin(), row.end());
  }
  double sum = 0;
  std::size_t counted = 0;
  for (const auto& [description, rows] : by_description) {
    if (rows.size() < 2 * dimensions) continue;
    const auto [distances, count] = diversity_detail::pair_distances(rows, dimensions, pairs, seed);
    sum += distances / static_cast<double>(count);
    ++counted;
  }
  require(counted > 0, "none of ", by_description.size(),
          " descriptions has two motions; multimodality needs at least 2 of one");
  return sum / static_cast<double>(counted);
}

}  // namespace motiongan
