// Rotations of a body as yaw and tilt: which way it faces, and how it leans.
#pragma once
#include <cmath>

#include "motiongan/motion/rotation.hpp"

namespace motiongan::motion {

/// q = yaw * tilt as (tilt x, yaw, tilt z), radians: the yaw turns about y, the tilt is an exponential map
/// without y. Upside down (a tilt of pi) the yaw is arbitrary; 0 is taken.
inline Vec3 heading_from_quat(const Quat& q) {
  const double norm = std::hypot(q.w, q.y);
  const Quat yaw = norm < 1e-12 ? Quat{} : Quat{q.w / norm, 0, q.y / norm, 0};
  const Vec3 tilt = expmap_from_quat(multiply(inverse(yaw), q));
  const double angle = 2 * std::atan2(yaw.y, yaw.w);
  return {tilt[0], angle > pi ? angle - 2 * pi : angle <= -pi ? angle + 2 * pi : angle, tilt[2]};
}

inline Quat quat_from_heading(const Vec3& heading) {
  return multiply(axis_rotation(1, heading[1]), quat_from_expmap({heading[0], 0, heading[2]}));
}

/// The same rotation with the yaw within half a turn of the frame before and the tilt unwrapped.
inline Vec3 unwrap_heading(const Vec3& heading, const Vec3& previous) {
  const Vec3 tilt = unwrap_expmap({heading[0], 0, heading[2]}, {previous[0], 0, previous[2]});
  return {tilt[0], unwrap_angle(heading[1], previous[1]), tilt[2]};
}

}  // namespace motiongan::motion
