// One self-contained HTML page that plays motions side by side as stick figures.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/generated/view.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/view/figure.hpp"

namespace motiongan::view {

/// Options of an HTML page that plays motions.
struct PlayerOptions {
  std::string title = "motion";  ///< page title, UTF-8
  double max_rate = 60;          ///< frames per second; faster motions are subsampled to keep the page small
  std::size_t group = 1;         ///< number of consecutive motions that form a group, shown in one row
};

namespace detail {

/// `bytes` in base64, padded.
inline std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

/// A JSON string that is safe inside an HTML script element: it cannot close the element.
inline std::string json_string(std::string_view utf8) {
  std::string out = "\"";
  for (const char c : utf8) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 32 || code == 127 || c == '"' || c == '\\' || c == '<' || c == '>' || c == '&' || c == '\'') {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(code));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// A JSON number with enough digits for a float.
inline std::string json_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  std::replace(text, text + sizeof text, ',', '.');  // some locales print a decimal comma
  return text;
}

template <class Range>
std::string json_integers(const Range& values) {
  std::string out = "[";
  for (const auto value : values)
    out += (out.size() > 1 ? "," : "") + std::to_string(static_cast<int>(value));
  return out + "]";
}

/// Numbers as a JSON list.
inline std::string json_numbers(std::span<const double> values) {
  std::string out = "[";
  for (const double value : values) out += (out.size() > 1 ? "," : "") + json_number(value);
  return out + "]";
}

/// What was asked for, as JSON: the path's x and z, targets as x, y, z and their times, and the points of
/// each ghost, which has the nodes of `figure`. Empty if there is nothing.
inline std::string json_marks(const ViewedMotion& viewed, const Figure& figure) {
  const Marks& marks = viewed.marks;
  std::vector<double> path, targets;
  for (const motion::Vec3& p : marks.path) path.insert(path.end(), {p[0], p[2]});
  for (const Marks::Target& t : marks.targets)
    targets.insert(targets.end(), {t.place[0], t.place[1], t.place[2], t.from, t.to});
  // Ghosts as further frames of the motion, so that they have its nodes.
  motion::Motion with_ghosts = marks.ghosts.empty() ? motion::Motion() : viewed.motion;
  for (motion::Motion ghost : marks.ghosts) {
    ghost.rate = with_ghosts.rate;
    with_ghosts = join(std::move(with_ghosts), ghost);
  }
  std::string ghosts;
  const Figure all = marks.ghosts.empty() ? Figure() : make_figure({viewed.title, with_ghosts, 0, {}});
  for (std::size_t g = 0; g < marks.ghosts.size(); ++g) {
    if (all.nodes() != figure.nodes()) break;  // bones of other lengths, where the motion has none
    std::vector<double> points;
    for (std::size_t n = 0; n < all.nodes(); ++n) {
      const motion::Vec3& p = all.point(figure.frames + g, n);
      points.insert(points.end(), p.begin(), p.end());
    }
    ghosts += (ghosts.empty() ? "" : ",") + json_numbers(points);
  }
  if (path.empty() && targets.empty() && ghosts.empty()) return {};
  return ",\"path\":" + json_numbers(path) + ",\"targets\":" + json_numbers(targets) + ",\"ghosts\":[" +
         ghosts + "]";
}

/// One clip of the page as JSON; positions are little-endian int16 [frames, nodes, 3] in base64.
inline std::string json_clip(const ViewedMotion& viewed, double max_rate) {
  const Figure figure = make_figure(viewed);
  // Whole strides, so that every frame shown is an original one.
  const double excess =
      std::min(std::ceil(figure.rate / max_rate - 1e-6), static_cast<double>(figure.frames));
  const std::size_t stride = excess > 1 ? static_cast<std::size_t>(excess) : 1;
  const std::size_t frames = (figure.frames - 1) / stride + 1;

  motion::Vec3 low = figure.points.front(), high = low;
  for (const motion::Vec3& p : figure.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  motion::Vec3 origin;
  double scale = 1e-9;
  for (std::size_t k = 0; k < 3; ++k) {
    origin[k] = low[k] + (high[k] - low[k]) / 2;
    scale = std::max(scale, (high[k] - low[k]) / 2 / 32767);
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(frames * figure.nodes() * 6);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t n = 0; n < figure.nodes(); ++n) {
      const motion::Vec3& p = figure.point(f * stride, n);
      for (std::size_t k = 0; k < 3; ++k) {
        const double steps = std::clamp((p[k] - origin[k]) / scale, -32767.0, 32767.0);
        const auto number = static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(steps)));
        bytes.push_back(static_cast<std::uint8_t>(number & 255u));
        bytes.push_back(static_cast<std::uint8_t>(number >> 8));
      }
    }
  }
  const std::size_t seed = std::min(viewed.seed_frames, figure.frames);
  return "{\"title\":" + json_string(viewed.title) +
         ",\"rate\":" + json_number(figure.rate / static_cast<double>(stride)) +
         ",\"frames\":" + std::to_string(frames) +
         ",\"seed\":" + std::to_string((seed + stride - 1) / stride) +
         ",\"parents\":" + json_integers(figure.parents) + ",\"sides\":" + json_integers(figure.sides) +
         ",\"heads\":" + json_integers(figure.heads) + ",\"height\":" + json_number(figure.height) +
         ",\"floor\":" + json_number(figure.floor) + ",\"heading\":" + json_number(figure.heading) +
         ",\"origin\":[" + json_number(origin[0]) + "," + json_number(origin[1]) + "," +
         json_number(origin[2]) + "],\"scale\":" + json_number(scale) + json_marks(viewed, figure) +
         ",\"data\":\"" + base64(bytes) + "\"}";
}

}  // namespace detail

/// A self-contained HTML page that plays `motions` side by side, with play, pause, scrub, orbit, zoom and
/// speed controls. It needs no network access. The URL may set the start: "page.html#t=1.5" opens paused at
/// 1.5 s. Throws Error if there are no motions, an option is out of range, or a motion cannot be drawn (see
/// make_figure).
inline std::string player_page(std::span<const ViewedMotion> motions, const PlayerOptions& options = {}) {
  require(!motions.empty(), "there is no motion to play, expected at least one");
  require(options.max_rate > 0, "max_rate is ", options.max_rate,
          "; expected a positive number of frames per second");
  require(options.group > 0, "group is 0, expected at least 1");
  std::string clips = "{\"title\":" + detail::json_string(options.title) +
                      (options.group > 1 ? ",\"group\":" + std::to_string(options.group) : "") +
                      ",\"clips\":[";
  for (std::size_t i = 0; i < motions.size(); ++i)
    clips += (i > 0 ? ",\n" : "\n") + detail::json_clip(motions[i], options.max_rate);
  clips += "]}";

  constexpr std::string_view page = view_files::player, marker = "/*CLIPS*/";
  const std::size_t at = page.find(marker);  // not constexpr: with -fsanitize=undefined GCC refuses
  require(at != std::string_view::npos && page.find(marker, at + 1) == std::string_view::npos,
          "view/player.html must contain ", marker, " exactly once");
  return std::string(page.substr(0, at)) + clips + std::string(page.substr(at + marker.size()));
}

/// Writes player_page() to `path`, atomically: an existing file is only replaced by a complete page. Throws
/// Error if the page cannot be made or written.
inline void write_player(const std::filesystem::path& path, std::span<const ViewedMotion> motions,
                         const PlayerOptions& options = {}) {
  motion::write_text_atomically(path, player_page(motions, options));
}

}  // namespace motiongan::view
