// The last correction: constraints are met exactly, smoothly, and only near where they are.
#include "motiongan/direct/exact.hpp"

#include <doctest/doctest.h>

#include "motiongan/metrics/jerk.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace exact_test {

using namespace motiongan;
using motion::Motion;
using motion::Vec3;

namespace {

const Motion& walk() {
  static const Motion made = [] {
    Motion m = motion::procedural_motions({.clips = 1}).front().motion;
    return motion::resample(slice(m, 0, std::min<std::size_t>(m.frames, 200)), 25);
  }();
  return made;
}

std::size_t named(const char* name) {
  const int j = walk().skeleton.find(name);
  REQUIRE(j >= 0);
  return static_cast<std::size_t>(j);
}

double worst(const Motion& motion, const Constraint& c) {
  const ConstraintError e = constraint_errors(motion, 0, {c}).front();
  return std::max(e.worst / motion::body_unit(motion.skeleton), e.angle);
}

/// The largest distance of a joint between two motions in a frame.
double apart(const Motion& a, const Motion& b, std::size_t frame) {
  const WorldPose p = world_pose(a, frame, 0), q = world_pose(b, frame, 0);
  double most = 0;
  for (std::size_t j = 0; j < p.body.size(); ++j)
    most = std::max(most, motion::length(motion::subtract(p.joint(j), q.joint(j))));
  return most;
}

}  // namespace

TEST_CASE("every kind of constraint is met, and frames far from it stay") {
  const Motion& from = walk();
  REQUIRE(from.frames > 40);
  const double leg = motion::body_unit(from.skeleton);
  const std::size_t hand = named("LeftHand"), elbow = named("LeftForeArm");
  const auto moved = [&](std::size_t joint, std::size_t f, const Vec3& by) {
    return motion::add(world_pose(from, f, 0).joint(joint), motion::scale(by, leg));
  };
  Motion pose = slice(from, 3, 1);
  pose.position(0, 0) = motion::add(from.position(20, 0), {0.1 * leg, 0.05 * leg, -0.1 * leg});
  const WorldPose at = world_pose(from, 20, 0);
  const std::vector<std::pair<Constraint, double>> cases = {
      {PoseConstraint{.time = 0.8, .pose = pose, .placed = true}, 1e-9},
      {PoseConstraint{.time = 0.8, .pose = pose}, 1e-9},
      {PoseConstraint{.time = 0.8, .pose = slice(from, 17, 1), .joints = {hand}}, 1e-4},
      {JointConstraint{.joint = hand, .from = 0.8, .to = 0.8, .position = moved(hand, 20, {0.1, 0.1, 0.1})},
       1e-4},
      {JointConstraint{.joint = hand, .from = 0.8, .to = 0.8, .position = moved(hand, 20, {2, 1, 0})}, 1e-4},
      {JointConstraint{.joint = elbow, .from = 0.8, .to = 0.88, .rotation = motion::axis_rotation(0, 0.5)},
       1e-7},
      {PathConstraint{.points = {{at.x - leg, at.z, 0.4}, {at.x, at.z + 0.1 * leg, 0.8}}}, 0.6},
      {LoopConstraint{.seconds = 0.8}, 1e-9},
      {ContactConstraint{.joint = named("RightToeBase"), .from = 0.72, .to = 0.88}, 1e-4}};
  for (const auto& [constraint, tolerance] : cases) {
    CAPTURE(constraint.index());
    CHECK(worst(from, constraint) > 1e-3);
    const Motion made = meet_exactly(from, 0, {constraint});
    CHECK(worst(made, constraint) < tolerance);
    CHECK(made.frames == from.frames);
    CHECK(apart(made, from, from.frames - 1) < 1e-9);
    // The bones keep their lengths.
    for (std::size_t f = 0; f < made.frames; ++f)
      for (std::size_t j = 1; j < made.skeleton.size(); ++j)
        REQUIRE(made.position(f, j) == from.position(f, j));
  }
}

TEST_CASE("the root passes through the points of a path, in order") {
  const Motion& from = walk();
  std::vector<PathPoint> points;
  for (const std::size_t f : {0u, 15u, 30u}) {
    const WorldPose p = world_pose(from, f, 0);
    points.push_back({p.x + 1, p.z - 2, static_cast<double>(f) / 25});
  }
  const Motion made = meet_exactly(from, 0, {PathConstraint{.points = points}});
  for (const std::size_t i : {0u, 1u, 2u}) {
    const WorldPose p = world_pose(made, 15 * i, 0);
    CHECK(std::hypot(p.x - points[i].x, p.z - points[i].z) < 1e-9);
  }
  CHECK(mean_jerk(made) < 1.2 * mean_jerk(from));
}

TEST_CASE("a correction comes and goes smoothly") {
  detail::SmoothOffsets offsets;
  CHECK(offsets.at(5, 10)[0] == 0);
  offsets.set(20, {1, 0, 0});
  CHECK(offsets.at(20, 10)[0] == 1);
  CHECK(offsets.at(25, 10)[0] == doctest::Approx(0.5));
  CHECK(offsets.at(15, 10)[0] == doctest::Approx(0.5));
  CHECK(offsets.at(30, 10)[0] == doctest::Approx(0));
  CHECK(offsets.at(0, 10)[0] == 0);
  offsets.set(24, {3, 0, 0});  // near: one changes into the other
  CHECK(offsets.at(22, 10)[0] == doctest::Approx(2));
}

}  // namespace exact_test
