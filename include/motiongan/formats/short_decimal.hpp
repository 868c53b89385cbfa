// A fast way to read the numbers that motion files are full of: short decimals such as -12.345678.
#pragma once
#include <cstdint>

namespace motiongan::motion {

/// Reads `-?digits[.digits]` of at most 15 digits at `first` into `value` and returns the end of what was
/// read; nullptr, with `value` unchanged, for any other number, which std::from_chars is for. The value has
/// the bits that std::from_chars gives: digits and power of ten are exact in double, so their quotient is
/// rounded once.
inline const char* read_short_decimal(const char* first, const char* last, double& value) {
  constexpr double powers[]{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                            1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  constexpr int most_digits = 15;  // below 2^53
  const char* at = first;
  const bool negative = at != last && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;
  const auto read_digits = [&] {
    const char* const start = at;
    for (; at != last && *at >= '0' && *at <= '9'; ++at) {
      if (at - start > most_digits) break;
      digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
    }
    return static_cast<int>(at - start);
  };
  const int before = read_digits();
  int after = 0;
  if (at != last && *at == '.') {
    ++at;
    after = read_digits();
  }
  if (before == 0 || before + after > most_digits) return nullptr;
  if (at != last && (*at == 'e' || *at == 'E')) return nullptr;
  const double size = static_cast<double>(digits) / powers[after];
  value = negative ? -size : size;
  return at;
}

}  // namespace motiongan::motion
