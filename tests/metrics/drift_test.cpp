// Drift of a long motion, second by second.
#include "motiongan/metrics/drift.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace drift_test {

using namespace motiongan;

namespace {

/// Two dimensions at `rate`, trained on values from -1 to 1 and from 0 to 2.
motion::MotionFormat two_dimensions(double rate, bool with_range = true) {
  motion::Skeleton skeleton;
  skeleton.joints = {{"Hips", -1, {}, {}, {}}};
  motion::MotionFormat format;
  format.layout = motion::PoseLayout(skeleton, false);
  format.normalizer = motion::Normalizer({0, 0, 0}, {1, 0, 1});
  format.rate = rate;
  format.frames = 4;
  if (with_range) {
    format.low = {-1, 0};
    format.high = {1, 2};
  }
  return format;
}

}  // namespace

TEST_CASE("mean, spread, speed and fraction outside, by hand") {
  DriftMeter meter(two_dimensions(4));
  meter.add(std::vector<float>{0.5f, 1, 0.5f, 1, 1.09f, 2.09f, -1.11f, -0.09f},
            4);  // the range ends are 1.1 and -0.1
  meter.add(std::vector<float>{3, 4, 3, 4, 3, 4, 3, 4, 3, 1}, 5);
  const std::vector<DriftRow> rows = meter.rows();
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].second == 0);
  CHECK(rows[0].frames == 4);
  CHECK(rows[0].mean == doctest::Approx(std::sqrt((0.245 * 0.245 + 1.0) / 2)).epsilon(1e-6));
  // Deviations from 0.245 and 1: 0.255, 0.255, 0.845, -1.355 and 0, 0, 1.09, -1.09.
  const double v0 = (2 * 0.255 * 0.255 + 0.845 * 0.845 + 1.355 * 1.355) / 4, v1 = 2 * 1.09 * 1.09 / 4;
  CHECK(rows[0].spread == doctest::Approx(std::sqrt((v0 + v1) / 2)).epsilon(1e-6));
  // Three steps: 0, (0.59, 1.09), (-2.2, -2.18).
  const double s1 = std::sqrt((0.59 * 0.59 + 1.09 * 1.09) / 2), s2 = std::sqrt((2.2 * 2.2 + 2.18 * 2.18) / 2);
  CHECK(rows[0].speed == doctest::Approx(4 * (s1 + s2) / 3).epsilon(1e-6));
  CHECK(rows[0].outside == doctest::Approx(1.0 / 8));
  CHECK(rows[1].mean == doctest::Approx(std::sqrt(12.5)));
  CHECK(rows[1].spread == 0);
  CHECK(rows[1].speed ==
        doctest::Approx(std::sqrt((4.11 * 4.11 + 4.09 * 4.09) / 2)).epsilon(1e-6));  // 1 of 4
  CHECK(rows[1].outside == 1);
  CHECK(rows[2].second == 2);
  CHECK(rows[2].frames == 1);
  CHECK(rows[2].speed == doctest::Approx(4 * 3 / std::sqrt(2.0)));
  CHECK(rows[2].outside == 0.5);
}

TEST_CASE("results do not depend on the pieces; a fractional frame rate") {
  std::vector<float> poses;
  for (int f = 0; f < 1000; ++f) poses.insert(poses.end(), {float(std::sin(0.1 * f)), float(0.002 * f)});
  DriftMeter whole(two_dimensions(12.5));
  whole.add(poses, 1000);
  const std::vector<DriftRow> rows = whole.rows();
  REQUIRE(rows.size() == 80);
  for (std::size_t s = 0; s < 80; ++s) {
    CHECK(rows[s].second == s);
    CHECK(rows[s].frames == (s % 2 == 0 ? 13 : 12));
  }
  for (const std::size_t piece : {1, 7, 64}) {
    DriftMeter pieces(two_dimensions(12.5));
    for (std::size_t f = 0; f < 1000; f += piece) {
      const std::size_t count = std::min(piece, 1000 - f);
      pieces.add(std::span(poses).subspan(2 * f, 2 * count), count);
    }
    CHECK(pieces.frames() == 1000);
    const std::vector<DriftRow> found = pieces.rows();
    REQUIRE(found.size() == rows.size());
    for (std::size_t s = 0; s < rows.size(); ++s)
      CHECK((found[s].mean == rows[s].mean && found[s].spread == rows[s].spread &&
             found[s].speed == rows[s].speed && found[s].outside == rows[s].outside));
  }

  // First and last eight seconds: the second dimension has grown.
  const DriftSummary summary = whole.summary();
  CHECK(summary.seconds == 80);
  CHECK(summary.whole.frames == 1000);
  CHECK(summary.first.second == 0);
  CHECK(summary.last.second == 72);
  CHECK(summary.first.frames == 100);
  double mean = 0;
  for (std::size_t s = 72; s < 80; ++s) mean += rows[s].mean * double(rows[s].frames) / 100;
  CHECK(summary.last.mean == doctest::Approx(mean));
  CHECK(summary.last.mean > 3 * summary.first.mean);
  CHECK(summary.last.speed == doctest::Approx(summary.first.speed).epsilon(0.05));
}

TEST_CASE("one frame, no frames, an unknown range, and NaN") {
  DriftMeter meter(two_dimensions(4, false));
  CHECK(meter.rows().empty());
  CHECK_THROWS_WITH_AS(meter.summary(), doctest::Contains("no frames were measured"), Error);
  meter.add(std::vector<float>{3, 4}, 1);
  CHECK(meter.rows().at(0).mean == doctest::Approx(std::sqrt(12.5)));
  CHECK(meter.rows().at(0).speed == 0);
  CHECK(std::isnan(meter.summary().whole.outside));
  CHECK_THROWS_WITH_AS(meter.add(std::vector<float>(3), 1),
                       doctest::Contains("3 pose values, expected 1 frames x 2"), Error);
  const auto path = std::filesystem::temp_directory_path() / "motiongan_drift_test.csv";
  meter.write_csv(path);
  CHECK(motion::read_text(path, "table") == "second,frames,mean,spread,speed,outside\n0,1,3.53553,0,0,\n");
  DriftMeter ranged(two_dimensions(4));
  ranged.add(std::vector<float>{0, std::numeric_limits<float>::quiet_NaN()}, 1);
  CHECK(ranged.rows().at(0).outside == 0.5);
  ranged.write_csv(path);
  CHECK(motion::read_text(path, "table").find("0,1,nan,nan,") != std::string::npos);
  std::filesystem::remove(path);
}

}  // namespace drift_test
