// Frame rates meant by the frame times of files, which are rounded to a few decimals.
#pragma once
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

#include "motiongan/core/error.hpp"

namespace motiongan::motion {

namespace rate_detail {

/// Rates of cameras and capture systems, integers first; the last four are in units of 1/1001 (NTSC).
inline constexpr std::array<double, 16> standard_rates{24,  25,  30,  48,  50,    60,    72,    90,
                                                       100, 120, 144, 240, 24000, 30000, 60000, 120000};

/// A number in its shortest decimal form: digits / 10^decimals.
struct ShortDecimal {
  double digits = 0;
  int count = 0;  ///< significant digits
  int decimals = 0;
};

inline ShortDecimal short_decimal(double value) {
  std::array<char, 32> text{};
  const char* const end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  ShortDecimal out;
  const char* at = text.data();
  for (; at != end && *at != 'e'; ++at) {
    if (*at == '.') continue;
    out.digits = 10 * out.digits + (*at - '0');
    ++out.count;
  }
  int exponent = 0;
  if (at != end) ++at;
  if (at != end && *at == '+') ++at;
  std::from_chars(at, end, exponent);
  out.decimals = out.count - 1 - exponent;
  return out;
}

/// The standard rate whose frame time, rounded or cut to the decimals of `frame_time`, is `frame_time`; 0 if
/// there is none. It needs at least 2 significant digits and a difference of at most 1%.
inline double standard_rate(double frame_time) {
  const ShortDecimal printed = short_decimal(frame_time);
  // More decimals than files print mean a computed time, which is not rounded.
  if (printed.count < 2 || printed.decimals < 1 || printed.decimals > 9) return 0;
  const double unit = std::pow(10.0, printed.decimals);
  for (const bool cut : {false, true})
    for (const double number : standard_rates) {
      const double rate = number > 1000 ? number / 1001 : number;
      const double exact = unit / rate;
      const bool printed_so = (cut ? std::floor(exact) : std::round(exact)) == printed.digits;
      if (printed_so && std::abs(frame_time * rate - 1) <= 0.01 + 1e-12) return rate;
    }
  return 0;
}

/// The integer within 0.05% of 1 / frame_time, or 0.
inline double whole_rate(double frame_time) {
  const double rate = 1.0 / frame_time, whole = std::round(rate);
  return std::abs(rate - whole) <= 5e-4 * rate ? whole : 0;
}

}  // namespace rate_detail

/// Frames per second for a frame time (seconds) as printed in files: 0.0083333 gives 120. A rate within 0.05%
/// of an integer becomes that integer. Otherwise a frame time of at least 2 significant digits and at most 9
/// decimals that is the rounded or cut frame time of a standard rate gives that rate: 0.0333 gives 30, 0.0334
/// gives 30000/1001 (29.97). Any other gives 1 / frame_time. Throws Error unless the frame time is positive
/// and finite.
inline double rate_from_frame_time(double frame_time) {
  require(std::isfinite(frame_time) && frame_time > 0, "frame time ", frame_time,
          " seconds, expected a positive number");
  if (const double whole = rate_detail::whole_rate(frame_time); whole > 0) return whole;
  const double standard = rate_detail::standard_rate(frame_time);
  return standard > 0 ? standard : 1.0 / frame_time;
}

/// What rate_from_frame_time made of a rounded frame time, as a sentence: "frame time 0.0333 s is read as 30
/// frames per second (1/30 s to 4 decimals)". Empty if the rate is the frame time's own or the integer within
/// 0.05% of it.
inline std::string rate_note(double frame_time) {
  if (!std::isfinite(frame_time) || frame_time <= 0 || rate_detail::whole_rate(frame_time) > 0) return {};
  const double rate = rate_detail::standard_rate(frame_time);
  if (rate == 0) return {};
  const std::string fraction =
      rate == std::round(rate) ? concat("1/", rate) : concat("1001/", std::round(1001 * rate));
  std::array<char, 32> text{};  // the shortest form, which shows all decimals
  const char* const end = std::to_chars(text.data(), text.data() + text.size(), frame_time).ptr;
  return concat("frame time ", std::string_view(text.data(), static_cast<std::size_t>(end - text.data())),
                " s is read as ", rate, " frames per second (", fraction, " s to ",
                rate_detail::short_decimal(frame_time).decimals, " decimals)");
}

}  // namespace motiongan::motion
