// The skeleton of procedural motion: 22 joints, 1.74 m tall, in centimetres, y up, facing +z with the left
// side at +x, in a T-pose at rest.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace procedural {

/// Joint indices; of a pair, the left one comes first and the right one `..._stride` later.
inline constexpr std::size_t hips = 0, up_leg = 1, lower_leg = 2, foot = 3, toe = 4, leg_stride = 4;
inline constexpr std::size_t spine = 9, neck = 12, head = 13, shoulder = 14, arm = 15, fore_arm = 16,
                             hand = 17;
inline constexpr std::size_t arm_stride = 4;

/// Lengths in centimetres.
inline constexpr double thigh_length = 43, shin_length = 41.5, ankle_height = 8, hip_drop = 5;
inline constexpr double hip_half_width = 9.5, upper_arm_length = 28, fore_arm_length = 25;
/// The ball of the foot (the toe joint) and the heel, relative to the ankle.
inline constexpr Vec3 ball_offset{0, -6.5, 13}, heel_offset{0, -ankle_height, -5};
inline constexpr Vec3 toe_tip_offset{0, -1.5, 7};

}  // namespace procedural

/// The skeleton of procedural_motions(): 22 joints in centimetres, root with six channels, ZXY rotations.
inline Skeleton procedural_skeleton() {
  using namespace procedural;
  Skeleton s;
  const auto joint = [&s](const char* name, int parent, Vec3 offset) {
    Joint j;
    j.name = name;
    j.parent = parent;
    j.offset = offset;
    if (parent < 0) j.channels = {Channel::x_position, Channel::y_position, Channel::z_position};
    j.channels.insert(j.channels.end(), {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation});
    s.joints.push_back(j);
    return static_cast<int>(s.joints.size() - 1);
  };
  const int root = joint("Hips", -1, {0, hip_drop + thigh_length + shin_length + ankle_height, 0});
  for (const double side : {1.0, -1.0}) {
    const bool left = side > 0;
    int at = joint(left ? "LeftUpLeg" : "RightUpLeg", root, {side * hip_half_width, -hip_drop, 0});
    at = joint(left ? "LeftLeg" : "RightLeg", at, {0, -thigh_length, 0});
    at = joint(left ? "LeftFoot" : "RightFoot", at, {0, -shin_length, 0});
    joint(left ? "LeftToeBase" : "RightToeBase", at, ball_offset);
    s.joints.back().end_site = toe_tip_offset;
  }
  int at = joint("Spine", root, {0, 8, 0});
  at = joint("Spine1", at, {0, 12, 0});
  const int chest = at = joint("Spine2", at, {0, 13, 0});
  at = joint("Neck", chest, {0, 15.5, 0});
  joint("Head", at, {0, 9, 1.5});
  s.joints.back().end_site = Vec3{0, 18, 1};
  for (const double side : {1.0, -1.0}) {
    const bool left = side > 0;
    at = joint(left ? "LeftShoulder" : "RightShoulder", chest, {side * 3.5, 11, 0});
    at = joint(left ? "LeftArm" : "RightArm", at, {side * 14, 0, 0});
    at = joint(left ? "LeftForeArm" : "RightForeArm", at, {side * upper_arm_length, 0, 0});
    joint(left ? "LeftHand" : "RightHand", at, {side * fore_arm_length, 0, 0});
    s.joints.back().end_site = Vec3{side * 17, 0, 0};
  }
  return s;
}

/// The points of the feet that can touch the ground: heel, ball and toe tip of the left foot, then of the
/// right one, in world coordinates, [6].
inline std::array<Vec3, 6> foot_contacts(const GlobalPose& global, std::size_t frame, std::size_t joints) {
  using namespace procedural;
  std::array<Vec3, 6> out{};
  for (std::size_t side = 0; side < 2; ++side) {
    const std::size_t ankle = frame * joints + foot + side * leg_stride;
    const std::size_t ball = frame * joints + toe + side * leg_stride;
    out[3 * side] = add(global.positions[ankle], rotate(global.rotations[ankle], heel_offset));
    out[3 * side + 1] = global.positions[ball];
    out[3 * side + 1][1] -= ankle_height + ball_offset[1];  // the sole under the ball
    out[3 * side + 2] = add(global.positions[ball], rotate(global.rotations[ball], toe_tip_offset));
  }
  return out;
}

}  // namespace motiongan::motion
