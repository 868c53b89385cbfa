#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "figure_help.hpp"
#include "motiongan/view/canvas.hpp"
#include "motiongan/view/line_plot.hpp"
#include "motiongan/view/pose_strip.hpp"

namespace picture_test {

using namespace motiongan;
using view::Color;

namespace {

/// Number of pixels close to `color` in the given part of the image.
std::size_t count(const view::Image& image, Color color, std::size_t x0, std::size_t x1, std::size_t y0,
                  std::size_t y1) {
  std::size_t n = 0;
  for (std::size_t y = y0; y < y1; ++y)
    for (std::size_t x = x0; x < x1; ++x) {
      const Color c = image.at(x, y);
      n += std::abs(c.r - color.r) + std::abs(c.g - color.g) + std::abs(c.b - color.b) < 30;
    }
  return n;
}

constexpr Color orange{0xd5, 0x5e, 0x00}, blue{0x1f, 0x6f, 0xb4}, grey{0x70, 0x76, 0x7d};

}  // namespace

TEST_CASE("every printable character has a glyph of its own") {
  std::set<view::Glyph> seen;
  for (char c = 33; c < 127; ++c) {
    CHECK(view::glyph(c) != 0);
    CHECK((view::glyph(c) >> 35) == 0);
    seen.insert(view::glyph(c) | static_cast<view::Glyph>(view::glyph_drop(c)) << 40);
  }
  CHECK(seen.size() == 94);
  CHECK(view::glyph(' ') == 0);
  CHECK(view::printable("na\xc3\xafve \xe6\xad\xa9\n") == "na?ve ? ");
  CHECK(view::glyph_pixel(view::glyph('L'), 0, 0));
  CHECK_FALSE(view::glyph_pixel(view::glyph('L'), 4, 0));
}

TEST_CASE("lines have the right coverage and are clipped to the image") {
  view::Image image(40, 20);
  view::Canvas canvas(image);
  canvas.line(5, 10, 35, 10, 4, {0, 0, 0});
  CHECK(image.at(20, 9) == Color{0, 0, 0});
  CHECK(image.at(20, 5) == Color{255, 255, 255});
  double ink = 0;  // coverage of a row of pixels across the line adds up to its thickness
  for (std::size_t y = 0; y < 20; ++y) ink += (255 - image.at(20, y).r) / 255.0;
  CHECK(ink == doctest::Approx(4).epsilon(0.02));
  canvas.line(-100, -50, 300, 500, 3, {9, 9, 9});
  canvas.disc(1e9, 1e9, 5, {9, 9, 9});
  canvas.line(0, 0, std::numeric_limits<double>::quiet_NaN(), 3, 2, {1, 1, 1});
  canvas.text(-7, 15, "cut off at every side of it", {3, 3, 3});
  CHECK(image.rgb.size() == 40 * 20 * 3);
  CHECK_THROWS_AS(view::Image(0, 5), Error);
  CHECK_THROWS_AS(view::Image(100000, 5), Error);
}

TEST_CASE("text is truncated to the available width") {
  CHECK(view::fitted("short", 100) == "short");
  const std::string cut = view::fitted("a description that is rather long", 120);
  CHECK(view::text_width(cut) <= 120);
  CHECK(cut.substr(cut.size() - 3) == "...");
}

TEST_CASE("a strip has a row of poses for every motion") {
  const std::vector<view::ViewedMotion> motions{test::walker(60, 30, "walks on"),
                                                test::walker(60, 30, "begins as given", 40),
                                                test::walker(2, 30, "has but two frames")};
  const view::StripOptions options{.poses = 6, .figure_height = 100};
  const view::Image strip = view::pose_strip(motions, options);
  const std::size_t w = strip.width, row = strip.height / 3;
  CHECK(w > 6 * 60);
  for (std::size_t r = 0; r < 3; ++r) {
    CHECK(count(strip, orange, 0, w, r * row, (r + 1) * row) > 30);
    CHECK(count(strip, blue, 0, w, r * row, (r + 1) * row) > 30);
  }
  // Every sixth of the first row shows a pose with both legs; the second row's seed frames are grey.
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(count(strip, orange, i * w / 6, (i + 1) * w / 6, 0, row) > 20);
    const bool lively = count(strip, orange, i * w / 6, (i + 1) * w / 6, row, 2 * row) > 0;
    CHECK(lively == (i >= 4));
  }
  CHECK(count(strip, grey, 0, w / 2, row, 2 * row) > 50);
  // Two frames make two poses.
  CHECK(count(strip, orange, w / 2, w, 2 * row, 3 * row) == 0);
}

