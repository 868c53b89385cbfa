// The foot-skate ratio, against the published definition in numpy and by hand.
#include "motiongan/metrics/foot_skate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace foot_skate_test {

using namespace motiongan;
using motion::Vec3;

namespace {

/// Hips with two legs of length 1.
motion::Skeleton two_legs() {
  motion::Skeleton s;
  s.joints = {{"Hips", -1, {}, {}, {}},
              {"LeftLeg", 0, {0.1, 0, 0}, {}, {}},
              {"LeftFoot", 1, {0, -0.8, 0}, {}, {}},
              {"LeftToeBase", 2, {0, 0, 0.1}, {}, {}},
              {"RightLeg", 0, {-0.1, 0, 0}, {}, {}},
              {"RightFoot", 4, {0, -0.8, 0}, {}, {}},
              {"RightToeBase", 5, {0, 0, 0.1}, {}, {}}};
  return s;
}

/// Positions [frames, 7]; feet(f) returns the positions of the left and right toe.
template <class F>
std::vector<Vec3> positions(std::size_t frames, F&& feet) {
  std::vector<Vec3> out;
  for (std::size_t f = 0; f < frames; ++f) {
    const auto [left, right] = feet(static_cast<double>(f));
    out.insert(out.end(), {{0, 1, 0}, {}, {}, left, {}, {}, right});
  }
  return out;
}

using Feet = std::pair<Vec3, Vec3>;

}  // namespace

TEST_CASE("sliding steps follow the published definition (numpy, scipy's uniform_filter1d)") {
  const auto all = positions(60, [](double t) {
    return Feet{
        {0.12 * std::sin(0.5 * t) + 0.02 * t, 0.04 + 0.04 * std::sin(0.37 * t), 0.05 * std::cos(0.8 * t)},
        {0.10 * std::cos(0.45 * t), 0.045 + 0.04 * std::cos(0.29 * t), 0.06 * std::sin(0.33 * t)}};
  });
  FootSkateOptions options;
  options.unit_metres = 1;
  options.floor = 0;
  const FootSkate at_20 = foot_skate(two_legs(), all, 20, options);  // a window of 5 steps
  CHECK(at_20.steps == 59);
  CHECK(at_20.contact == 42);
  CHECK(at_20.sliding == 32);
  CHECK(at_20.ratio() == doctest::Approx(32.0 / 59));
  CHECK(foot_skate(two_legs(), all, 12, options).sliding == 16);  // a window of 3

  // In centimetres, and raised by a metre: the floor is found.
  std::vector<Vec3> moved = all;
  for (Vec3& p : moved) p = {100 * p[0], 100 * p[1] + 100, 100 * p[2]};
  options.unit_metres = 0.01;
  options.floor = 100;
  CHECK(foot_skate(two_legs(), moved, 20, options).sliding == 32);
}

TEST_CASE("by hand: one foot slides for ten of twenty steps at 1 m/s, the other is raised") {
  const auto slide = [](double speed) {
    return positions(21, [speed](double f) {
      return Feet{{0, 0, std::min(f, 10.0) * speed / 20}, {f, 0.5, 0}};
    });
  };
  FootSkateOptions options;
  options.unit_metres = 1;
  // The mean over 5 steps is 3/5 and 4/5 of the speed in the first two and last two of the ten.
  CHECK(foot_skate(two_legs(), slide(1), 20, options).sliding == 10);
  CHECK(foot_skate(two_legs(), slide(1), 20, options).contact == 20);
  CHECK(foot_skate(two_legs(), slide(0.6), 20, options).sliding == 6);  // 0.36 and 0.48 m/s there
  CHECK(foot_skate(two_legs(), slide(0.45), 20, options).sliding == 0);
}

TEST_CASE("with an unknown unit a leg is a metre") {
  const motion::Skeleton skeleton = two_legs();
  const std::vector<std::size_t> feet = find_feet(skeleton);
  CHECK(feet == std::vector<std::size_t>{3, 6});
  CHECK(leg_length(skeleton, feet) == doctest::Approx(1.0));
  motion::Skeleton large = skeleton;
  for (motion::Joint& j : large.joints) j.offset = motion::scale(j.offset, 30);
  auto all = positions(21, [](double f) { return Feet{{0, 0, f / 20}, {0, 0, 0}}; });
  CHECK(foot_skate(skeleton, all, 20).sliding == 20);
  CHECK(foot_skate(large, all, 20).sliding == 0);
  for (Vec3& p : all) p = motion::scale(p, 30);
  CHECK(foot_skate(large, all, 20).sliding == 20);
}

TEST_CASE("feet by other names") {
  const auto named = [](std::vector<std::string> names) {
    motion::Skeleton s = two_legs();
    for (std::size_t j = 0; j < names.size(); ++j) s.joints[j].name = names[j];
    return s;
  };
  CHECK(find_feet(named({"Hips", "UpperLeg_L", "Foot_L", "Toes_L", "UpperLeg_R", "Foot_R", "Toes_R"})) ==
        std::vector<std::size_t>{3, 6});
  CHECK(find_feet(named({"Hips", "lThigh", "lFoot", "lTip", "rThigh", "rFoot", "rTip"})) ==
        std::vector<std::size_t>{2, 5});
  const motion::Skeleton strange = named({"a", "b", "c", "d", "e", "f", "g"});
  CHECK_THROWS_WITH_AS(find_feet(strange), doctest::Contains("two of: a, b, c, d, e, f, g"), Error);
  const std::vector<std::string> given{"d", "g"}, wrong{"d", "z"};
  CHECK(find_feet(strange, given) == std::vector<std::size_t>{3, 6});
  CHECK_THROWS_WITH_AS(find_feet(strange, wrong), doctest::Contains("no joint 'z'"), Error);
}

TEST_CASE("motions add up, and invalid input is rejected") {
  FootSkate sum{10, 2, 8};
  sum += {30, 8, 12};
  CHECK(sum.ratio() == doctest::Approx(0.25));
  CHECK(sum.contact_share() == doctest::Approx(0.5));
  CHECK(FootSkate{}.ratio() == 0);
  const std::vector<Vec3> one(7);
  CHECK_THROWS_WITH_AS(foot_skate(two_legs(), one, 20), doctest::Contains("two whole frames"), Error);
  const std::vector<Vec3> two(14);
  CHECK_THROWS_WITH_AS(foot_skate(two_legs(), two, 0), doctest::Contains("a rate of 0"), Error);
}

}  // namespace foot_skate_test
