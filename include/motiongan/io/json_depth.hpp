// How deeply JSON texts may nest.
#pragma once
#include <cstddef>
#include <string_view>

namespace motiongan::io {

/// The most lists and objects within each other that are read. The JSON library copies, compares and prints
/// values by recursion, so that a file of a hundred thousand brackets would overflow the stack.
inline constexpr std::size_t most_nested_json = 100;

/// Whether the text, which need not be JSON, nests more deeply.
inline bool nests_too_deeply(std::string_view text) {
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (quoted) {
      i += c == '\\';  // the character after it does not end the string
    } else if (c == '[' || c == '{') {
      if (++depth > most_nested_json) return true;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

}  // namespace motiongan::io
