// The training descriptions of a model that are nearest to a text with words it never saw.
#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/data/vocabulary.hpp"

namespace motiongan::motion {

/// How alike two words are, 0 .. 1: 1 if equal, else their common beginning as a share of the longer one if
/// that has at least three letters ("running" and "run"), else 0.
inline double word_likeness(std::string_view a, std::string_view b) {
  if (a == b) return 1;
  const auto differ = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto common = static_cast<std::size_t>(differ.first - a.begin());
  return common < 3 ? 0 : static_cast<double>(common) / static_cast<double>(std::max(a.size(), b.size()));
}

/// At most `count` of `descriptions` that share words, or their beginnings, with the text, nearest first: by
/// the sum over the words of the text of their likeness to the most alike word. Of equal ones those with
/// fewer words, then those listed first. Empty if none shares any.
inline std::vector<std::string> nearest_descriptions(std::span<const std::string> descriptions,
                                                     std::string_view text, std::size_t count = 3) {
  struct Match {
    double likeness;
    std::size_t words;
    const std::string* description;
  };
  const std::vector<std::string> wanted = used_words(text);
  std::vector<Match> matches;
  for (const std::string& description : descriptions) {
    const std::vector<std::string> words = used_words(description);
    Match match{0, words.size(), &description};
    for (const std::string& w : wanted) {
      double most = 0;
      for (const std::string& v : words) most = std::max(most, word_likeness(w, v));
      match.likeness += most;
    }
    if (match.likeness > 0) matches.push_back(match);
  }
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
    return std::pair(-a.likeness, a.words) < std::pair(-b.likeness, b.words);
  });
  std::vector<std::string> out;
  for (std::size_t i = 0; i < std::min(count, matches.size()); ++i) out.push_back(*matches[i].description);
  return out;
}

}  // namespace motiongan::motion
