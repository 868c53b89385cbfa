// The joint that bears the body: the lowest one over two frames.
#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Positions relative to `root` of one frame's joints, [joints], in the root's heading: as if its yaw were 0.
/// `rotations` and `positions` are the frame's local ones, [joints]. Joints that do not hang on the root are
/// given its own place.
inline std::vector<Vec3> joints_about_root(const Skeleton& skeleton, std::size_t root,
                                           std::span<const Quat> rotations, std::span<const Vec3> positions) {
  const Vec3 heading = heading_from_quat(rotations[root]);
  std::vector<Vec3> out(skeleton.size(), Vec3{});
  std::vector<Quat> global(skeleton.size());
  std::vector<bool> hangs(skeleton.size(), false);
  hangs[root] = true;
  global[root] = quat_from_expmap({heading[0], 0, heading[2]});
  for (std::size_t j = root + 1; j < skeleton.size(); ++j) {
    const auto p = static_cast<std::size_t>(skeleton.joints[j].parent);
    if (!hangs[p]) continue;
    hangs[j] = true;
    out[j] = add(out[p], rotate(global[p], positions[j]));
    global[j] = multiply(global[p], rotations[j]);
  }
  return out;
}

/// Height of the lowest joint relative to the root, at most 0.
inline double lowest_joint(std::span<const Vec3> joints) {
  double low = 0;
  for (const Vec3& p : joints) low = std::min(low, p[1]);
  return low;
}

/// The joint that is lowest over two frames, by the sum of its heights in both. If a foot stands through both
/// frames, it is that foot.
inline std::size_t support_joint(std::span<const Vec3> before, std::span<const Vec3> now) {
  std::size_t lowest = 0;
  for (std::size_t j = 1; j < now.size(); ++j)
    if (before[j][1] + now[j][1] < before[lowest][1] + now[lowest][1]) lowest = j;
  return lowest;
}

/// How far the support has gone over the ground less how far the root has, (x, z) in the heading of the first
/// of two frames; `turn` is the change of yaw between them, in radians.
struct GroundStep {
  double x = 0, z = 0;
};
inline GroundStep support_offset(std::span<const Vec3> before, std::span<const Vec3> now, double turn) {
  const std::size_t j = support_joint(before, now);
  GroundStep out{now[j][0], now[j][2]};
  turn_ground(out.x, out.z, turn);
  return {out.x - before[j][0], out.z - before[j][2]};
}

}  // namespace motiongan::motion
