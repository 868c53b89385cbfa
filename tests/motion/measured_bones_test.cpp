// Bones held in position channels instead of OFFSETs.
#include "motiongan/motion/measured_bones.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "../support/bodies.hpp"

namespace measured_bones_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// The body with position channels in every joint and OFFSETs of zero.
Motion without_offsets(std::size_t frames) {
  Motion m = standing_body(frames);
  for (Joint& joint : m.skeleton.joints) {
    joint.offset = {};
    if (joint.channels.size() < 6)
      joint.channels.insert(joint.channels.begin(),
                            {Channel::x_position, Channel::y_position, Channel::z_position});
  }
  return m;
}

}  // namespace

TEST_CASE("bones in position channels become offsets") {
  Motion m = without_offsets(50);
  const MeasuredBones bones = measure_bones(m);
  CHECK(bones.measured.size() == 14);  // all but the hips, which travel
  CHECK(bones.spread == 0);
  CHECK(bones.median == doctest::Approx(std::hypot(18.0, 30.0)));
  CHECK(bones.stretching.empty());
  const Skeleton expected = body_skeleton();
  for (std::size_t j = 1; j < expected.size(); ++j)
    CHECK(m.skeleton.joints[j].offset == expected.joints[j].offset);
  CHECK(m.skeleton.joints[0].offset == Vec3{});
  CHECK(measure_bones(m).measured.empty());  // and stay so
}

TEST_CASE("offsets that are right are kept, and stretching bones are reported") {
  Motion m = without_offsets(51);
  m.skeleton = body_skeleton();
  m.skeleton.joints[2].channels.insert(m.skeleton.joints[2].channels.begin(), Channel::y_position);
  m.skeleton.joints[5].channels.insert(m.skeleton.joints[5].channels.begin(), Channel::y_position);
  for (std::size_t f = 0; f < m.frames; ++f) {
    m.position(f, 2)[1] *= f % 10 == 0 ? 1.2 : 1;
    m.position(f, 5)[1] *= f % 10 == 0 ? 1.04 : 1;
  }
  const MeasuredBones bones = measure_bones(m);
  CHECK(bones.measured.empty());
  CHECK(m.skeleton.joints[2].offset == body_skeleton().joints[2].offset);
  REQUIRE(bones.stretching.size() == 1);  // 4 % is not reported
  CHECK(bones.stretching[0].joint == 2);
  CHECK(bones.stretching[0].stretch == doctest::Approx(0.2));
}

TEST_CASE("channels that are displacements from the offsets") {
  Motion m = standing_body(30);
  const std::vector<Vec3> expected = joint_positions(m);
  for (std::size_t j = 1; j < m.skeleton.size(); ++j) {
    std::vector<Channel>& channels = m.skeleton.joints[j].channels;
    channels.insert(channels.begin(), {Channel::x_position, Channel::y_position, Channel::z_position});
    for (std::size_t f = 0; f < m.frames; ++f) m.position(f, j) = {1e-6, 0, 0};
  }
  const MeasuredBones bones = measure_bones(m);
  CHECK(bones.displaced.size() == 14);
  CHECK(bones.measured.empty());
  for (std::size_t j = 0; j < m.skeleton.size(); ++j)
    CHECK(m.skeleton.joints[j].offset == body_skeleton().joints[j].offset);
  const std::vector<Vec3> found = joint_positions(m);
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(length(subtract(found[i], expected[i])) < 1e-4);
}

TEST_CASE("a chain of joints is measured below the one that travels") {
  Motion m;
  const std::vector<Channel> six{Channel::x_position, Channel::y_position, Channel::z_position,
                                 Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
  m.skeleton.joints = {{"World", -1, {}, six, {}}, {"Hips", 0, {}, six, {}}, {"Neck", 1, {}, six, {}}};
  m.rate = 30, m.frames = 3;
  for (std::size_t f = 0; f < 3; ++f) {
    m.rotations.resize(m.rotations.size() + 3);
    m.positions.insert(m.positions.end(), {{0, 0, 0}, {static_cast<double>(f), 90, 0}, {0, 40, 0}});
  }
  const MeasuredBones bones = measure_bones(m);
  CHECK(bones.measured == std::vector<std::size_t>{2});
  CHECK(m.skeleton.joints[2].offset == Vec3{0, 40, 0});
  CHECK(m.skeleton.joints[1].offset == Vec3{});
}

}  // namespace measured_bones_test
