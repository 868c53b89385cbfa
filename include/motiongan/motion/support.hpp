// What bears the body: its lowest joints.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
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

/// How much of the body each joint bears, [joints], by its height: exp(-height / softness), scaled so that
/// the sum is 1. The lowest joint has most, and joints higher by a few softnesses nothing.
inline std::vector<double> support_weights(std::span<const double> heights, double softness) {
  const double lowest = *std::min_element(heights.begin(), heights.end());
  std::vector<double> out;
  double sum = 0;
  for (const double height : heights) sum += out.emplace_back(std::exp((lowest - height) / softness));
  for (double& weight : out) weight /= sum;
  return out;
}

/// Height of the support, the mean of the joints by support_weights(), relative to the root.
inline double support_height(std::span<const Vec3> joints, double softness) {
  std::vector<double> heights;
  for (const Vec3& p : joints) heights.push_back(p[1]);
  const std::vector<double> weights = support_weights(heights, softness);
  return std::inner_product(weights.begin(), weights.end(), heights.begin(), 0.0);
}

/// A step over the ground, (x, z) in the heading of the first of two frames.
struct GroundStep {
  double x = 0, z = 0;
};

/// How much further the support steps between two frames than the root: the mean over the joints by their
/// support_weights(), of their mean heights in both frames. A foot that stands through both frames has a
/// weight near 1. `turn` is the change of yaw, in radians.
inline GroundStep support_offset(std::span<const Vec3> before, std::span<const Vec3> now, double turn,
                                 double softness) {
  std::vector<double> heights;
  for (std::size_t j = 0; j < now.size(); ++j) heights.push_back((before[j][1] + now[j][1]) / 2);
  const std::vector<double> weights = support_weights(heights, softness);
  GroundStep out;
  for (std::size_t j = 0; j < now.size(); ++j) {
    double x = now[j][0], z = now[j][2];
    turn_ground(x, z, turn);
    out.x += weights[j] * (x - before[j][0]);
    out.z += weights[j] * (z - before[j][2]);
  }
  return out;
}

}  // namespace motiongan::motion
