// Schedules: the classes a character goes through, and for how long, such as "walk:3s,run:5s".
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/position_format.hpp"
#include "motiongan/io/read_number.hpp"

namespace motiongan {

/// A number of frames of one class.
struct ActionPiece {
  std::size_t label = 0;   ///< index of the class
  std::size_t frames = 0;  ///< how long it lasts
  friend bool operator==(const ActionPiece&, const ActionPiece&) = default;
};

/// Classes one after another, each for a number of frames.
using ActionSchedule = std::vector<ActionPiece>;

/// Total number of frames.
inline std::size_t frames_of(const ActionSchedule& schedule) {
  std::size_t n = 0;
  for (const ActionPiece& piece : schedule) n += piece.frames;
  return n;
}

namespace detail {

/// Seconds as frames, rounded to the nearest. Throws Error if the result is below 1 or not below 2^31.
inline std::size_t frames_in(double seconds, double rate, std::string_view what) {
  const double frames = std::round(seconds * rate);
  require(std::isfinite(frames) && frames >= 1 && frames < 2147483648.0, what, ": ", seconds, " seconds are ",
          frames, " frames at ", rate, " per second, expected at least 1 and less than 2^31");
  return static_cast<std::size_t>(frames);
}

/// "3s", "0.5s" or "90" (frames).
inline std::size_t piece_frames(std::string_view text, double rate, const std::string& what) {
  const bool seconds = text.ends_with('s');
  const std::string_view digits = text.substr(0, text.size() - (seconds ? 1 : 0));
  double value = -1;
  const auto [end, problem] = io::read_number(digits.data(), digits.data() + digits.size(), value);
  require(problem == std::errc() && end == digits.data() + digits.size() && value > 0 &&
              (seconds || value == std::floor(value)),
          what, ": found the length '", text,
          "', expected seconds such as 3s, or a number of frames such as 90");
  return frames_in(seconds ? value : value / rate, rate, what);
}

}  // namespace detail

/// Parses comma-separated pieces, each a class and its length in seconds or frames: "walk:3s,run:90". The
/// last piece may omit its length; it then takes what is left of `seconds`, the total length (0: not given),
/// so that "walk" alone takes all of it. Lengths are rounded to frames at the format's rate. Throws Error,
/// naming the piece, for a bad piece, for an unknown class (as PositionFormat::class_index()), and if the
/// pieces do not add up to `seconds`.
inline ActionSchedule parse_action_schedule(std::string_view text, const motion::PositionFormat& format,
                                            double seconds = 0) {
  ActionSchedule out;
  require(!text.empty(), "the schedule is empty, expected for example walk:3s,run:5s");
  const std::string_view whole = text;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    std::string_view piece = text.substr(0, comma);
    more = comma != text.npos;
    text.remove_prefix(more ? comma + 1 : text.size());
    while (piece.starts_with(' ')) piece.remove_prefix(1);
    while (piece.ends_with(' ')) piece.remove_suffix(1);
    const std::string what =
        concat("piece ", out.size() + 1, " of the schedule '", whole, "' ('", piece, "')");
    require(!piece.empty(), what, " is empty, expected a class and its length, such as walk:3s");
    const std::size_t colon = piece.rfind(':');
    const std::size_t label = format.class_index(piece.substr(0, colon));
    if (colon != piece.npos) {
      out.push_back({label, detail::piece_frames(piece.substr(colon + 1), format.rate, what)});
      continue;
    }
    require(!more, what, " has no length, expected one such as ", piece,
            ":3s; only the last piece may omit it");
    require(seconds > 0, what, " has no length, expected one such as ", piece,
            ":3s, or a total number of seconds");
    const std::size_t total = detail::frames_in(seconds, format.rate, what), used = frames_of(out);
    require(used < total, what, ": nothing of the ", seconds, " seconds (", total,
            " frames) is left for it; the pieces ", "before it take ", used, " frames");
    out.push_back({label, total - used});
    return out;
  }
  require(seconds <= 0 || frames_of(out) == detail::frames_in(seconds, format.rate, "the schedule"),
          "the schedule '", whole, "' lasts ", static_cast<double>(frames_of(out)) / format.rate,
          " seconds, but ", seconds, " were requested: omit the total, or the length of the last piece");
  return out;
}

}  // namespace motiongan
