#include "motiongan/view/figure.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "figure_help.hpp"

namespace figure_test {

using namespace motiongan;
using view::Side;

TEST_CASE("the side of a joint is read from its name") {
  CHECK(view::side_of("LeftFoot") == Side::left);
  CHECK(view::side_of("RightHandIndex1") == Side::right);
  CHECK(view::side_of("LHipJoint") == Side::left);
  CHECK(view::side_of("RThumb") == Side::right);
  CHECK(view::side_of("UpperLeg_L") == Side::left);
  CHECK(view::side_of("hand.R") == Side::right);
  CHECK(view::side_of("mixamorig:LeftArm") == Side::left);
  CHECK(view::side_of("r_foot") == Side::right);
  for (const char* centre : {"LowerBack", "Hips", "Root", "Spine1", "Neck", "Head", "", "L"})
    CHECK(view::side_of(centre) == Side::centre);
}

TEST_CASE("a figure has a node for every distinct point, end sites included") {
  const auto viewed = test::walker(20);
  const view::Figure figure = view::make_figure(viewed);
  // The handle is not drawn and LowerBack coincides with the hips; three end sites are added.
  REQUIRE(figure.nodes() == 9);
  CHECK(figure.parents == std::vector<int>{-1, 0, 1, 0, 3, 4, 0, 6, 7});
  CHECK(figure.heads == std::vector<char>{0, 0, 1, 0, 0, 0, 0, 0, 0});
  CHECK(figure.sides[3] == Side::left);
  CHECK(figure.sides[8] == Side::right);

  const auto global = motion::forward_kinematics(viewed.motion);
  for (std::size_t f = 0; f < figure.frames; ++f) {
    CHECK(figure.point(f, 0) == global.positions[f * 8 + 1]);
    CHECK(figure.point(f, 7) == global.positions[f * 8 + 7]);
    // The head's tip is 20 above the head.
    CHECK(figure.point(f, 2)[1] == doctest::Approx(global.positions[f * 8 + 3][1] + 20));
  }
  CHECK(figure.heading == doctest::Approx(std::acos(0.0)));
  CHECK(figure.floor <= 5);  // 90 - 5 - 80, and the toes of the swinging leg
  CHECK(figure.floor > 5 - 15 * std::sin(0.4));
  CHECK(figure.height == doctest::Approx(1.3 * (std::hypot(10, 5) + 80 + 15)));
}

TEST_CASE("motions with the same seed frames are viewed from the same side") {
  view::ViewedMotion turning = test::walker(20);                            // faces +x
  for (std::size_t f = 5; f < 20; ++f) turning.motion.rotation(f, 1) = {};  // then +z
  CHECK(view::make_figure(turning).heading < 1);
  turning.seed_frames = 5;
  CHECK(view::make_figure(turning).heading == doctest::Approx(std::acos(0.0)));
}

TEST_CASE("motions that cannot be drawn are rejected by name") {
  auto none = test::walker(1, 30, "empty one");
  none.motion.frames = 0;
  none.motion.rotations.clear();
  none.motion.positions.clear();
  CHECK_THROWS_WITH_AS(view::make_figure(none), doctest::Contains("empty one"), Error);
  auto wild = test::walker(5, 30, "wild one");
  wild.motion.position(3, 1)[2] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(view::make_figure(wild), doctest::Contains("frame 3"), Error);
}

TEST_CASE("one frame and one joint are enough") {
  CHECK(view::make_figure(test::walker(1)).frames == 1);
  view::ViewedMotion dot;
  dot.motion.skeleton.joints.resize(1);
  dot.motion.rate = 10;
  dot.motion.frames = 2;
  dot.motion.rotations.resize(2);
  dot.motion.positions.resize(2);
  const view::Figure figure = view::make_figure(dot);
  CHECK(figure.nodes() == 1);
  CHECK(figure.height > 0);
}

}  // namespace figure_test
