// The joint that carries a body: in chains, beside helper bones and props, and folding into it.
#include "motiongan/motion/root_joint.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "../support/arm.hpp"
#include "../support/bodies.hpp"

namespace root_joint_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("the travelling joint is found, and the joints above it are folded into it") {
  // A resting world joint, rotated and displaced, above the arm.
  Motion m = arm(3);
  m.skeleton.joints.insert(m.skeleton.joints.begin(), {"World", -1, {1, 0, 0}, six, {}});
  for (std::size_t j = 1; j < 4; ++j) m.skeleton.joints[j].parent = static_cast<int>(j) - 1;
  m.rotations.assign(12, Quat{});
  m.positions.clear();
  for (std::size_t f = 0; f < 3; ++f)
    for (const Joint& j : m.skeleton.joints) m.positions.push_back(j.offset);
  CHECK(moving_root(m) == 0);  // nothing travels
  for (std::size_t f = 0; f < 3; ++f) {
    m.rotation(f, 0) = quat_from_expmap({0, pi / 2, 0});
    m.position(f, 1) = {static_cast<double>(f), 1, 0};
    m.rotation(f, 1) = quat_from_expmap({0.1 * static_cast<double>(f), 0.2, 0.3});
  }
  CHECK(moving_root(m) == 1);
  const Motion folded = fold_into_root(m, 1);
  REQUIRE(folded.skeleton.size() == 3);
  CHECK(folded.skeleton.joints[0].name == "Shoulder");
  CHECK(folded.skeleton.joints[0].parent == -1);
  CHECK(folded.skeleton.joints[2].parent == 1);
  CHECK(folded.skeleton.joints[0].offset == Vec3{1, 0, 0});
  const GlobalPose before = forward_kinematics(m), after = forward_kinematics(folded);
  for (std::size_t f = 0; f < 3; ++f)
    for (std::size_t j = 0; j < 3; ++j) {
      CHECK(near(after.positions[f * 3 + j], before.positions[f * 4 + j + 1]));
      CHECK(angle_between(after.rotations[f * 3 + j], before.rotations[f * 4 + j + 1]) < 1e-14);
    }
  CHECK(moving_root(folded) == 0);
  m.position(1, 0) = {5, 5, 5};
  CHECK(moving_root(m) == 0);  // the world joint itself travels

  // A root without position channels gets them; a branch beside the body is left out.
  m.skeleton.joints[1].channels = {Channel::y_rotation};
  CHECK(fold_into_root(m, 1).skeleton.joints[0].channels == six);
  CHECK(joints_beside(m.skeleton, 1).empty());
  m.skeleton.joints[3].parent = 0;
  CHECK(joints_beside(m.skeleton, 1) == std::vector<std::size_t>{3});
  CHECK(fold_into_root(m, 1).skeleton.size() == 2);
  CHECK_THROWS_AS(fold_into_root(m, 9), Error);
}

TEST_CASE("a root that rotates in place is the root") {
  Motion m = arm(3);
  for (std::size_t f = 0; f < 3; ++f)
    m.rotation(f, 0) = quat_from_expmap({0, 0.5 * static_cast<double>(f), 0});
  CHECK(moving_root(m) == 0);
}

namespace {

/// The body below a resting `root`, with other joints beside it; joints after it keep their order.
Motion below_root(const std::vector<Joint>& beside, std::size_t frames = 20) {
  const Motion body = standing_body(frames);
  Motion m;
  m.rate = body.rate;
  m.frames = frames;
  m.skeleton.joints.push_back({"root", -1, {}, six, {}});
  for (Joint joint : body.skeleton.joints) {
    ++joint.parent;
    m.skeleton.joints.push_back(joint);
  }
  const int first = static_cast<int>(m.skeleton.size());
  for (Joint joint : beside) {
    if (joint.parent != 0) joint.parent += first - 1;
    m.skeleton.joints.push_back(joint);
  }
  for (std::size_t f = 0; f < frames; ++f)
    for (std::size_t j = 0; j < m.skeleton.size(); ++j) {
      const bool of_body = j > 0 && j <= body.skeleton.size();
      m.rotations.push_back(of_body ? body.rotation(f, j - 1) : Quat{});
      m.positions.push_back(of_body ? body.position(f, j - 1) : m.skeleton.joints[j].offset);
    }
  return m;
}

}  // namespace

TEST_CASE("the body is found beside helper bones and props") {
  // As Unreal exports: inverse-kinematics targets beside the pelvis, named like feet.
  const Motion unreal = below_root({{"ik_foot_root", 0, {}, three, {}},
                                    {"ik_foot_l", 1, {10, 0, 0}, three, {}},
                                    {"ik_foot_r", 1, {-10, 0, 0}, three, {}}});
  CHECK(moving_root(unreal) == 1);
  CHECK(joints_beside(unreal.skeleton, 1) == std::vector<std::size_t>{16, 17, 18});
  const Motion folded = fold_into_root(unreal, 1);
  CHECK(folded.skeleton == standing_body(1).skeleton);
  CHECK(joint_positions(folded) == joint_positions(standing_body(20)));

  // A long prop beside the hips: what hangs above the feet counts, not length.
  CHECK(moving_root(below_root({{"Sword", 0, {300, 0, 0}, three, Vec3{0, 500, 0}}})) == 1);

  // Without names, the branch with three quarters of the bones.
  Motion nameless = below_root({{"x", 0, {5, 0, 0}, three, {}}});
  for (std::size_t j = 0; j < nameless.skeleton.size(); ++j)
    nameless.skeleton.joints[j].name = "j" + std::to_string(j);
  CHECK(moving_root(nameless) == 1);

  // Where the body itself branches, a moving limb is not the root.
  Motion still = standing_body(20, 0);
  for (std::size_t f = 0; f < still.frames; ++f) still.position(f, 7)[1] += 0.1 * static_cast<double>(f);
  CHECK(moving_root(still) == 0);
}

TEST_CASE("a root below turned joints is expressed in the world") {
  // The file's data are z up, turned by its top joint; the pelvis travels in that joint's frame.
  Motion m = below_root({});
  const std::vector<Vec3> before = [&] {
    for (std::size_t f = 0; f < m.frames; ++f) {
      m.rotation(f, 0) = axis_rotation(0, -pi / 2);
      m.rotation(f, 1) = multiply(axis_rotation(0, pi / 2), m.rotation(f, 1));
      const Vec3 p = m.position(f, 1);
      m.position(f, 1) = {p[0], -p[2], p[1]};
    }
    return joint_positions(m);
  }();
  const Motion world = with_world_root(m, moving_root(m));
  for (std::size_t f = 0; f < m.frames; ++f) {
    CHECK(angle_between(world.rotation(f, 0), Quat{}) < 1e-14);
    CHECK(world.position(f, 1)[1] == doctest::Approx(95).epsilon(1e-12));  // the height is y again
  }
  const std::vector<Vec3> after = joint_positions(world);
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(length(subtract(after[i], before[i])) < 1e-9);
  // Unturned joints above change nothing, bit for bit.
  const Motion plain = below_root({});
  CHECK(with_world_root(plain, 1).positions == plain.positions);
}

}  // namespace root_joint_test
