// Angles between bones, by hand.
#include "motiongan/metrics/joint_angle.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "motiongan/procedural/procedural.hpp"

namespace joint_angle_test {

using namespace motiongan;
using motion::Vec3;

namespace {

motion::Skeleton skeleton(const std::vector<int>& parents, const std::vector<Vec3>& offsets) {
  motion::Skeleton s;
  for (std::size_t j = 0; j < parents.size(); ++j)
    s.joints.push_back({"J" + std::to_string(j), parents[j], offsets[j], {}, {}});
  return s;
}

}  // namespace

TEST_CASE("a straight arm is 0, a right angle 90, folded back 180") {
  const motion::Skeleton arm = skeleton({-1, 0, 1}, {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}});
  const std::vector<Vec3> positions{{1, 1, 1}, {3, 1, 1}, {4, 1, 1},   // straight
                                    {1, 1, 1}, {3, 1, 1}, {3, 1, 7},   // right angle, another length
                                    {0, 0, 0}, {0, 2, 0}, {0, 1, 0},   // folded back
                                    {0, 0, 0}, {0, 2, 0}, {0, 2, 0}};  // no second bone
  const std::vector<double> angles = mean_joint_angle(arm, positions);
  REQUIRE(angles.size() == 4);
  CHECK(angles[0] == 0);
  CHECK(angles[1] == doctest::Approx(90));
  CHECK(angles[2] == doctest::Approx(180));
  CHECK(angles[3] == 0);
  // A millionth of a degree is preserved; an arc cosine would lose it.
  const double tiny = motion::radians(1e-6);
  CHECK(mean_joint_angle(
            arm, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1 + std::cos(tiny), std::sin(tiny), 0}})[0] ==
        doctest::Approx(1e-6));
}

TEST_CASE("bones of zero rest length are skipped, several bones are averaged") {
  // 0 -> 1 -> 2 with 2 at the position of 1, then 2 -> 3; 1 -> 4 is straight.
  const motion::Skeleton s =
      skeleton({-1, 0, 1, 2, 1}, {{0, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const std::vector<BonePair> pairs = adjacent_bones(s);
  REQUIRE(pairs.size() == 2);
  CHECK((pairs[0].in == 1 && pairs[0].out == 3));
  CHECK((pairs[1].in == 1 && pairs[1].out == 4));
  const std::vector<Vec3> pose{{0, 0, 0}, {0, 1, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}};
  CHECK(mean_joint_angle(s, pose)[0] == doctest::Approx(45));
}

TEST_CASE("rotating and translating the body changes no angle") {
  const motion::LabelledMotion l = motion::procedural_motion(1, {.seconds = 1});
  std::vector<Vec3> positions = motion::joint_positions(l.motion);
  const std::vector<double> before = mean_joint_angle(l.motion.skeleton, positions);
  const motion::Quat turn = motion::quat_from_expmap({0.3, 2, -1});
  for (Vec3& p : positions) p = motion::scale(motion::add(motion::rotate(turn, p), {100, 20, -3}), 0.01);
  const std::vector<double> after = mean_joint_angle(l.motion.skeleton, positions);
  REQUIRE(before.size() == l.motion.frames);
  for (std::size_t f = 0; f < before.size(); ++f) CHECK(after[f] == doctest::Approx(before[f]).epsilon(1e-9));
  CHECK(before[0] > 5);
}

TEST_CASE("input without angles is rejected") {
  CHECK_THROWS_AS(mean_joint_angle(skeleton({-1, 0}, {{0, 0, 0}, {1, 0, 0}}), std::vector<Vec3>(2)), Error);
  CHECK_THROWS_AS(mean_joint_angle({}, {}), Error);
  const motion::Skeleton arm = skeleton({-1, 0, 1}, {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}});
  CHECK_THROWS_AS(mean_joint_angle(arm, std::vector<Vec3>(4)), Error);
  CHECK(mean_joint_angle(arm, {}).empty());
}

}  // namespace joint_angle_test
