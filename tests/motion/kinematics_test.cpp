// Forward kinematics on an arm computed by hand, and bone lengths.
#include "motiongan/motion/kinematics.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "../support/arm.hpp"

namespace kinematics_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("an arm bent at shoulder and elbow") {
  Motion m = arm(2);
  m.position(1, 0) = {10, 20, 30};
  m.rotation(1, 0) = quat_from_expmap({0, 0, pi / 2});   // x to y
  m.rotation(1, 1) = quat_from_expmap({0, -pi / 2, 0});  // x to z in the upper arm's frame
  const GlobalPose g = forward_kinematics(m);
  CHECK(near(g.positions[0], {0, 0, 0}));
  CHECK(near(g.positions[1], {2, 0, 0}));
  CHECK(near(g.positions[2], {3, 0, 0}));
  CHECK(near(g.positions[3], {10, 20, 30}));
  CHECK(near(g.positions[4], {10, 22, 30}));
  CHECK(near(g.positions[5], {10, 22, 31}));
  CHECK(joint_positions(m) == g.positions);
  CHECK(joint_rotations(m) == g.rotations);
  CHECK(near(rotate(g.rotations[5], {1, 0, 0}), {0, 0, 1}));
  CHECK(end_site_joints(m.skeleton) == std::vector<std::size_t>{2});
  const std::vector<Vec3> ends = end_site_positions(m, g);
  REQUIRE(ends.size() == 2);
  CHECK(near(ends[0], {3.5, 0, 0}));
  CHECK(near(ends[1], {10, 22, 31.5}));
  CHECK(bone_lengths(m.skeleton) == std::vector<double>{0, 2, 1});
}

TEST_CASE("a motion with inconsistent arrays is rejected") {
  Motion m = arm(2);
  m.rotations.pop_back();
  CHECK_THROWS_WITH_AS(forward_kinematics(m),
                       doctest::Contains("has 5 rotations and 6 positions; expected 6"), Error);
  m = arm(1);
  m.skeleton.joints[1].parent = 2;
  CHECK_THROWS_WITH_AS(forward_kinematics(m), doctest::Contains("joint 1 (Elbow) has parent 2"), Error);
  m = arm(1);
  m.rate = 0;
  CHECK_THROWS_WITH_AS(forward_kinematics(m), doctest::Contains("rate is 0"), Error);
}

}  // namespace kinematics_test
