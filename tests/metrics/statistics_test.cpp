// Motion statistics, by hand: a hinge that rotates uniformly, and one that swings sinusoidally.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "motiongan/metrics/statistics.hpp"

namespace statistics_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// A root and an arm of length 2 with a hand of length 1; the arm rotates about z by angle(f) degrees.
template <class Angle>
Motion hinge(std::size_t frames, double rate, const Angle& angle, double root_step = 0, double height = 5) {
  Motion m;
  const std::vector<Channel> turns{Channel::z_rotation, Channel::y_rotation, Channel::x_rotation};
  std::vector<Channel> all{Channel::x_position, Channel::y_position, Channel::z_position};
  all.insert(all.end(), turns.begin(), turns.end());
  m.skeleton.joints = {{"Hips", -1, {0, 0, 0}, all, {}}, {"Arm", 0, {2, 0, 0}, turns, Vec3{1, 0, 0}}};
  m.rate = rate;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f) {
    m.rotations.push_back(Quat{});
    m.rotations.push_back(axis_rotation(2, radians(angle(static_cast<double>(f)))));
    m.positions.push_back({root_step * static_cast<double>(f), height, 0});
    m.positions.push_back({2, 0, 0});
  }
  return m;
}

}  // namespace

TEST_CASE("a uniformly rotating joint: mean, spread, range, speed, root speed, lowest point") {
  // Angles 0, 10, 20, 30 degrees at 10 Hz: mean 15, spread sqrt(125), speed 100 deg/s.
  const std::vector<Motion> clips{hinge(
      4, 10, [](double f) { return -10 * f; }, 0.3)};
  const MotionStatistics s = measure(clips);
  CHECK(s.clips == 1);
  CHECK(s.frames == 4);
  CHECK(s.seconds == doctest::Approx(0.3));
  REQUIRE(s.joints.size() == 2);
  const JointStatistics& arm = s.joints[1];
  CHECK(arm.name == "Arm");
  CHECK(arm.mean[2] == doctest::Approx(-15));
  CHECK(arm.mean[0] == doctest::Approx(0));
  CHECK(arm.spread[2] == doctest::Approx(std::sqrt(125.0)));
  CHECK(arm.total_spread() == doctest::Approx(std::sqrt(125.0 / 3)));
  CHECK(arm.low[2] == doctest::Approx(-30));
  CHECK(arm.high[2] == doctest::Approx(0));
  CHECK(arm.angle == doctest::Approx(15));
  CHECK(arm.angle_spread == doctest::Approx(std::sqrt(125.0)));
  CHECK(arm.speed == doctest::Approx(100));
  CHECK(arm.speed_p95 == doctest::Approx(100));
  CHECK(s.joints[0].speed == doctest::Approx(0).epsilon(1e-9));
  CHECK(s.root_speed == doctest::Approx(3));
  CHECK(s.root_speed_p95 == doctest::Approx(3));
  // The hand's end is the lowest point: 5 - sin(angle).
  CHECK(s.highest_low == doctest::Approx(5));
  CHECK(s.lowest == doctest::Approx(4.5));
  const double sines = std::sin(radians(10.)) + std::sin(radians(20.)) + std::sin(radians(30.));
  CHECK(s.mean_low == doctest::Approx(5 - sines / 4));
}

