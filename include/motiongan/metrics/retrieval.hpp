// Retrieval accuracy of a ranker: R@k among K descriptions (Lin & Amer, Tables 1 and 2).
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// The k of R@k.
inline constexpr std::array<std::size_t, 4> recall_ranks{1, 3, 5, 10};

/// R@1, 3, 5, 10: percentage of samples whose right description is among the k best.
using Recall = std::array<double, recall_ranks.size()>;

/// R@k of random guessing: 100 k / K, at most 100. Throws Error if K is 0.
inline Recall random_recall(std::size_t descriptions) {
  require(descriptions > 0, "descriptions is 0, expected at least 1");
  Recall out{};
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::min(100.0, 100 * static_cast<double>(recall_ranks[i]) / static_cast<double>(descriptions));
  return out;
}

/// R@k over all samples and per description.
struct Retrieval {
  /// The samples of one description.
  struct Part {
    std::size_t description = 0;  ///< index of the description
    std::size_t samples = 0;
    Recall recall{};
    double mean_rank = 0;  ///< mean rank of the right description, from 1
  };
  std::size_t descriptions = 0;  ///< K
  std::size_t samples = 0;
  Recall recall{};
  double mean_rank = 0;
  std::vector<Part> parts = {};  ///< by description; descriptions without samples are omitted

  /// Recall averaged over descriptions, regardless of their numbers of samples.
  Recall by_description() const {
    Recall out{};
    for (const Part& part : parts)
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] += part.recall[i] / static_cast<double>(parts.size());
    return out;
  }
};

/// R@k of always ranking the descriptions 0, 1, 2, ... in that order, whatever the motion: with descriptions
/// sorted by frequency, the best result without looking at the motion. It is far above chance if few
/// descriptions have most of the samples. `right` lists each sample's right descriptions. Throws Error
/// without samples.
inline Recall blind_recall(std::span<const std::vector<std::size_t>> right) {
  require(!right.empty(), "there are no samples, expected at least one");
  Recall out{};
  for (const std::vector<std::size_t>& of : right)
    for (std::size_t i = 0; i < out.size(); ++i)
      if (*std::min_element(of.begin(), of.end()) < recall_ranks[i])
        out[i] += 100 / static_cast<double>(right.size());
  return out;
}

/// The rank of description `d`, from 1, among the descriptions not in `right`. Ties count against it: a
/// ranker that cannot distinguish two descriptions has found neither. Throws Error if `d` is out of range.
inline std::size_t rank_of(std::span<const float> scores, std::size_t d, std::span<const std::size_t> right) {
  require(d < scores.size(), "description ", d, " is out of range, there are ", scores.size());
  std::size_t rank = 1;
  for (std::size_t other = 0; other < scores.size(); ++other)
    if (other != d && std::find(right.begin(), right.end(), other) == right.end() &&
        !(scores[other] < scores[d]))
      ++rank;
  return rank;
}

/// Retrieval results from `scores` [n, K] with K = `descriptions`. Any of `right[s]` describes sample s; its
/// rank is that of the best-ranked of them. In `parts` the sample counts for each of them, with that
/// description's rank. Throws Error if the sizes do not fit, without samples, and for a sample without a
/// right description.
inline Retrieval retrieval(std::span<const float> scores, std::size_t descriptions,
                           std::span<const std::vector<std::size_t>> right) {
  require(descriptions > 0 && scores.size() == right.size() * descriptions, "found ", scores.size(),
          " scores of ", right.size(), " samples, expected ", descriptions, " each");
  require(!right.empty(), "there are no samples, expected at least one");
  Retrieval out{.descriptions = descriptions, .samples = right.size()};
  std::vector<Retrieval::Part> parts(descriptions);
  const auto add = [](Recall& recall, std::size_t rank) {
    for (std::size_t i = 0; i < recall_ranks.size(); ++i) recall[i] += rank <= recall_ranks[i] ? 100.0 : 0.0;
  };
  for (std::size_t s = 0; s < right.size(); ++s) {
    require(!right[s].empty(), "sample ", s, " has no right description");
    std::size_t best = descriptions;
    for (const std::size_t d : right[s]) {
      const std::size_t rank = rank_of(scores.subspan(s * descriptions, descriptions), d, right[s]);
      best = std::min(best, rank);
      ++parts[d].samples;
      parts[d].mean_rank += static_cast<double>(rank);
      add(parts[d].recall, rank);
    }
    out.mean_rank += static_cast<double>(best);
    add(out.recall, best);
  }
  out.mean_rank /= static_cast<double>(out.samples);
  for (double& r : out.recall) r /= static_cast<double>(out.samples);
  for (std::size_t d = 0; d < descriptions; ++d) {
    Retrieval::Part& part = parts[d];
    if (part.samples == 0) continue;
    part.description = d;
    part.mean_rank /= static_cast<double>(part.samples);
    for (double& r : part.recall) r /= static_cast<double>(part.samples);
    out.parts.push_back(part);
  }
  return out;
}

}  // namespace motiongan
