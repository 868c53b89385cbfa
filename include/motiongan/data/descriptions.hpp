// The distinct descriptions of clips: what a ranker chooses among.
#pragma once
#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "motiongan/data/dataset.hpp"

namespace motiongan::motion {

/// Descriptions of a set of clips, each once. Two are the same when their words are: "Run / jog" and "run
/// jog". So clips with equal captions have the same right answer.
struct Descriptions {
  std::vector<std::string> texts;                 ///< most clips first, then in the order of their words
  std::vector<std::size_t> clips;                 ///< how many clips have each
  std::vector<std::vector<std::size_t>> of_clip;  ///< the numbers of each clip's descriptions, increasing

  std::size_t size() const { return texts.size(); }

  /// The `count` that most clips have, or all; clips that have none of them are left without.
  Descriptions most_popular(std::size_t count) const {
    Descriptions out = *this;
    if (count >= size()) return out;
    out.texts.resize(count);
    out.clips.resize(count);
    for (auto& of : out.of_clip) std::erase_if(of, [&](std::size_t d) { return d >= count; });
    return out;
  }
};

/// The descriptions of `clips`, in whose order `of_clip` is.
inline Descriptions distinct_descriptions(std::span<const DatasetClip> clips) {
  struct Entry {
    std::string text;
    std::vector<std::size_t> clips;
  };
  std::map<std::vector<std::string>, Entry> by_words;
  for (std::size_t c = 0; c < clips.size(); ++c)
    for (const std::string& caption : clips[c].captions) {
      Entry& entry = by_words.try_emplace(split_words(caption), Entry{caption, {}}).first->second;
      if (entry.clips.empty() || entry.clips.back() != c) entry.clips.push_back(c);
    }
  std::vector<const Entry*> order;
  for (const auto& [words, entry] : by_words) order.push_back(&entry);
  std::stable_sort(order.begin(), order.end(),
                   [](const Entry* a, const Entry* b) { return a->clips.size() > b->clips.size(); });
  Descriptions out;
  out.of_clip.resize(clips.size());
  for (const Entry* entry : order) {
    for (const std::size_t c : entry->clips) out.of_clip[c].push_back(out.texts.size());
    out.texts.push_back(entry->text);
    out.clips.push_back(entry->clips.size());
  }
  return out;
}

}  // namespace motiongan::motion
