// Captions as caption files hold them: a clip's id, a text, and the part of the clip that it describes.
#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// Captions by clip id; those of a clip are in file order.
using Captions = std::map<std::string, std::vector<std::string>>;

/// A part of a clip, in seconds from the start of its file: begin <= t < end. `end` may be infinity, for the
/// end of the clip.
struct CaptionPart {
  double begin = 0, end = 0;
  bool operator==(const CaptionPart&) const = default;
  bool operator<(const CaptionPart& other) const {
    return begin != other.begin ? begin < other.begin : end < other.end;
  }
};

/// A description of a clip, or of a part of it.
struct Caption {
  std::string text;
  std::optional<CaptionPart> part = {};  ///< not set: the whole clip
  bool operator==(const Caption&) const = default;
};

/// A caption and the id of its clip.
struct CaptionLine {
  std::string id;  ///< as written in the file
  Caption caption;
  std::size_t line = 0;  ///< in its file, from 1; 0 if not known
};

/// All captions of a file, or of a folder of .txt files.
struct CaptionFile {
  std::string name;                ///< for messages; empty if there are no captions
  std::vector<CaptionLine> lines;  ///< in file order
  bool by_path = false;            ///< whether ids are only paths below the clips' folder, never file names
};

namespace caption_detail {

/// Names of the column or member that holds a clip's id, those that name a file first, and its captions.
inline constexpr std::string_view id_names[] = {"file", "filename", "file_name", "clip", "clip_id",
                                                "path", "motion",   "id",        "name"};
inline constexpr std::string_view text_names[] = {"caption",  "text",  "description",
                                                  "captions", "texts", "descriptions"};

/// ASCII letters in lower case.
inline std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// "captions.tsv:3", or without the line if that is 0.
inline std::string place(std::string_view name, std::size_t line) {
  return line == 0 ? std::string(name) : concat(name, ":", line);
}

/// Appends a caption. Throws Error if it has no words, no id or more than longest_line bytes.
inline void add_caption(CaptionFile& file, std::string_view id, std::string_view text, std::size_t line) {
  if (text.size() > longest_line)
    throw Error(place(file.name, line), ": clip '", id, "' has a description of ", text.size(),
                " bytes, expected at most ", longest_line);
  require(!id.empty(), place(file.name, line), ": found no clip id for the caption '", text, "'");
  require(!split_words(text).empty(), place(file.name, line), ": clip '", id, "' has the description '", text,
          "', expected at least one word");
  file.lines.push_back({std::string(id), {std::string(text)}, line});
}

inline void require_utf8(std::string_view text, std::string_view name, std::size_t line) {
  require(is_utf8(text), name, ":", line, ": found text that is not UTF-8; save the file as UTF-8");
}

}  // namespace caption_detail

/// Reads lines of `clip id <TAB> description`, as in the CMU index. Blank lines and lines that start with #
/// are skipped; a clip with several lines has several captions. Throws Error as `name:line: ...`.
inline CaptionFile parse_caption_lines(std::string_view text, std::string_view name) {
  CaptionFile out{std::string(name), {}};
  for_each_tab_line(text, name, "clip id <TAB> description", [&](const TabLine& line) {
    require(!line.before.empty(), name, ":", line.number, ": found no clip id before the tab");
    caption_detail::require_utf8(line.raw, name, line.number);
    caption_detail::add_caption(out, line.before, line.after, line.number);
  });
  return out;
}

}  // namespace motiongan::motion
