// In-memory images and drawing primitives: antialiased lines, discs, boxes and text.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/view/font.hpp"

namespace motiongan::view {

/// Red, green and blue, 0 to 255.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Colours that are easy to tell apart, also with colour blindness; repeats after 8.
inline Color palette(std::size_t i) {
  static constexpr std::array<Color, 8> colors = {{{0x1f, 0x6f, 0xb4},
                                                   {0xd5, 0x5e, 0x00},
                                                   {0x00, 0x8f, 0x6b},
                                                   {0xb5, 0x4a, 0x93},
                                                   {0x8c, 0x6d, 0x00},
                                                   {0x45, 0x45, 0xb8},
                                                   {0xb0, 0x28, 0x28},
                                                   {0x3a, 0x85, 0x9e}}};
  return colors[i % colors.size()];
}

/// Linear mix of two colours: `share` 0 gives a, 1 gives b.
inline Color mix(Color a, Color b, double share) {
  const auto channel = [share](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>(std::lround(x + (y - x) * std::clamp(share, 0.0, 1.0)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

/// An RGB image, 8 bits per channel, top row first.
struct Image {
  std::size_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< [height, width, 3]

  Image() = default;
  /// A filled image. Throws Error unless both sides are 1 to 32768 pixels.
  Image(std::size_t w, std::size_t h, Color fill = {255, 255, 255}) : width(w), height(h) {
    require(w > 0 && h > 0 && w <= 32768 && h <= 32768, "the image size is ", w, " x ", h,
            " pixels; both sides must be between 1 and 32768");
    rgb.resize(w * h * 3);
    for (std::size_t i = 0; i < w * h; ++i) {
      rgb[3 * i] = fill.r;
      rgb[3 * i + 1] = fill.g;
      rgb[3 * i + 2] = fill.b;
    }
  }

  /// The pixel in column x and row y, which must be inside the image.
  Color at(std::size_t x, std::size_t y) const {
    const std::size_t i = 3 * (y * width + x);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

/// Draws on an image, which must outlive it. Coordinates are pixels, x to the right and y down from the top
/// left corner; drawing is clipped to the image.
class Canvas {
 public:
  explicit Canvas(Image& image) : image_(image) {}

  /// Blends `color` over one pixel with opacity `alpha`, 0 .. 1.
  void blend(std::ptrdiff_t x, std::ptrdiff_t y, Color color, double alpha) {
    if (x < 0 || y < 0 || x >= static_cast<std::ptrdiff_t>(image_.width) ||
        y >= static_cast<std::ptrdiff_t>(image_.height) || alpha <= 0)
      return;
    const std::size_t i = 3 * (static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x));
    const Color now = mix({image_.rgb[i], image_.rgb[i + 1], image_.rgb[i + 2]}, color, alpha);
    image_.rgb[i] = now.r;
    image_.rgb[i + 1] = now.g;
    image_.rgb[i + 2] = now.b;
  }

  /// An antialiased line with round ends.
  void line(double x0, double y0, double x1, double y1, double thickness, Color color, double alpha = 1) {
    if (!(std::isfinite(x0) && std::isfinite(y0) && std::isfinite(x1) && std::isfinite(y1))) return;
    const double radius = thickness / 2, margin = radius + 1;
    const double dx = x1 - x0, dy = y1 - y0, squared = dx * dx + dy * dy;
    const auto [left, right] = range(std::min(x0, x1) - margin, std::max(x0, x1) + margin, image_.width);
    const auto [top, bottom] = range(std::min(y0, y1) - margin, std::max(y0, y1) + margin, image_.height);
    for (std::ptrdiff_t y = top; y < bottom; ++y) {
      for (std::ptrdiff_t x = left; x < right; ++x) {
        const double px = static_cast<double>(x) + 0.5 - x0, py = static_cast<double>(y) + 0.5 - y0;
        const double along = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
        const double distance = std::hypot(px - along * dx, py - along * dy);
        blend(x, y, color, alpha * std::clamp(radius + 0.5 - distance, 0.0, 1.0));
      }
    }
  }

  /// A filled disc.
  void disc(double x, double y, double radius, Color color, double alpha = 1) {
    line(x, y, x, y, 2 * radius, color, alpha);
  }

  /// A filled box, with its edges rounded to whole pixels.
  void box(double x, double y, double width, double height, Color color, double alpha = 1) {
    const auto [left, right] = range(std::round(x), std::round(x + width), image_.width);
    const auto [top, bottom] = range(std::round(y), std::round(y + height), image_.height);
    for (std::ptrdiff_t row = top; row < bottom; ++row)
      for (std::ptrdiff_t column = left; column < right; ++column) blend(column, row, color, alpha);
  }

  /// Text with its top left corner at (x, y); each font pixel is `scale` by `scale` pixels.
  void text(double x, double y, std::string_view utf8, Color color, std::size_t scale = 2) {
    const double s = static_cast<double>(scale);
    double at = std::round(x);
    for (const char c : printable(utf8)) {
      const Glyph g = glyph(c);
      for (std::size_t row = 0; row < glyph_height; ++row)
        for (std::size_t column = 0; column < glyph_width; ++column)
          if (glyph_pixel(g, column, row))
            box(at + static_cast<double>(column) * s,
                std::round(y) + static_cast<double>(row + glyph_drop(c)) * s, s, s, color);
      at += static_cast<double>(glyph_advance) * s;
    }
  }

 private:
  /// The whole pixels between `from` and `to`, clipped to 0..size.
  static std::pair<std::ptrdiff_t, std::ptrdiff_t> range(double from, double to, std::size_t size) {
    const double end = static_cast<double>(size);
    return {static_cast<std::ptrdiff_t>(std::clamp(std::floor(from), 0.0, end)),
            static_cast<std::ptrdiff_t>(std::clamp(std::ceil(to), 0.0, end))};
  }

  Image& image_;
};

/// Width in pixels of `utf8` as Canvas::text draws it.
inline double text_width(std::string_view utf8, std::size_t scale = 2) {
  const std::size_t n = printable(utf8).size();
  return n == 0 ? 0 : static_cast<double>((n * glyph_advance - 1) * scale);
}

/// `utf8` truncated to `width` pixels, with an ellipsis if it was truncated.
inline std::string fitted(std::string_view utf8, double width, std::size_t scale = 2) {
  std::string text = printable(utf8);
  if (text_width(text, scale) <= width) return text;
  while (!text.empty() && text_width(text + "...", scale) > width) text.pop_back();
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text + "...";
}

}  // namespace motiongan::view
