// The distinct descriptions of clips: the candidates of a ranker.
#pragma once
#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "motiongan/data/dataset_clip.hpp"
#include "motiongan/data/vocabulary.hpp"

namespace motiongan::motion {

/// The distinct descriptions of a set of clips. Two are the same if their words are: "Run / jog" and "run
/// jog". Clips with equal captions thus have the same correct answer.
struct Descriptions {
  std::vector<std::string> texts;                 ///< most clips first, then sorted by words
  std::vector<std::size_t> clips;                 ///< number of clips with each
  std::vector<std::vector<std::size_t>> of_clip;  ///< indices of each clip's descriptions, ascending

  std::size_t size() const { return texts.size(); }

  /// The `count` most frequent ones, or all; clips with none of these keep no description.
  Descriptions most_popular(std::size_t count) const {
    Descriptions out = *this;
    if (count >= size()) return out;
    out.texts.resize(count);
    out.clips.resize(count);
    for (auto& of : out.of_clip) std::erase_if(of, [&](std::size_t d) { return d >= count; });
    return out;
  }
};

/// The distinct descriptions of `clips`; `of_clip` is in the order of `clips`.
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