TEST_CASE("the 95th percentile is interpolated, and clips are pooled") {
  CHECK(percentile({}, 0.5) == 0);
  CHECK(percentile({4}, 0.95) == 4);
  CHECK(percentile({3, 1, 2}, 0.5) == doctest::Approx(2));
  CHECK(percentile({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, 0.95) == doctest::Approx(9.5));
  // One clip at 20 deg/s, one at 60: 3 + 3 steps.
  const std::vector<Motion> clips{hinge(4, 10, [](double f) { return 2 * f; }),
                                  hinge(4, 10, [](double f) { return 6 * f; })};
  const MotionStatistics s = measure(clips);
  CHECK(s.clips == 2);
  CHECK(s.frames == 8);
  CHECK(s.joints[1].speed == doctest::Approx(40));
  CHECK(s.joints[1].mean[2] == doctest::Approx((0 + 2 + 4 + 6 + 0 + 6 + 12 + 18) / 8.0));
}

TEST_CASE("mean frequency: of a sine its own, of two sines their power-weighted mean") {
  const double rate = 20;
  const auto sine = [rate](double hz, double degrees_) {
    return [=](double f) { return degrees_ * std::sin(2 * pi * hz * f / rate); };
  };
  CHECK(measure(std::vector<Motion>{hinge(80, rate, sine(1.5, 20))}).frequency == doctest::Approx(1.5));
  // Amplitudes 20 and 10 have powers 4 and 1: (4 * 1 + 1 * 6) / 5.
  const auto both = [&](double f) { return sine(1, 20)(f) + sine(6, 10)(f); };
  CHECK(measure(std::vector<Motion>{hinge(80, rate, both)}).frequency == doctest::Approx(2.0));
  // At the Nyquist frequency a cosine is +1, -1, +1, ...
  const auto fastest = [](double f) { return 5 * std::cos(pi * f); };
  CHECK(measure(std::vector<Motion>{hinge(8, rate, fastest)}).frequency == doctest::Approx(10));
  // A long clip is split into pieces: 1024 frames at 1.25 Hz are twice 32 periods.
  CHECK(measure(std::vector<Motion>{hinge(1024, rate, sine(1.25, 9))}).frequency == doctest::Approx(1.25));
  CHECK(measure(std::vector<Motion>{hinge(8, rate, [](double) { return 3.0; })}).frequency == 0);
}

TEST_CASE("a set compared with itself: ratios 1, nothing outside") {
  const std::vector<Motion> clips{hinge(
      40, 10, [](double f) { return 30 * std::sin(f / 5); }, 0.1)};
  const MotionStatistics s = measure(clips);
  const StatisticsComparison c = compare(s, s, 0);
  CHECK(c.median_spread_ratio == doctest::Approx(1));
  CHECK(c.mean_speed_ratio == doctest::Approx(1));
  CHECK(c.values_outside == 0);
  CHECK(c.frames_outside == 0);
  CHECK(c.joints[1].mean_difference == doctest::Approx(0));
  CHECK(std::isnan(c.joints[0].spread_ratio));  // the root does not rotate
  CHECK(c.generated.poses.empty());
}

TEST_CASE("1.8 times the amplitude and speed, and frames outside the real range") {
  // Real: 0, 10 .. 90 degrees. Generated: 0, 18 .. 162, four of them above 90.
  const MotionStatistics real = measure(std::vector<Motion>{hinge(10, 10, [](double f) { return 10 * f; })});
  const MotionStatistics made = measure(std::vector<Motion>{hinge(10, 10, [](double f) { return 18 * f; })});
  const StatisticsComparison c = compare(made, real, 0);
  CHECK(c.joints[1].spread_ratio == doctest::Approx(1.8));
  CHECK(c.median_spread_ratio == doctest::Approx(1.8));
  CHECK(c.mean_speed_ratio == doctest::Approx(1.8));
  CHECK(c.joints[1].speed_p95_ratio == doctest::Approx(1.8));
  CHECK(c.joints[1].mean_difference == doctest::Approx(0.8 * 45));
  CHECK(c.joints[1].outside == doctest::Approx(0.4));  // 90 is inside
  CHECK(c.frames_outside == doctest::Approx(0.4));
  CHECK(c.values_outside == doctest::Approx(4.0 / 60));  // 10 frames x 2 joints x 3 values
  // 25% of 90 degrees is 22.5: 108 is now inside.
  CHECK(compare(made, real, 0.25).joints[1].outside == doctest::Approx(0.3));
  // An empty range is still widened by half a degree at each end.
  const MotionStatistics still = measure(std::vector<Motion>{hinge(5, 10, [](double) { return 0.0; })});
  const auto turned = [](double angle) {
    return measure(std::vector<Motion>{hinge(5, 10, [angle](double) { return angle; })});
  };
  CHECK(compare(turned(0.49), still).frames_outside == 0);
  CHECK(compare(turned(0.51), still).frames_outside == 1);
  CHECK(std::isnan(compare(still, still).median_spread_ratio));
}

TEST_CASE("the table has aligned columns and one line per joint, the CSV equal numbers of fields") {
  const MotionStatistics real = measure(std::vector<Motion>{hinge(10, 10, [](double f) { return 10 * f; })});
  const MotionStatistics made = measure(std::vector<Motion>{hinge(10, 10, [](double f) { return 18 * f; })});
  const StatisticsComparison c = compare(made, real);
  const std::string table = to_table(c, "cm");
  CHECK(table.find("median spread ratio") != std::string::npos);
  CHECK(table.find("1.800") != std::string::npos);
  CHECK(table.find("root speed (cm/s)") != std::string::npos);
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < table.size();) {
    const std::size_t end = table.find('\n', at);
    lines.push_back(table.substr(at, end - at));
    at = end + 1;
  }
  REQUIRE(lines.size() > 4);
  CHECK(lines[1].size() == lines[0].size());
  CHECK(lines[2].substr(0, 4) == "Hips");
  CHECK(lines[3].substr(0, 3) == "Arm");
  CHECK(lines[2].size() == lines[0].size());
  CHECK(lines[3].size() == lines[0].size());
  CHECK(lines[3].find("nan") == std::string::npos);

  StatisticsComparison odd = c;
  odd.joints[1].real.name = "Arm, \"left\"";
  CHECK(to_csv(odd).find("\n\"Arm, \"\"left\"\"\",") != std::string::npos);
  const std::string csv = to_csv(c);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 3);
  for (std::size_t at = 0, line = 0; line < 3; ++line) {
    const std::size_t end = csv.find('\n', at);
    CHECK(std::count(csv.begin() + static_cast<std::ptrdiff_t>(at),
                     csv.begin() + static_cast<std::ptrdiff_t>(end), ',') == 15);
    at = end + 1;
  }
  CHECK(csv.find("nan") == std::string::npos);
}

TEST_CASE("sets that cannot be measured or compared are rejected") {
  const auto flat = [](double) { return 0.0; };
  CHECK_THROWS_WITH_AS(measure({}), doctest::Contains("at least one clip"), Error);
  CHECK_THROWS_WITH_AS(measure(std::vector<Motion>{hinge(1, 10, flat)}), doctest::Contains("at least 2"),
                       Error);
  Motion other = hinge(4, 10, flat);
  other.skeleton.joints[1].name = "Leg";
  CHECK_THROWS_WITH_AS(measure(std::vector<Motion>{hinge(4, 10, flat), other}), doctest::Contains("'Leg'"),
                       Error);
  const MotionStatistics a = measure(std::vector<Motion>{hinge(4, 10, flat)});
  const MotionStatistics b = measure(std::vector<Motion>{other});
  CHECK_THROWS_WITH_AS(compare(a, b), doctest::Contains("'Leg'"), Error);
  CHECK_THROWS_WITH_AS(compare(a, a, -1), doctest::Contains("margin"), Error);
  MotionStatistics bare = a;
  bare.poses.clear();
  CHECK_THROWS_WITH_AS(compare(bare, a), doctest::Contains("measure()"), Error);
}

}  // namespace statistics_test
