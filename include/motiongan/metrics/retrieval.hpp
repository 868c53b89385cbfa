// How often a ranker finds the right description of a motion among K (Lin & Amer, Tables 1 and 2; SPEC 7).
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

/// R@1, 3, 5, 10: per cent of samples whose right description is among the k best.
using Recall = std::array<double, recall_ranks.size()>;

/// What guessing comes to: 100 k / K, at most 100.
inline Recall random_recall(std::size_t descriptions) {
  require(descriptions > 0, "random recall among 0 descriptions");
  Recall out{};
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = std::min(100.0, 100 * static_cast<double>(recall_ranks[i]) / static_cast<double>(descriptions));
  return out;
}

/// R@k of all samples, and of those of each description.
struct Retrieval {
  struct Part {
    std::size_t description = 0;  ///< its number
    std::size_t samples = 0;
    Recall recall{};
    double mean_rank = 0;  ///< of the right description, from 1
  };
  std::size_t descriptions = 0;  ///< K
  std::size_t samples = 0;
  Recall recall{};
  double mean_rank = 0;
  std::vector<Part> parts = {};  ///< in the order of the descriptions; those without a sample are left out

  /// Mean of the parts' recall: every description counts alike, however many samples it has.
  Recall by_description() const {
    Recall out{};
    for (const Part& part : parts)
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] += part.recall[i] / static_cast<double>(parts.size());
    return out;
  }
};

/// What always ranking description 0 first, then 1 and so on comes to, whatever the motion: where
/// descriptions stand in the order of how common they are, the best that can be done blindly. Far above
/// chance if a few descriptions have most of the samples.
inline Recall blind_recall(std::span<const std::vector<std::size_t>> right) {
  require(!right.empty(), "there is no sample to rank descriptions for");
  Recall out{};
  for (const std::vector<std::size_t>& of : right)
    for (std::size_t i = 0; i < out.size(); ++i)
      if (*std::min_element(of.begin(), of.end()) < recall_ranks[i])
        out[i] += 100 / static_cast<double>(right.size());
  return out;
}

/// The rank of description `d`, from 1, among those that are not `right` too. Equal scores count against it:
/// a ranker that cannot tell two descriptions apart has not found either.
inline std::size_t rank_of(std::span<const float> scores, std::size_t d, std::span<const std::size_t> right) {
  require(d < scores.size(), "description ", d, " of ", scores.size());
  std::size_t rank = 1;
  for (std::size_t other = 0; other < scores.size(); ++other)
    if (other != d && std::find(right.begin(), right.end(), other) == right.end() &&
        !(scores[other] < scores[d]))
      ++rank;
  return rank;
}

/// Of `scores` [n, K], where sample s is rightly described by any of `right[s]`: its rank is that of the best
/// of them. In the parts it counts for each of them, with that one's rank. Every sample counts alike.
inline Retrieval retrieval(std::span<const float> scores, std::size_t descriptions,
                           std::span<const std::vector<std::size_t>> right) {
  require(descriptions > 0 && scores.size() == right.size() * descriptions, "found ", scores.size(),
          " scores of ", right.size(), " samples, expected ", descriptions, " each");
  require(!right.empty(), "there is no sample to rank descriptions for");
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
