// Jerk, against curves with known third derivatives and numpy's differences.
#include "motiongan/metrics/jerk.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace jerk_test {

using namespace motiongan;
using motion::Vec3;

TEST_CASE("t^3 has a third derivative of 6, constant acceleration one of 0") {
  std::vector<Vec3> cubic, square;
  for (int f = 0; f < 10; ++f) {
    const double t = f / 20.0;
    cubic.push_back({t * t * t, 0, 5});
    square.push_back({3 * t * t, -t, 5});
  }
  CHECK(mean_jerk(cubic, 1, 20) == doctest::Approx(6).epsilon(1e-9));
  CHECK(mean_jerk(cubic, 1, 20, 0.01) == doctest::Approx(0.06).epsilon(1e-9));
  CHECK(mean_jerk(square, 1, 20) < 1e-9);
}

TEST_CASE("two joints, compared with numpy.diff(n=3)") {
  std::vector<Vec3> positions;
  for (int f = 0; f < 20; ++f)
    for (int j = 0; j < 2; ++j)
      positions.push_back({std::sin(0.3 * f * (j + 1)), std::cos(0.2 * f) + j, 0.01 * f * f * f});
  CHECK(mean_jerk(positions, 2, 30) == doctest::Approx(2834.275406467364).epsilon(1e-9));
}

TEST_CASE("a motion is measured by forward kinematics") {
  motion::Motion motion;
  motion.skeleton.joints = {{"Hips", -1, {}, {}, {}}, {"Knee", 0, {0, -2, 0}, {}, {}}};
  motion.rate = 10;
  motion.frames = 8;
  for (int f = 0; f < 8; ++f) {
    const double angle = 0.3 * f;  // the knee circles the hips, which stay put
    motion.rotations.push_back(motion::axis_rotation(2, angle));
    motion.rotations.emplace_back();
    motion.positions.push_back({});
    motion.positions.push_back({0, -2, 0});
  }
  // A chord of a circle of radius 2 in steps of 0.3: the third difference is 2 (2 sin 0.15)^3.
  const double knee = 2 * std::pow(2 * std::sin(0.15), 3) * 1000;
  CHECK(mean_jerk(motion) == doctest::Approx(knee / 2).epsilon(1e-9));
}

TEST_CASE("too few frames and wrong sizes are rejected") {
  const std::vector<Vec3> six(6);
  CHECK_THROWS_WITH_AS(mean_jerk(six, 2, 30), doctest::Contains("found 3 frames"), Error);
  CHECK_THROWS_WITH_AS(mean_jerk(six, 4, 30), doctest::Contains("whole frames of 4"), Error);
  CHECK_THROWS_WITH_AS(mean_jerk(six, 1, 0), doctest::Contains("a rate of 0"), Error);
}

}  // namespace jerk_test
