#include "shared/numbers.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <type_traits>

#include "motiongan/io/read_number.hpp"

namespace motiongan::command {
namespace {

/// Reads all of the text, after an optional plus sign.
template <class T>
std::errc read(std::string_view text, T& value) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const char *first = text.data(), *last = first + text.size();
  std::from_chars_result result{};
  if constexpr (std::is_same_v<T, double>)
    result = io::read_number(first, last, value);
  else
    result = std::from_chars(first, last, value);
  const auto [end, problem] = result;
  return end == text.data() + text.size() ? problem : std::errc::invalid_argument;
}

/// Converts a number for CLI11, or records why it cannot.
template <class T, class Read>
bool convert(const std::string& text, T& value, std::optional<Read> number) {
  if (number && *number <= static_cast<Read>(std::numeric_limits<T>::max())) {
    value = static_cast<T>(*number);
    return true;
  }
  refused_number() =
      "expected " + expected_number(text, std::numeric_limits<T>::is_integer) + ", not " + text;
  return false;
}

}  // namespace

std::optional<unsigned long long> whole_number(std::string_view text) {
  unsigned long long value = 0;
  return read(text, value) == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0;
  return read(text, value) == std::errc() && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string expected_number(std::string_view text, bool whole) {
  if (!whole) return "a finite number";
  unsigned long long value = 0;
  if (read(text, value) != std::errc::result_out_of_range) return "a whole number";
  return "a whole number of at most " + std::to_string(std::numeric_limits<unsigned long long>::max());
}

std::string& refused_number() {
  static std::string why;
  return why;
}

}  // namespace motiongan::command

namespace CLI::detail {

using motiongan::command::convert;

bool lexical_cast(const std::string& text, unsigned& value) {
  return convert(text, value, motiongan::command::whole_number(text));
}
bool lexical_cast(const std::string& text, unsigned long& value) {
  return convert(text, value, motiongan::command::whole_number(text));
}
bool lexical_cast(const std::string& text, unsigned long long& value) {
  return convert(text, value, motiongan::command::whole_number(text));
}
bool lexical_cast(const std::string& text, int& value) {
  return convert(text, value, motiongan::command::whole_number(text));
}
bool lexical_cast(const std::string& text, double& value) {
  return convert(text, value, motiongan::command::finite_number(text));
}

}  // namespace CLI::detail
