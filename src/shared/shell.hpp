// Texts and file names as words of a command line that is printed to be pasted into a shell.
#pragma once
#include <algorithm>
#include <string>
#include <string_view>

namespace motiongan::command {

/// The text as one word for a POSIX shell: in double quotes where nothing in it is special there, else in
/// single quotes, as 'it'\''s'.
inline std::string shell_quoted(std::string_view text) {
  const bool harmless = std::none_of(text.begin(), text.end(), [](char c) {
    return std::string_view("\"$`\\!").find(c) != std::string_view::npos || (c >= 0 && c < ' ') || c == 127;
  });
  if (harmless) return '"' + std::string(text) + '"';
  std::string out = "'";
  for (const char c : text) c == '\'' ? out += "'\\''" : out += c;
  return out + "'";
}

/// The same for a file name, which needs no quotes unless a character of it is special: save/my-run.
inline std::string shell_word(std::string_view text) {
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (c & 0x80) != 0 ||
           std::string_view("_-+=:,./@%").find(c) != std::string_view::npos;
  });
  return plain && !text.empty() ? std::string(text) : shell_quoted(text);
}

}  // namespace motiongan::command
