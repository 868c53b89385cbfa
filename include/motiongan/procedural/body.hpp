// Body targets (path of the pelvis, placement of the feet, angles of trunk and arms) converted to joint
// rotations. Legs are solved by inverse kinematics, so planted feet stay where they are.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "motiongan/procedural/curve.hpp"
#include "motiongan/procedural/skeleton.hpp"

namespace motiongan::motion::procedural {

/// Angles in degrees, lengths in centimetres. Left is index 0 and +x, right is index 1 and -x.
struct FootTarget {
  double x = 0, z = 0;   ///< the ground below the ankle of the flat foot
  double lift = 0;       ///< of the whole foot
  double yaw = 0;        ///< 0 points to +z, positive to the left
  double heel_rise = 0;  ///< rotation about the ball
  double toe_rise = 0;   ///< rotation about the heel
  double toe_bend = 0;   ///< at the toe joint; equal to heel_rise while the toes stand on the ground
};

struct ArmTarget {
  double flexion = 0;    ///< forward and up from hanging
  double abduction = 0;  ///< outward and up from hanging
  double twist = 0;      ///< external rotation of the upper arm
  double elbow = 0;
  double wrist_side = 0, wrist_flexion = 0;
  bool reach = false;  ///< put the wrist at `wrist` with the hand along `point`, ignoring the angles above
  Vec3 wrist{};        ///< in the frame of the chest (Spine2)
  Vec3 point{};
};

struct BodyTarget {
  double x = 0, z = 0;
  double height = 96.5;                          ///< of the root; lowered if a leg would not reach its foot
  double yaw = 0, pitch = 0, roll = 0;           ///< of the pelvis; to the left, forward, to the right
  double bend = 0, side_bend = 0, twist = 0;     ///< of the spine over the pelvis; forward, right, left
  double nod = 0, head_tilt = 0, head_turn = 0;  ///< of the head over the chest; down, right, left
  std::array<FootTarget, 2> feet{};
  std::array<ArmTarget, 2> arms{};
};

/// Longest distance from hip to ankle. Real knees are never quite straight either, and the derivative of the
/// knee angle is infinite at full extension.
inline constexpr double leg_reach = 0.992 * (thigh_length + shin_length);

inline Quat turn_x(double angle) { return axis_rotation(0, radians(angle)); }
inline Quat turn_y(double angle) { return axis_rotation(1, radians(angle)); }
inline Quat turn_z(double angle) { return axis_rotation(2, radians(angle)); }

inline Vec3 unit(const Vec3& v) { return scale(v, 1 / length(v)); }

/// Rotation of the upper bone, and bend of the middle joint about its hinge in radians.
struct TwoBones {
  Quat upper;
  double bend = 0;
};

/// Two-bone inverse kinematics: puts the end of a limb of lengths a and b at `target`, relative to its root.
/// At rest the limb lies along `along` and bends about `hinge` (perpendicular to it); the hinge points
/// towards `hint` as far as it can.
inline TwoBones two_bones(double a, double b, const Vec3& target, const Vec3& along, const Vec3& hinge,
                          const Vec3& hint) {
  const double full = a + b, d = std::clamp(length(target), 0.25 * full, 0.9995 * full);
  const Vec3 direction = unit(target);
  const Vec3 axis = unit(subtract(hint, scale(direction, dot(hint, direction))));
  const double at_root = std::acos((a * a + d * d - b * b) / (2 * a * d));
  const double at_middle = std::acos((a * a + b * b - d * d) / (2 * a * b));
  const Vec3 upper =
      subtract(scale(direction, std::cos(at_root)), scale(cross(axis, direction), std::sin(at_root)));
  const Vec3 third = cross(upper, axis), rest_third = cross(along, hinge);
  Mat3 m{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      m[3 * i + j] = upper[i] * along[j] + axis[i] * hinge[j] + third[i] * rest_third[j];
  return {quat_from_matrix(m), pi - at_middle};
}

/// The shortest rotation from one unit vector to another.
inline Quat shortest_arc(const Vec3& from, const Vec3& to) {
  const Vec3 c = cross(from, to);
  return normalize({1 + dot(from, to), c[0], c[1], c[2]});
}

/// Position of the ankle for a foot target.
inline Vec3 ankle_position(const FootTarget& f) {
  const auto rolled = [](const Vec3& pivot, double angle) {
    return add(pivot, rotate(turn_x(angle), scale(pivot, -1)));
  };
  Vec3 p = add(rolled(ball_offset, f.heel_rise), rolled(heel_offset, -f.toe_rise));
  p = rotate(turn_y(f.yaw), p);
  return {f.x + p[0], ankle_height + f.lift + p[1], f.z + p[2]};
}

inline void pose_leg(const BodyTarget& body, std::size_t side, const Vec3& root, const Quat& pelvis,
                     Quat* joints) {
  const FootTarget& f = body.feet[side];
  const double sign = side == 0 ? 1 : -1;
  const Vec3 hip = add(root, rotate(pelvis, {sign * hip_half_width, -hip_drop, 0}));
  const Vec3 to_ankle = rotate(inverse(pelvis), subtract(ankle_position(f), hip));
  // The knee points between the directions of the pelvis and of the foot.
  const double out = radians(0.6 * (f.yaw - body.yaw));
  const TwoBones leg = two_bones(thigh_length, shin_length, to_ankle, {0, -1, 0}, {1, 0, 0},
                                 {std::cos(out), 0, -std::sin(out)});
  const std::size_t at = up_leg + side * leg_stride;
  joints[at] = leg.upper;
  joints[at + 1] = axis_rotation(0, leg.bend);
  const Quat shin = multiply(multiply(pelvis, leg.upper), joints[at + 1]);
  const Quat sole = multiply(turn_y(f.yaw), turn_x(f.heel_rise - f.toe_rise));
  joints[at + 2] = multiply(inverse(shin), sole);
  joints[at + 3] = turn_x(-f.toe_bend);
}

inline void pose_arm(const ArmTarget& a, std::size_t side, Quat* joints) {
  const double sign = side == 0 ? 1 : -1;
  const Vec3 along{sign, 0, 0};
  Quat upper = multiply(multiply(turn_x(-a.flexion), turn_z(sign * (a.abduction - 90))), turn_x(-a.twist));
  // The shoulder girdle rises with the arm.
  const double raised = a.reach ? 0.3 : (1 + rotate(upper, along)[1]) / 2;
  const Quat girdle = turn_z(sign * 16 * raised);
  Quat elbow = turn_y(-sign * a.elbow);
  Quat wrist = multiply(turn_y(-sign * a.wrist_side), turn_z(-sign * a.wrist_flexion));
  if (a.reach) {
    const Vec3 socket = add({sign * 3.5, 11, 0}, rotate(girdle, {sign * 14, 0, 0}));
    const Vec3 target = subtract(a.wrist, socket);
    const Vec3 pole{0.5 * sign, -1, -0.3};  // where the elbow points
    const TwoBones limb =
        two_bones(upper_arm_length, fore_arm_length, target, along, {0, -sign, 0}, cross(pole, target));
    upper = limb.upper;
    elbow = axis_rotation(1, -sign * limb.bend);
    const Vec3 ahead = rotate(inverse(multiply(upper, elbow)), unit(a.point));
    wrist = shortest_arc(along, ahead);
  }
  const std::size_t at = shoulder + side * arm_stride;
  joints[at] = girdle;
  joints[at + 1] = multiply(inverse(girdle), upper);
  joints[at + 2] = elbow;
  joints[at + 3] = wrist;
}

/// Writes one frame of local rotations to `joints` [22 joints]; returns the root's position.
inline Vec3 pose_body(const BodyTarget& body, Quat* joints) {
  const Quat pelvis = multiply(multiply(turn_y(body.yaw), turn_x(body.pitch)), turn_z(body.roll));
  Vec3 root{body.x, body.height, body.z};
  for (std::size_t side = 0; side < 2; ++side) {
    const Vec3 hip = rotate(pelvis, {(side == 0 ? 1 : -1) * hip_half_width, -hip_drop, 0});
    const Vec3 ankle = ankle_position(body.feet[side]);
    const double dx = ankle[0] - root[0] - hip[0], dz = ankle[2] - root[2] - hip[2];
    const double squared = leg_reach * leg_reach - dx * dx - dz * dz;
    root[1] = soft_min(root[1], ankle[1] - hip[1] + std::sqrt(std::max(squared, 1.0)), 0.8);
  }
  joints[hips] = pelvis;
  const Quat third =
      multiply(multiply(turn_y(body.twist / 3), turn_x(body.bend / 3)), turn_z(body.side_bend / 3));
  for (std::size_t i = 0; i < 3; ++i) joints[spine + i] = third;
  const Quat half =
      multiply(multiply(turn_y(body.head_turn / 2), turn_x(body.nod / 2)), turn_z(body.head_tilt / 2));
  joints[neck] = joints[head] = half;
  for (std::size_t side = 0; side < 2; ++side) {
    pose_leg(body, side, root, pelvis, joints);
    pose_arm(body.arms[side], side, joints);
  }
  return root;
}

}  // namespace motiongan::motion::procedural
