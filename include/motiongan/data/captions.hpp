// Captions of clips, from caption files or from file names.
#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// Captions by clip id; those of a clip are in file order.
using Captions = std::map<std::string, std::vector<std::string>>;

/// Reads lines of `clip id <TAB> description`, as in the CMU index. Blank lines and lines that start with #
/// are skipped; a clip with several lines has several captions. Throws Error as `name:line: ...`.
inline Captions parse_captions(std::string_view text, std::string_view name) {
  Captions out;
  for_each_tab_line(text, name, "clip id <TAB> description", [&](const TabLine& line) {
    const auto [id, description] = std::pair{line.before, line.after};
    require(!id.empty(), name, ":", line.number, ": found no clip id before the tab");
    require(!split_words(description).empty(), name, ":", line.number, ": clip '", id,
            "' has the description '", description, "', expected at least one word");
    require(is_utf8(line.raw), name, ":", line.number,
            ": found text that is not UTF-8; save the file as UTF-8");
    out[std::string(id)].emplace_back(description);
  });
  return out;
}

/// As parse_captions, from a file. Throws Error also if the file cannot be read.
inline Captions read_captions(const std::filesystem::path& path) {
  return parse_captions(read_text(path, "caption file"), path.string());
}

/// A caption for a clip without one: the words of its file name, without digits
/// (`dataset-1_walk_happy_001.bvh`: "dataset walk happy"); if there are none, the words of its folder's name,
/// else "motion".
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
