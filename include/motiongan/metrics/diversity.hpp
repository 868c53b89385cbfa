// How much motions differ from each other: over all of them, and among those of one description.
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

/// Sum of the distances of `pairs` pairs, or of all where there are no more than that, and their number.
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
  require(k > 0 && features.size() % k == 0, "found ", features.size(), " numbers, expected rows of ", k,
          " features");
  require(pairs > 0, "the mean distance of 0 pairs was asked for, expected at least 1");
}

}  // namespace diversity_detail

/// Diversity: mean Euclidean distance of `pairs` random pairs among the features [n, dimensions] of motions
/// of all descriptions together (Guo et al. 2020, Action2Motion, section 5.1; S_d = 200 there), in the
/// features' unit. Best near that of real motion; more is not better. Here a motion is never paired with
/// itself, and where there are no more than `pairs` pairs in all, each counts once. The same seed takes the
/// same pairs. Error if the sizes do not fit or there are fewer than 2 motions.
inline double diversity(std::span<const float> features, std::size_t dimensions, std::size_t pairs = 200,
                        std::uint64_t seed = 1) {
  diversity_detail::check_samples(features, dimensions, pairs);
  require(features.size() >= 2 * dimensions, "found the features of ", features.size() / dimensions,
          " motions, expected at least 2 to tell how they differ");
  const auto [sum, count] = diversity_detail::pair_distances(features, dimensions, pairs, seed);
  return sum / static_cast<double>(count);
}

/// Multimodality: the same distance among motions of one description, mean over descriptions (Guo et al.
/// 2020; S_l = 20 pairs each there). `features` are [n, dimensions], `descriptions` [n] says of which
/// description each motion is; one that has a single motion is left out. It is 0 for a generator that makes
/// the same motion whatever the noise. Error if the sizes do not fit or no description has two motions.
inline double multimodality(std::span<const float> features, std::size_t dimensions,
                            std::span<const std::size_t> descriptions, std::size_t pairs = 20,
                            std::uint64_t seed = 1) {
  diversity_detail::check_samples(features, dimensions, pairs);
  require(features.size() == dimensions * descriptions.size(), "found the features of ",
          features.size() / dimensions, " motions and the descriptions of ", descriptions.size(),
          ", expected as many");
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
