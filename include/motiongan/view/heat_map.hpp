// Heat maps of matrices, such as attention weights.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/view/canvas.hpp"
#include "motiongan/view/line_plot.hpp"

namespace motiongan::view {

/// A matrix to draw; row 0 is at the top, column 0 at the left.
struct HeatMap {
  std::string title = {};  ///< above the map
  std::size_t rows = 0, columns = 0;
  std::vector<float> values;  ///< [rows, columns], non-negative, such as attention weights
};

/// Options of the pictures of heat maps.
struct HeatMapOptions {
  std::string title = {};         ///< above all maps
  std::string row_label = {};     ///< what rows are, such as "query frame"
  std::string column_label = {};  ///< what columns are
  std::size_t cell = 0;           ///< side of a cell in pixels; 0: about 360 pixels per map
  double row_scale = 1;           ///< axis units per row, such as 4 frames after pooling
  double column_scale = 1;        ///< axis units per column
  double high = 0;                ///< value of the darkest colour; 0: the largest value in the maps
};

/// Colour map from pale yellow (0) through red to nearly black (1). Its brightness decreases monotonically,
/// so it also reads in greyscale.
inline Color heat_color(double share) {
  static constexpr std::array<Color, 6> stops{{{0xfd, 0xf8, 0xe4},
                                               {0xfc, 0xd0, 0x7c},
                                               {0xf3, 0x8b, 0x4a},
                                               {0xc8, 0x3f, 0x5a},
                                               {0x6d, 0x1c, 0x6e},
                                               {0x1d, 0x0b, 0x3c}}};
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  return mix(stops[below], stops[below + 1], at - static_cast<double>(below));
}

namespace detail {

/// Step between axis labels of `count` cells, in cells: a round number of axis units (`scale` per cell), at
/// least `room` pixels apart.
inline double cell_step(double count, double scale, double cell, double room) {
  const double least = std::max(scale, room / cell * scale);
  const double power = std::pow(10.0, std::floor(std::log10(least) + 1e-9));
  const double share = least / power - 1e-9;
  const double step = power * (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10) / scale;
  return std::max(1.0, std::min(step, count));
}

}  // namespace detail

/// Draws the maps side by side, with axis labels, titles and a shared colour bar. Cells that are not finite
/// are grey. Throws Error if there is no map, a map has no cells or a wrong number of values, a value is
/// negative, an option is out of range, or the image would exceed the maximum size of an Image.
inline Image heat_map(std::span<const HeatMap> maps, const HeatMapOptions& options = {}) {
  require(!maps.empty(), "there is no heat map to draw, expected at least one");
  require(options.row_scale > 0 && options.column_scale > 0 && options.high >= 0,
          "the scales of a heat map are ", options.row_scale, " and ", options.column_scale,
          ", its highest value ", options.high, "; expected scales above 0 and a value of 0 or more");
  std::size_t rows = 0, columns = 0;
  double high = options.high;
  for (const HeatMap& map : maps) {
    require(map.rows > 0 && map.columns > 0 && map.values.size() == map.rows * map.columns, "the heat map '",
            map.title, "' has ", map.values.size(), " values, expected ", map.rows, " rows x ", map.columns,
            " columns, at least one");
    rows = std::max(rows, map.rows);
    columns = std::max(columns, map.columns);
    for (const float v : map.values) {
      require(!(v < 0), "the heat map '", map.title, "' holds ", v, ", expected 0 or more");
      if (options.high <= 0 && std::isfinite(v)) high = std::max(high, static_cast<double>(v));
    }
  }
  if (high <= 0) high = 1;  // all values are zero

  const std::size_t chosen = std::clamp<std::size_t>(360 / std::max(rows, columns), 2, 40);
  const double cell = static_cast<double>(options.cell > 0 ? options.cell : chosen);
  const bool named = std::any_of(maps.begin(), maps.end(), [](const HeatMap& m) { return !m.title.empty(); });
  const double numbers =
      text_width(detail::axis_number(static_cast<double>(rows) * options.row_scale, 1)) + 12;
  const double top =
      14 + (options.title.empty() ? 0 : 30) + (options.row_label.empty() ? 0 : 24) + (named ? 26 : 8);
  const double tallest = cell * static_cast<double>(rows);
  const double bottom = top + tallest + 34 + (options.column_label.empty() ? 0 : 26);
  const Color ink{0x1b, 0x1f, 0x24}, soft{0x5b, 0x65, 0x70}, nothing{0xb4, 0xb9, 0xbf};
  double width = 16;
  // A narrow map gets more room if its title needs it.
  const auto slot = [&](const HeatMap& map) {
    return std::max(cell * static_cast<double>(map.columns), std::min(text_width(map.title), 420.0));
  };
  for (const HeatMap& map : maps) width += numbers + slot(map) + 24;
  const detail::Axis bar = detail::nice_axis(0, high, std::max(2.0, tallest / 60));
  double bar_numbers = 0;
  for (double v = 0; v <= high * (1 + 1e-9); v += bar.step)
    bar_numbers = std::max(bar_numbers, text_width(detail::axis_number(v, bar.step)));
  const double bar_at = width + 4;
  width = std::max(bar_at + 16 + 8 + bar_numbers + 14, 32 + text_width(options.title));

  require(width <= 32768 && bottom <= 32768, "heat maps of ", maps.size(), " x ", rows, " x ", columns,
          " cells of ", cell, " pixels make an image of ", width, " x ", bottom,
          " pixels, expected at most 32768 per side; draw fewer or smaller cells");
  Image image(static_cast<std::size_t>(width), static_cast<std::size_t>(bottom));
  Canvas canvas(image);
  canvas.text(16, 14, options.title, ink);
  if (!options.row_label.empty()) canvas.text(16, options.title.empty() ? 14 : 44, options.row_label, soft);

  double left = 16;
  for (const HeatMap& map : maps) {
    left += numbers;
    const double across = cell * static_cast<double>(map.columns),
                 down = cell * static_cast<double>(map.rows);
    for (std::size_t r = 0; r < map.rows; ++r) {
      for (std::size_t c = 0; c < map.columns; ++c) {
        const double v = static_cast<double>(map.values[r * map.columns + c]);
        canvas.box(left + cell * static_cast<double>(c), top + cell * static_cast<double>(r), cell, cell,
                   std::isfinite(v) ? heat_color(v / high) : nothing);
      }
    }
    const double row_step = detail::cell_step(static_cast<double>(map.rows), options.row_scale, cell, 28);
    for (double r = 0; r < static_cast<double>(map.rows) - 0.01; r += row_step) {
      const std::string label = detail::axis_number(r * options.row_scale, 1);
      const double y = top + cell * (std::floor(r) + 0.5);
      canvas.box(left - 5, y, 5, 1, soft);
      canvas.text(left - 9 - text_width(label), y - 6, label, soft);
    }
    const double column_step =
        detail::cell_step(static_cast<double>(map.columns), options.column_scale, cell, 56);
    for (double c = 0; c < static_cast<double>(map.columns) - 0.01; c += column_step) {
      const std::string label = detail::axis_number(c * options.column_scale, 1);
      const double x = left + cell * (std::floor(c) + 0.5);
      canvas.box(x, top + down, 1, 5, soft);
      canvas.text(x - text_width(label) / 2, top + down + 10, label, soft);
    }
    canvas.text(left, top - 22, fitted(map.title, slot(map)), ink);
    const std::string below = fitted(options.column_label, slot(map));
    canvas.text(left + std::max(0.0, (across - text_width(below)) / 2), top + down + 36, below, soft);
    left += slot(map) + 24;
  }

  for (double y = 0; y < tallest; ++y)
    canvas.box(bar_at, top + y, 16, 1, heat_color(1 - (y + 0.5) / tallest));
  for (double v = 0; v <= high * (1 + 1e-9); v += bar.step) {
    const double y = top + tallest * (1 - v / high);
    canvas.box(bar_at + 16, std::min(y, top + tallest - 1), 4, 1, soft);
    canvas.text(bar_at + 24, y - 7, detail::axis_number(v, bar.step), soft);
  }
  return image;
}

}  // namespace motiongan::view
