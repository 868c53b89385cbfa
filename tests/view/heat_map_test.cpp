#include "motiongan/view/heat_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace heat_map_test {

using namespace motiongan;
using view::Color;

namespace {

/// The pixels of exactly this colour: leftmost, topmost, number.
struct Found {
  std::size_t left = 100000, top = 100000, pixels = 0;
};

Found find(const view::Image& image, Color color, std::size_t before = 100000) {
  Found out;
  for (std::size_t y = 0; y < image.height; ++y)
    for (std::size_t x = 0; x < std::min(before, image.width); ++x) {
      if (image.at(x, y) != color) continue;
      out.left = std::min(out.left, x);
      out.top = std::min(out.top, y);
      ++out.pixels;
    }
  return out;
}

}  // namespace

TEST_CASE("colours grow darker from 0 to 1") {
  const auto brightness = [](double share) {
    const Color c = view::heat_color(share);
    return 0.3 * c.r + 0.59 * c.g + 0.11 * c.b;
  };
  for (int i = 0; i < 100; ++i) CHECK(brightness((i + 1) / 100.0) < brightness(i / 100.0));
  CHECK(view::heat_color(-3) == view::heat_color(0));
  CHECK(view::heat_color(7) == view::heat_color(1));
}

TEST_CASE("cells have the right positions and colours") {
  view::HeatMap map;
  map.rows = 2;
  map.columns = 3;
  map.values = {0.3f, 0.5f, 1, std::numeric_limits<float>::quiet_NaN(), 0.3f, 0.1f};
  const view::Image image = view::heat_map(std::vector{map}, {.cell = 20, .high = 1});
  const std::size_t bar = image.width - 70;  // the colour bar shows all colours
  const Found half = find(image, view::heat_color(0.5), bar),
              third = find(image, view::heat_color(0.3f), bar);
  const Found none = find(image, {0xb4, 0xb9, 0xbf}, bar), dark = find(image, view::heat_color(1), bar);
  CHECK(half.pixels == 400);
  CHECK(third.pixels == 800);
  CHECK(none.pixels == 400);
  CHECK(dark.pixels == 400);
  CHECK(half.left == third.left + 20);  // to the right of the first cell
  CHECK(half.top == third.top);
  CHECK(none.left == third.left);  // below it
  CHECK(none.top == third.top + 20);
  CHECK(dark.left == half.left + 20);
  // Without `high` the largest value is used.
  map.values = {0.1f, 0.1f, 0.2f, 0.1f, 0.1f, 0.1f};
  const view::Image scaled = view::heat_map(std::vector{map}, {.cell = 20});
  CHECK(find(scaled, view::heat_color(1), bar).pixels == 400);
}

TEST_CASE("several maps are drawn side by side, with titles and labels") {
  view::HeatMap map;
  map.title = "a title wider than its map";
  map.rows = map.columns = 4;
  map.values.assign(16, 0.25f);
  const view::Image one = view::heat_map(std::vector{map}, {.cell = 10});
  const view::Image two = view::heat_map(std::vector{map, map}, {.cell = 10});
  CHECK(two.width > one.width + static_cast<std::size_t>(view::text_width(map.title)));
  CHECK(two.height == one.height);
  const view::Image labelled = view::heat_map(
      std::vector{map}, {.title = "Attention", .row_label = "looks", .column_label = "seen", .cell = 10});
  CHECK(labelled.height > one.height + 60);
  map.values.assign(16, 0.0f);  // all zeros have a scale too
  CHECK(find(view::heat_map(std::vector{map}, {.cell = 10}), view::heat_color(0)).pixels >= 1600);
}

TEST_CASE("invalid maps are rejected") {
  view::HeatMap map;
  map.rows = 2;
  map.columns = 2;
  map.values = {0, 1, 2};
  CHECK_THROWS_AS(view::heat_map(std::vector{map}), Error);
  CHECK_THROWS_AS(view::heat_map(std::vector<view::HeatMap>{}), Error);
  CHECK_THROWS_AS(view::heat_map(std::vector<view::HeatMap>(1)), Error);
  map.values = {0, 1, 2, -1};
  CHECK_THROWS_AS(view::heat_map(std::vector{map}), Error);
  map.values = {0, 1, 2, 1};
  CHECK_THROWS_AS(view::heat_map(std::vector{map}, {.row_scale = 0}), Error);
  CHECK_THROWS_AS(view::heat_map(std::vector{map}, {.cell = 20000}), Error);
}

}  // namespace heat_map_test
