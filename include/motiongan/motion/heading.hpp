// Rotations of a body as yaw (heading) and tilt (lean).
#pragma once
#include <cmath>

#include "motiongan/motion/rotation.hpp"

namespace motiongan::motion {

/// Decomposes q = yaw * tilt and returns (tilt x, yaw, tilt z) in radians: the yaw is about y, the tilt is an
/// exponential map without y. At a tilt of pi (upside down) the yaw is undefined and set to 0.
inline Vec3 heading_from_quat(const Quat& q) {
  const double norm = std::hypot(q.w, q.y);
  const Quat yaw = norm < 1e-12 ? Quat{} : Quat{q.w / norm, 0, q.y / norm, 0};
  const Vec3 tilt = expmap_from_quat(multiply(inverse(yaw), q));
  const double angle = 2 * std::atan2(yaw.y, yaw.w);
  return {tilt[0], angle > pi ? angle - 2 * pi : angle <= -pi ? angle + 2 * pi : angle, tilt[2]};
}

/// Inverse of heading_from_quat.
inline Quat quat_from_heading(const Vec3& heading) {
  return multiply(axis_rotation(1, heading[1]), quat_from_expmap({heading[0], 0, heading[2]}));
}

/// The same rotation with the yaw within half a turn of `previous` and the tilt unwrapped.
inline Vec3 unwrap_heading(const Vec3& heading, const Vec3& previous) {
  const Vec3 tilt = unwrap_expmap({heading[0], 0, heading[2]}, {previous[0], 0, previous[2]});
  return {tilt[0], unwrap_angle(heading[1], previous[1]), tilt[2]};
}

}  // namespace motiongan::motion
