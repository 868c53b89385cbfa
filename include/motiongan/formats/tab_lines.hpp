// Hand-written lists: two tab-separated texts per line, with comments and blank lines.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string_view>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

/// One line of the list.
struct TabLine {
  std::size_t number = 0;          ///< line number, from 1
  std::string_view before, after;  ///< text before and after the first tab, trimmed
  std::string_view raw;            ///< the whole line
};

/// Calls read(TabLine) for each line of `text`, skipping blank lines, lines that start with #, and a byte
/// order mark. Throws Error as `name:line: ...` for a line without a tab; `expected` describes the line in
/// the message.
template <class Read>
void for_each_tab_line(std::string_view text, std::string_view name, std::string_view expected, Read&& read) {
  constexpr std::string_view blanks = " \t\r\v\f";
  const auto trim = [&](std::string_view s) {
    const std::size_t first = s.find_first_not_of(blanks);
    return first == s.npos ? std::string_view() : s.substr(first, s.find_last_not_of(blanks) - first + 1);
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view raw = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), raw.size() + 1));
    if (trim(raw).empty() || trim(raw).front() == '#') continue;
    const std::size_t tab = raw.find('\t');
    require(tab != raw.npos, name, ":", number, ": found no tab in '", trim(raw).substr(0, 60),
            "', expected ", expected);
    read(TabLine{number, trim(raw.substr(0, tab)), trim(raw.substr(tab)), raw});
  }
}

}  // namespace motiongan::motion