TEST_CASE("left and right are not mirrored") {
  // Seen from the front, the left leg is on the viewer's right.
  const view::Image strip = view::pose_strip(std::vector{test::walker(1)}, {.poses = 1, .azimuth = 0});
  double left = 0, right = 0, lefts = 0, rights = 0;
  for (std::size_t y = 26; y < strip.height - 24; ++y)
    for (std::size_t x = 0; x < strip.width; ++x) {
      if (strip.at(x, y) == orange) left += static_cast<double>(x), ++lefts;
      if (strip.at(x, y) == blue) right += static_cast<double>(x), ++rights;
    }
  REQUIRE(lefts > 0);
  REQUIRE(rights > 0);
  CHECK(left / lefts > right / rights + 5);
}

TEST_CASE("invalid strips are rejected") {
  CHECK_THROWS_AS(view::pose_strip({}), Error);
  CHECK_THROWS_AS(view::pose_strip(std::vector{test::walker(3)}, {.poses = 0}), Error);
  CHECK_THROWS_AS(view::pose_strip(std::vector{test::walker(3)}, {.figure_height = 5}), Error);
}

TEST_CASE("a plot draws each series in its colour") {
  std::vector<view::Series> series{{"wasserstein", {}, {}}, {"penalty", {}, {}}};
  for (int i = 0; i < 200; ++i) {
    series[0].x.push_back(i);
    series[0].y.push_back(50 * std::exp(-i / 60.0));
    series[1].x.push_back(i);
    series[1].y.push_back(i == 100 ? std::numeric_limits<double>::quiet_NaN() : 3 + std::sin(i / 10.0));
  }
  const view::Image plot = view::line_plot(series, {.title = "training", .x_label = "iteration"});
  CHECK(plot.width == 960);
  CHECK(plot.height == 480);
  CHECK(count(plot, view::palette(0), 0, 960, 100, 400) > 300);
  CHECK(count(plot, view::palette(1), 0, 960, 100, 430) > 300);
  // The falling curve starts at the top left and ends at the bottom right.
  CHECK(count(plot, view::palette(0), 60, 200, 70, 200) > 20);
  CHECK(count(plot, view::palette(0), 700, 960, 70, 200) == 0);

  view::Series flat{"flat", {5}, {-2}};
  CHECK(count(view::line_plot(std::vector{flat}), view::palette(0), 0, 960, 60, 480) > 2);
  flat.y = {1, 2};
  CHECK_THROWS_WITH_AS(view::line_plot(std::vector{flat}), doctest::Contains("flat"), Error);
  CHECK_THROWS_AS(view::line_plot(std::vector<view::Series>{}), Error);
}

TEST_CASE("a legend takes as many lines as it needs") {
  std::vector<view::Series> series;
  for (int i = 0; i < 4; ++i) series.push_back({"the name of a training run", {0, 1}, {0, 1}});
  const view::Image plot = view::line_plot(series, {.width = 480, .height = 320});
  // One name fills more than half of a line.
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(count(plot, view::palette(i), 0, 100, 24 + 20 * i - 3, 24 + 20 * i + 4) > 40);
}

TEST_CASE("axes have round numbers") {
  const auto axis = view::detail::nice_axis(-3.2, 47, 6);
  CHECK(axis.step == doctest::Approx(10));
  CHECK(axis.low == doctest::Approx(-10));
  CHECK(axis.high == doctest::Approx(50));
  CHECK(view::detail::nice_axis(7, 7, 5).high > 7);
}

}  // namespace picture_test
