// Line plots, such as training curves.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/view/canvas.hpp"

namespace motiongan::view {

/// A curve and its name in the legend.
struct Series {
  std::string name;          ///< in the legend
  std::vector<double> x, y;  ///< [points] each; a point that is not finite leaves a gap
};

/// Options of a plot.
struct PlotOptions {
  std::string title = {};
  std::string x_label = {};               ///< below the axis
  std::size_t width = 960, height = 480;  ///< pixels
};

namespace detail {

struct Axis {
  double low = 0, high = 1, step = 0.2;

  double part(double value) const { return (value - low) / (high - low); }
};

/// Axis limits that include both values, and a step of 1, 2 or 5 times a power of ten that divides them into
/// about `pieces`.
inline Axis nice_axis(double low, double high, double pieces) {
  // A constant curve still needs an axis of non-zero length.
  if (high - low <= 1e-9 * std::max(std::abs(low), std::abs(high))) {
    const double room = std::max(std::abs(low) * 0.1, 1e-6);
    low -= room;
    high += room;
  }
  const double raw = (high - low) / pieces;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  Axis out;
  out.step = power * (raw / power <= 1 ? 1 : raw / power <= 2 ? 2 : raw / power <= 5 ? 5 : 10);
  out.low = std::floor(low / out.step) * out.step;
  out.high = std::ceil(high / out.step) * out.step;
  return out;
}

inline std::string axis_number(double value, double step) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::abs(value) < 1e-6 * step ? 0.0 : value);
  return text;
}

}  // namespace detail

/// Plots `series` over common axes, with axis labels and a legend. Throws Error if x and y of a series differ
/// in length, no point is finite, or the size is below 240 x 160 pixels.
inline Image line_plot(std::span<const Series> series, const PlotOptions& options = {}) {
  require(options.width >= 240 && options.height >= 160, "the plot size is ", options.width, " x ",
          options.height, " pixels, expected at least 240 x 160");
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double low_x = infinity, high_x = -infinity, low_y = infinity, high_y = -infinity;
  for (const Series& s : series) {
    require(s.x.size() == s.y.size(), "the series '", s.name, "' has ", s.x.size(), " x values and ",
            s.y.size(), " y values, expected the same number");
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
      low_x = std::min(low_x, s.x[i]);
      high_x = std::max(high_x, s.x[i]);
      low_y = std::min(low_y, s.y[i]);
      high_y = std::max(high_y, s.y[i]);
    }
  }
  require(low_x <= high_x, "none of the ", series.size(), " series has a finite point to plot");

  const double width = static_cast<double>(options.width), height = static_cast<double>(options.height);
  const detail::Axis y_axis = detail::nice_axis(low_y, high_y, std::max(2.0, height / 80));
  detail::Axis x_axis = detail::nice_axis(low_x, high_x, std::max(2.0, width / 130));
  if (high_x > low_x) {  // let the curves use the full width
    x_axis.low = low_x;
    x_axis.high = high_x;
  }
  double numbers = 0;
  for (double v = y_axis.low; v <= y_axis.high + y_axis.step / 2; v += y_axis.step)
    numbers = std::max(numbers, text_width(detail::axis_number(v, y_axis.step)));

  const double left = numbers + 22, right = width - 30;
  // The legend, in as many lines as it needs.
  constexpr double legend_line = 20;
  std::vector<std::pair<double, double>> legend;  // x, and how far below the first line
  double next = left, below = 0;
  for (const Series& s : series) {
    const double length = 30 + text_width(s.name);
    if (next > left && next + length > width - 8) next = left, below += legend_line;
    legend.emplace_back(next, below);
    next += length + 26;
  }
  const double legend_top = options.title.empty() ? 24 : 52;
  const double top = legend_top + 20 + below, bottom = height - (options.x_label.empty() ? 36 : 58);
  const Color ink{0x1b, 0x1f, 0x24}, soft{0x5b, 0x65, 0x70}, grid{0xe2, 0xe6, 0xea};
  Image image(options.width, options.height);
  Canvas canvas(image);
  const auto place_x = [&](double v) { return left + x_axis.part(v) * (right - left); };
  const auto place_y = [&](double v) { return bottom - y_axis.part(v) * (bottom - top); };

  for (double v = y_axis.low; v <= y_axis.high + y_axis.step / 2; v += y_axis.step) {
    const std::string label = detail::axis_number(v, y_axis.step);
    const bool zero = std::abs(v) < 1e-6 * y_axis.step;
    canvas.box(left, place_y(v), right - left, 1, zero ? soft : grid);
    canvas.text(left - 8 - text_width(label), place_y(v) - 7, label, soft);
  }
  for (double v = std::ceil(x_axis.low / x_axis.step - 1e-9) * x_axis.step;
       v <= x_axis.high + 1e-9 * x_axis.step; v += x_axis.step) {
    const std::string label = detail::axis_number(v, x_axis.step);
    canvas.box(place_x(v), top, 1, bottom - top, grid);
    const double at = place_x(v) - text_width(label) / 2;
    canvas.text(std::min(at, width - 4 - text_width(label)), bottom + 10, label, soft);
  }
  canvas.box(left, top, 1, bottom - top, soft);
  canvas.box(left, bottom, right - left, 1, soft);
  canvas.text(left, 14, fitted(options.title, width - left - 8), ink);
  canvas.text((left + right - text_width(options.x_label)) / 2, height - 24, options.x_label, soft);

  for (std::size_t k = 0; k < series.size(); ++k) {
    const Series& s = series[k];
    const Color color = palette(k);
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
      const double x = place_x(s.x[i]), y = place_y(s.y[i]);
      const bool joined = i > 0 && std::isfinite(s.x[i - 1]) && std::isfinite(s.y[i - 1]);
      if (joined)
        canvas.line(place_x(s.x[i - 1]), place_y(s.y[i - 1]), x, y, 2, color);
      else
        canvas.disc(x, y, 1.5, color);
    }
    const auto [x, down] = legend[k];
    canvas.line(x, legend_top + down, x + 22, legend_top + down, 4, color);
    canvas.text(x + 30, legend_top + down - 7, s.name, ink);
  }
  return image;
}

}  // namespace motiongan::view
