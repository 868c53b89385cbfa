// The words of captions and their indices.
#pragma once
#include <algorithm>
#include <cstddef>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

/// The words of a caption: lower-case, split at anything but letters and digits. Bytes of other scripts
/// (UTF-8, 0x80 and above) count as letters and keep their case.
inline std::vector<std::string> split_words(std::string_view caption) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : caption) {
    const bool upper = c >= 'A' && c <= 'Z';
    const bool part = upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (c & 0x80) != 0;
    if (part) {
      word += upper ? static_cast<char>(c - 'A' + 'a') : c;
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, {}));
    }
  }
  if (!word.empty()) words.push_back(word);
  return words;
}

/// Words of a caption that models use, the first ones: an encoder takes a step for each.
inline constexpr std::size_t most_caption_words = 256;

/// The words of a caption that models use.
inline std::vector<std::string> used_words(std::string_view caption) {
  std::vector<std::string> words = split_words(caption);
  if (words.size() > most_caption_words) words.resize(most_caption_words);
  return words;
}

/// "has 300 words, of which the first 256 are used"; empty if all are used.
inline std::string word_limit_note(std::string_view caption) {
  if (caption.size() < 2 * most_caption_words) return {};  // a word is at least a letter and a blank
  const std::size_t words = split_words(caption).size();
  return words <= most_caption_words
             ? std::string()
             : concat("has ", words, " words, of which the first ", most_caption_words, " are used");
}

/// Words in a fixed order; index 0 is `<unk>`, which stands for every unknown word.
class Vocabulary {
 public:
  /// The word that stands for all others.
  static constexpr const char* unknown = "<unk>";

  Vocabulary() : Vocabulary(std::vector<std::string>{unknown}) {}

  /// From a word list as returned by words(). Throws Error if it does not start with `<unk>`, or has a word
  /// twice or one that no caption can contain.
  explicit Vocabulary(std::vector<std::string> words) : words_(std::move(words)) {
    require(!words_.empty() && words_.front() == unknown, "the first word of a vocabulary is '",
            words_.empty() ? std::string() : words_.front(), "', expected '", unknown, "'");
    for (std::size_t i = 0; i < words_.size(); ++i) {
      require(i == 0 || split_words(words_[i]) == std::vector<std::string>{words_[i]}, "word ", i,
              " of a vocabulary is '", words_[i], "', expected lower-case letters and digits");
      require(index_.emplace(words_[i], static_cast<int>(i)).second, "word ", i, " of a vocabulary, '",
              words_[i], "', appears twice");
    }
  }

  /// All words of the captions that models use, sorted bytewise.
  static Vocabulary from_captions(std::span<const std::string> captions) {
    std::set<std::string> sorted;
    for (const std::string& caption : captions)
      for (std::string& word : used_words(caption)) sorted.insert(std::move(word));
    std::vector<std::string> words{unknown};
    words.insert(words.end(), sorted.begin(), sorted.end());
    return Vocabulary(std::move(words));
  }

  const std::vector<std::string>& words() const { return words_; }
  std::size_t size() const { return words_.size(); }

  /// Index of a word, 0 if it is unknown.
  int find(const std::string& word) const {
    const auto at = index_.find(word);
    return at == index_.end() ? 0 : at->second;
  }

  /// The caption as word indices, at most most_caption_words. Throws Error if it has no word.
  std::vector<int> encode(std::string_view caption) const {
    std::vector<int> out;
    for (const std::string& word : used_words(caption)) out.push_back(find(word));
    require(!out.empty(), "the caption '", caption,
            "' has no words; describe the motion in letters or digits");
    return out;
  }

  /// The caption's words, of those that models use, that are not in the vocabulary, to warn about.
  std::vector<std::string> unknown_words(std::string_view caption) const {
    std::vector<std::string> out;
    for (std::string& word : used_words(caption))
      if (find(word) == 0) out.push_back(std::move(word));
    return out;
  }

 private:
  std::vector<std::string> words_;
  std::unordered_map<std::string, int> index_;
};

}  // namespace motiongan::motion
