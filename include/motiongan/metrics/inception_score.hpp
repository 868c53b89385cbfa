// Inception score of motion, from a ranker's scores (Lin & Amer, eq. 7).
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// H(mean p) - mean H(p) in nats (Lin & Amer, eq. 7), p being the softmax of a sample's scores over K
/// descriptions. It is 0 if all samples have the same p, and at most log K, if each sample matches one
/// description with certainty and all descriptions are equally frequent. Most papers report its exponential;
/// Lin & Amer report nats. `scores` is [n, K], `descriptions` K. Throws Error if the sizes do not fit or
/// there is no sample.
inline double inception_score(std::span<const float> scores, std::size_t descriptions) {
  require(descriptions > 0 && !scores.empty() && scores.size() % descriptions == 0, "found ", scores.size(),
          " scores over ", descriptions,
          " descriptions, expected one score per sample and description, and at least one sample");
  const std::size_t samples = scores.size() / descriptions;
  std::vector<double> mean(descriptions, 0), p(descriptions);
  const auto entropy = [](const std::vector<double>& q) {
    double h = 0;
    for (const double x : q)
      if (x > 0) h -= x * std::log(x);
    return h;
  };
  double each = 0;
  for (std::size_t s = 0; s < samples; ++s) {
    const std::span<const float> row = scores.subspan(s * descriptions, descriptions);
    double best = row[0], total = 0;
    for (const float score : row) best = std::max(best, static_cast<double>(score));
    for (std::size_t d = 0; d < descriptions; ++d) total += p[d] = std::exp(row[d] - best);
    for (std::size_t d = 0; d < descriptions; ++d) mean[d] += (p[d] /= total) / static_cast<double>(samples);
    each += entropy(p) / static_cast<double>(samples);
  }
  return entropy(mean) - each;
}

}  // namespace motiongan
