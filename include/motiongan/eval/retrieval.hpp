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
  std::vector<Part> parts;  ///< in the order of the descriptions; those without a sample are left out

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

/// The rank of the best of the `right` descriptions, from 1. Equal scores count against it: a ranker that
/// cannot tell two descriptions apart has not found either.
inline std::size_t rank_of_right(std::span<const float> scores, std::span<const std::size_t> right) {
  require(!right.empty(), "a sample without a right description cannot be ranked");
  std::size_t best = scores.size();
  for (const std::size_t r : right) {
    require(r < scores.size(), "description ", r, " of ", scores.size());
    std::size_t rank = 1;
    for (std::size_t d = 0; d < scores.size(); ++d) {
      const bool other = std::find(right.begin(), right.end(), d) == right.end();
      rank += other && !(scores[d] < scores[r]) ? 1 : 0;
    }
    best = std::min(best, rank);
  }
  return best;
}

/// Of `scores` [n, K], where sample s is rightly described by any of `right[s]`; a sample counts among those
/// of its first right description. Every sample counts alike.
inline Retrieval retrieval(std::span<const float> scores, std::size_t descriptions,
                           std::span<const std::vector<std::size_t>> right) {
  require(descriptions > 0 && scores.size() == right.size() * descriptions, "found ", scores.size(),
          " scores of ", right.size(), " samples, expected ", descriptions, " each");
  require(!right.empty(), "there is no sample to rank descriptions for");
  Retrieval out;
  out.descriptions = descriptions;
  out.samples = right.size();
  std::vector<Retrieval::Part> parts(descriptions);
  for (std::size_t s = 0; s < right.size(); ++s) {
    const std::size_t rank = rank_of_right(scores.subspan(s * descriptions, descriptions), right[s]);
    Retrieval::Part& part = parts[right[s].front()];
    ++part.samples;
    part.mean_rank += static_cast<double>(rank);
    for (std::size_t i = 0; i < recall_ranks.size(); ++i)
      part.recall[i] += rank <= recall_ranks[i] ? 100.0 : 0.0;
  }
  for (std::size_t d = 0; d < descriptions; ++d) {
    Retrieval::Part& part = parts[d];
    if (part.samples == 0) continue;
    out.mean_rank += part.mean_rank / static_cast<double>(out.samples);
    part.mean_rank /= static_cast<double>(part.samples);
    for (std::size_t i = 0; i < recall_ranks.size(); ++i) {
      out.recall[i] += part.recall[i] / static_cast<double>(out.samples);
      part.recall[i] /= static_cast<double>(part.samples);
    }
    part.description = d;
    out.parts.push_back(part);
  }
  return out;
}

}  // namespace motiongan
