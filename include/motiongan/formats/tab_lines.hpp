// Hand-written text files: lines with comments and blank lines, and lists of two tab-separated texts per
// line.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string_view>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

/// The text without blanks at both ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\v\f";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == text.npos ? std::string_view()
                            : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Whether the text begins like UTF-16: with its byte order mark, or with a NUL in most pairs of bytes,
/// always on the same side.
inline bool looks_like_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  const std::size_t pairs = std::min<std::size_t>(text.size() / 2, 128);
  std::size_t first = 0, second = 0;
  for (std::size_t i = 0; i < pairs; ++i) {
    first += text[2 * i] == '\0';
    second += text[2 * i + 1] == '\0';
  }
  return pairs > 1 && std::min(first, second) == 0 && 2 * std::max(first, second) > pairs;
}

/// The text without a UTF-8 byte order mark. Throws Error, starting with `name`, for UTF-16.
inline std::string_view without_byte_order_mark(std::string_view text, std::string_view name) {
  require(!looks_like_utf16(text), name, ": found UTF-16 text, expected UTF-8; save it as UTF-8");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

/// Removes the first line from `text` and returns it. Lines end with LF, CR LF or CR.
inline std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  const std::string_view end = text.substr(line.size());
  text.remove_prefix(line.size() + (end.starts_with("\r\n") ? 2 : end.empty() ? 0 : 1));
  return line;
}

/// Bytes of a line or of a caption: a longer one is no text that a person wrote.
inline constexpr std::size_t longest_line = 65536;

/// One line of a text file.
struct TextLine {
  std::size_t number = 0;  ///< from 1
  std::string_view text;   ///< trimmed
  std::string_view raw;    ///< the whole line
};

/// Calls read(TextLine) for each line of `text`, skipping blank lines, lines that start with #, and a byte
/// order mark. Throws Error, starting with `name`, for UTF-16 and for a line of more than longest_line.
template <class Read>
void for_each_line(std::string_view text, std::string_view name, Read&& read) {
  text = without_byte_order_mark(text, name);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view raw = take_line(text), line = trimmed(raw);
    require(raw.size() <= longest_line, name, ":", number, ": found a line of ", raw.size(),
            " bytes, expected at most ", longest_line, "; is it the right file?");
    if (!line.empty() && line.front() != '#') read(TextLine{number, line, raw});
  }
}

/// One line of a list.
struct TabLine {
  std::size_t number = 0;          ///< line number, from 1
  std::string_view before, after;  ///< text before and after the first tab, trimmed
  std::string_view raw;            ///< the whole line
};

/// As for_each_line, with read(TabLine). Throws Error as `name:line: ...` for a line without a tab;
/// `expected` describes the line in the message.
template <class Read>
void for_each_tab_line(std::string_view text, std::string_view name, std::string_view expected, Read&& read) {
  for_each_line(text, name, [&](const TextLine& line) {
    const std::size_t tab = line.raw.find('\t');
    require(tab != line.raw.npos, name, ":", line.number, ": found no tab in '", line.text.substr(0, 60),
            "', expected ", expected);
    read(TabLine{line.number, trimmed(line.raw.substr(0, tab)), trimmed(line.raw.substr(tab)), line.raw});
  });
}

}  // namespace motiongan::motion
