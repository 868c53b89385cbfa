// Forward kinematics and bone lengths.
#pragma once
#include <cstddef>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Joints in world coordinates.
struct GlobalPose {
  std::vector<Vec3> positions;  ///< [frames, joints], in the file's unit
  std::vector<Quat> rotations;  ///< [frames, joints]
};

/// Throws Error unless the array sizes match the skeleton and the number of frames, the rate is positive, and
/// parents come before children.
inline void check_motion(const Motion& motion) {
  const std::size_t joints = motion.skeleton.size();
  const std::size_t n = motion.frames * joints;
  require(motion.rotations.size() == n && motion.positions.size() == n, "a motion of ", motion.frames,
          " frames and ", joints, " joints has ", motion.rotations.size(), " rotations and ",
          motion.positions.size(), " positions; expected ", n, " of each");
  require(motion.rate > 0 || motion.frames == 0, "a motion's rate is ", motion.rate,
          " frames per second; expected a positive number");
  for (std::size_t j = 0; j < joints; ++j)
    require(
        motion.skeleton.joints[j].parent < static_cast<int>(j) && motion.skeleton.joints[j].parent >= -1 &&
            (motion.skeleton.joints[j].parent == -1) == (j == 0),
        "joint ", j, " (", motion.skeleton.joints[j].name, ") has parent ", motion.skeleton.joints[j].parent,
        "; expected -1 for the first joint and an earlier joint for the others");
}

/// Global positions and rotations of all joints in all frames.
inline GlobalPose forward_kinematics(const Motion& motion) {
  check_motion(motion);
  const std::size_t joints = motion.skeleton.size();
  GlobalPose out{motion.positions, motion.rotations};
  for (std::size_t f = 0; f < motion.frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = motion.skeleton.joints[j].parent;
      if (parent < 0) continue;
      const std::size_t p = f * joints + static_cast<std::size_t>(parent), c = f * joints + j;
      out.positions[c] = add(out.positions[p], rotate(out.rotations[p], motion.positions[c]));
      out.rotations[c] = multiply(out.rotations[p], motion.rotations[c]);
    }
  }
  return out;
}

/// Global positions of all joints, [frames, joints].
inline std::vector<Vec3> joint_positions(const Motion& motion) {
  return forward_kinematics(motion).positions;
}

/// Global rotations of all joints, [frames, joints].
inline std::vector<Quat> joint_rotations(const Motion& motion) {
  return forward_kinematics(motion).rotations;
}

/// Indices of the joints that have an end site, in joint order.
inline std::vector<std::size_t> end_site_joints(const Skeleton& skeleton) {
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (skeleton.joints[j].end_site) out.push_back(j);
  return out;
}

/// Global positions of the end sites, [frames, end sites], in the order of end_site_joints.
inline std::vector<Vec3> end_site_positions(const Motion& motion, const GlobalPose& global) {
  const std::vector<std::size_t> ends = end_site_joints(motion.skeleton);
  const std::size_t joints = motion.skeleton.size();
  std::vector<Vec3> out;
  out.reserve(motion.frames * ends.size());
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (const std::size_t j : ends)
      out.push_back(add(global.positions[f * joints + j],
                        rotate(global.rotations[f * joints + j], *motion.skeleton.joints[j].end_site)));
  return out;
}

/// Rest length of the bone from each joint's parent to it, [joints]; 0 for the root.
inline std::vector<double> bone_lengths(const Skeleton& skeleton) {
  std::vector<double> out;
  for (const Joint& j : skeleton.joints) out.push_back(j.parent < 0 ? 0 : length(j.offset));
  return out;
}

/// Joint positions with all rotations zero, [joints].
inline std::vector<Vec3> rest_positions(const Skeleton& skeleton) {
  std::vector<Vec3> out;
  for (const Joint& j : skeleton.joints)
    out.push_back(j.parent < 0 ? j.offset : add(out[static_cast<std::size_t>(j.parent)], j.offset));
  return out;
}

/// Children of every joint, [joints][...], in joint order.
inline std::vector<std::vector<std::size_t>> children(const Skeleton& skeleton) {
  std::vector<std::vector<std::size_t>> out(skeleton.size());
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (skeleton.joints[j].parent >= 0) out[static_cast<std::size_t>(skeleton.joints[j].parent)].push_back(j);
  return out;
}

}  // namespace motiongan::motion
