// Numbers in text, read the same everywhere.
#pragma once
#include <cerrno>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>

#include "motiongan/core/os.hpp"

namespace motiongan::io {

namespace detail {

/// std::from_chars() by strtod().
inline std::from_chars_result read_by_strtod(const char* first, const char* last, double& value) {
  const std::string text(first, last);
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  // What strtod() takes and from_chars() does not: space, a plus sign, a second sign, hexadecimal digits.
  if (text.size() == sign || std::string_view(" \t\n\v\f\r+-").find(text[sign]) != std::string_view::npos)
    return {first, std::errc::invalid_argument};
  if (text.size() > sign + 1 && text[sign] == '0' && (text[sign + 1] | 32) == 'x') {
    value = sign == 1 ? -0.0 : 0.0;
    return {first + sign + 1, std::errc()};
  }
  char* end = nullptr;
  errno = 0;
  const double read = os::text_to_double(text.c_str(), &end);
  const char* const stop = first + (end - text.c_str());
  if (stop == first) return {first, std::errc::invalid_argument};
  if (errno == ERANGE && (read == 0 || std::isinf(read))) return {stop, std::errc::result_out_of_range};
  value = read;
  return {stop, std::errc()};
}

}  // namespace detail

/// std::from_chars() of a double, which libc++ lacks before its version 20.
inline std::from_chars_result read_number(const char* first, const char* last, double& value) {
#ifdef __cpp_lib_to_chars
  return std::from_chars(first, last, value);
#else
  return detail::read_by_strtod(first, last, value);
#endif
}

}  // namespace motiongan::io
