// Pose strips: an image with one row of poses per motion, equally spaced in time.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/view/canvas.hpp"
#include "motiongan/view/figure.hpp"

namespace motiongan::view {

/// Options of a picture of poses in a row.
struct StripOptions {
  std::size_t poses = 10;           ///< per row, including the first and the last frame
  std::size_t figure_height = 130;  ///< height of a standing figure in pixels
  double azimuth = 50;              ///< degrees; 0: facing the viewer, 90: facing right
  double elevation = 8;             ///< degrees by which the viewer looks down
};

namespace detail {

/// A figure in view space.
struct SeenFigure {
  /// [poses, nodes] of (right, up, towards the viewer), relative to the floor below the root, in standing
  /// heights.
  std::vector<motion::Vec3> points;
  std::vector<std::size_t> frames;                  ///< [poses], frame of each pose
  double left = 0, right = 0, top = 0, bottom = 0;  ///< extent over all poses
};

inline SeenFigure see(const Figure& figure, const StripOptions& options) {
  constexpr double degree = 3.14159265358979323846 / 180;
  const double turn = options.azimuth * degree - figure.heading, tilt = options.elevation * degree;
  SeenFigure out;
  const std::size_t poses = std::min(options.poses, figure.frames);
  for (std::size_t i = 0; i < poses; ++i) {
    // Rounded to the nearest frame; the first and the last frame are included exactly.
    const std::size_t f = poses == 1 ? 0 : (i * (figure.frames - 1) + (poses - 1) / 2) / (poses - 1);
    out.frames.push_back(f);
    const motion::Vec3 root = figure.point(f, 0);
    for (std::size_t n = 0; n < figure.nodes(); ++n) {
      const motion::Vec3& p = figure.point(f, n);
      const double x = (p[0] - root[0]) / figure.height, y = (p[1] - figure.floor) / figure.height;
      const double z = (p[2] - root[2]) / figure.height;
      const double side = x * std::cos(turn) + z * std::sin(turn);
      const double front = z * std::cos(turn) - x * std::sin(turn);
      out.points.push_back(
          {side, y * std::cos(tilt) - front * std::sin(tilt), y * std::sin(tilt) + front * std::cos(tilt)});
      out.left = std::min(out.left, side);
      out.right = std::max(out.right, side);
      out.top = std::max(out.top, out.points.back()[1]);
      out.bottom = std::min(out.bottom, out.points.back()[1]);
    }
  }
  return out;
}

/// Draws pose number `pose` with the floor below its root at (x, y); `size` is the standing height in pixels.
inline void draw_pose(Canvas& canvas, const Figure& figure, const SeenFigure& seen, std::size_t pose,
                      double x, double y, double size, bool given) {
  static constexpr std::array<Color, 3> lively = {
      {{0x3c, 0x42, 0x4a}, {0xd5, 0x5e, 0x00}, {0x1f, 0x6f, 0xb4}}};
  static constexpr std::array<Color, 3> grey = {{{0x8a, 0x8f, 0x95}, {0xb4, 0xb8, 0xbc}, {0x70, 0x76, 0x7d}}};
  const motion::Vec3* points = &seen.points[pose * figure.nodes()];
  std::vector<std::size_t> order(figure.nodes() - 1);
  std::iota(order.begin(), order.end(), std::size_t{1});
  const auto depth = [&](std::size_t n) {
    return points[n][2] + points[static_cast<std::size_t>(figure.parents[n])][2];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return depth(a) < depth(b); });

  for (const std::size_t n : order) {
    const motion::Vec3 &a = points[figure.parents[n]], &b = points[n];
    const Color color = (given ? grey : lively)[static_cast<std::size_t>(figure.sides[n])];
    const double length = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    const double thick = std::max(1.3, size * std::clamp(0.25 * length, 0.012, 0.03));
    const double ax = x + size * a[0], ay = y - size * a[1], bx = x + size * b[0], by = y - size * b[1];
    if (figure.heads[n] != 1) canvas.line(ax, ay, bx, by, thick, color);
    if (figure.heads[n] == 1)
      canvas.disc((ax + bx) / 2, (ay + by) / 2, size * std::max(0.6 * length, 0.045), color);
    else if (figure.heads[n] == 2)
      canvas.disc(bx, by, size * 0.06, color);
  }
}

}  // namespace detail

/// Draws one row per motion: its title, poses at equal time steps standing on a line, and their times in
/// seconds. Left limbs are orange, right limbs blue, seed frames grey. Figures are shown in three-quarter
/// view whatever their heading, and all rows have the same scale. Throws Error if there are no motions, an
/// option is out of range, or a motion cannot be drawn (see make_figure).
inline Image pose_strip(std::span<const ViewedMotion> motions, const StripOptions& options = {}) {
  require(!motions.empty(), "there is no motion to draw, expected at least one");
  require(options.poses > 0 && options.poses <= 200, "poses is ", options.poses, ", expected 1 to 200");
  require(options.figure_height >= 20 && options.figure_height <= 2000, "figure_height is ",
          options.figure_height, " pixels, expected 20 to 2000");
  std::vector<Figure> figures;
  std::vector<detail::SeenFigure> seen;
  double left = -0.3, right = 0.3;  // extent of a pose, the same for all rows so that they line up
  for (const ViewedMotion& viewed : motions) {
    figures.push_back(make_figure(viewed));
    seen.push_back(detail::see(figures.back(), options));
    // Stretched limbs may overlap the neighbouring pose, but by less than half of its width.
    left = std::min(left, std::max(seen.back().left, -0.55));
    right = std::max(right, std::min(seen.back().right, 0.55));
  }
  const double size = static_cast<double>(options.figure_height);
  const double step = std::ceil((right - left) * size + 6), margin = 16;
  constexpr double caption = 26, times = 32;
  const double width = 2 * margin + step * static_cast<double>(options.poses);
  std::vector<double> tops, bottoms;  // [rows], pixels above and below the ground line
  double height = margin / 2;
  for (const detail::SeenFigure& row : seen) {
    tops.push_back(std::ceil(size * std::max(1.0, row.top) + 0.1 * size));
    bottoms.push_back(std::ceil(size * std::max(0.05, -row.bottom) + 3));
    height += caption + tops.back() + bottoms.back() + times;
  }

  Image image(static_cast<std::size_t>(width), static_cast<std::size_t>(height));
  Canvas canvas(image);
  const Color ink{0x1b, 0x1f, 0x24}, soft{0x6a, 0x73, 0x7d}, line{0xb9, 0xc0, 0xc8};
  double y = margin / 2;
  for (std::size_t r = 0; r < figures.size(); ++r) {
    canvas.text(margin, y + 4, fitted(motions[r].title, width - 2 * margin), ink);
    const double ground = y + caption + tops[r];
    canvas.line(margin, ground, width - margin, ground, 1.5, line);
    for (std::size_t i = 0; i < seen[r].frames.size(); ++i) {
      const double x = margin + step * static_cast<double>(i) - left * size + 3;
      const std::size_t f = seen[r].frames[i];
      detail::draw_pose(canvas, figures[r], seen[r], i, x, ground, size, f < motions[r].seed_frames);
      char label[32];
      std::snprintf(label, sizeof label, "%.2f s", static_cast<double>(f) / figures[r].rate);
      const std::size_t scale = text_width(label) < step - 4 ? 2 : 1;
      canvas.text(x - text_width(label, scale) / 2, ground + bottoms[r] + 2, label, soft, scale);
    }
    y = ground + bottoms[r] + times;
  }
  return image;
}

}  // namespace motiongan::view
