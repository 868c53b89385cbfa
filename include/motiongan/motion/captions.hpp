// What people say about clips: caption files, and names where there is no file.
#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/text_file.hpp"
#include "motiongan/motion/vocabulary.hpp"

namespace motiongan::motion {

/// Captions by clip id, in the order of the file.
using Captions = std::map<std::string, std::vector<std::string>>;

/// Reads lines of `clip id <TAB> description`, as the CMU index has them. Lines that start with # and blank
/// lines are skipped; a clip with several lines has several captions. Errors are `name:line: ...`.
inline Captions parse_captions(std::string_view text, std::string_view name) {
  constexpr std::string_view blanks = " \t\r\v\f";
  const auto trim = [&](std::string_view s) {
    const std::size_t first = s.find_first_not_of(blanks);
    return first == s.npos ? std::string_view() : s.substr(first, s.find_last_not_of(blanks) - first + 1);
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Captions out;
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::string_view raw = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), raw.size() + 1));
    if (trim(raw).empty() || trim(raw).front() == '#') continue;
    const std::size_t tab = raw.find('\t');
    require(tab != raw.npos, name, ":", line, ": found no tab in '", trim(raw).substr(0, 60),
            "', expected clip id <TAB> description");
    const std::string_view id = trim(raw.substr(0, tab)), description = trim(raw.substr(tab));
    require(!id.empty(), name, ":", line, ": found no clip id before the tab");
    require(!split_words(description).empty(), name, ":", line, ": clip '", id, "' has the description '",
            description, "', expected at least one word");
    require(is_utf8(raw), name, ":", line, ": found text that is not UTF-8; save the file as UTF-8");
    out[std::string(id)].emplace_back(description);
  }
  return out;
}

inline Captions read_captions(const std::filesystem::path& path) {
  return parse_captions(read_text(path, "caption file"), path.string());
}

/// A caption for a clip that has none: the letters of its file's name, words apart
/// (`dataset-1_walk_happy_001.bvh`: "dataset walk happy"); if the name has no letters, its folder's name.
inline std::string caption_from_name(const std::filesystem::path& path) {
  std::string letters = path.stem().string();
  for (char& c : letters)
    if (c >= '0' && c <= '9') c = ' ';
  std::string out;
  for (const std::string& word : split_words(letters)) out += (out.empty() ? "" : " ") + word;
  if (!out.empty()) return out;
  for (const std::string& word : split_words(path.parent_path().filename().string()))
    out += (out.empty() ? "" : " ") + word;
  return out.empty() ? "motion" : out;
}

}  // namespace motiongan::motion
