// Forward kinematics, bone lengths, and the joint that carries a skeleton through space.
#pragma once
#include <algorithm>
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

/// Children of every joint, [joints][...], in joint order.
inline std::vector<std::vector<std::size_t>> children(const Skeleton& skeleton) {
  std::vector<std::vector<std::size_t>> out(skeleton.size());
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (skeleton.joints[j].parent >= 0) out[static_cast<std::size_t>(skeleton.joints[j].parent)].push_back(j);
  return out;
}

/// Whether joint j moves relative to its parent by more than a millionth of the total bone length.
inline bool has_moving_track(const Motion& motion, std::size_t j) {
  double size = 0;
  for (const Joint& joint : motion.skeleton.joints) size += length(joint.offset);
  const double tolerance = 1e-6 * std::max(size, 1e-3);
  for (std::size_t f = 1; f < motion.frames; ++f)
    if (length(subtract(motion.position(f, j), motion.position(0, j))) > tolerance) return true;
  return false;
}

/// The root of the motion: the first joint from the top whose position changes over time, searched along the
/// unbranched chain below joint 0 (Bandai-Namco files move `Hips`, a child of a resting `joint_Root`). 0 if
/// nothing travels.
inline int moving_root(const Motion& motion) {
  check_motion(motion);
  const auto below = children(motion.skeleton);
  for (std::size_t j = 0; j < motion.skeleton.size(); j = below[j].front()) {
    if (has_moving_track(motion, j)) return static_cast<int>(j);
    if (below[j].size() != 1) break;
  }
  return 0;
}

/// The motion with the joints above `root` removed and their transforms folded into it; the remaining joints
/// keep their world positions. Throws Error if a joint above `root` has other children, which would be lost.
inline Motion fold_into_root(const Motion& motion, int root) {
  check_motion(motion);
  if (root == 0) return motion;
  require(root > 0 && static_cast<std::size_t>(root) < motion.skeleton.size(), "root joint ", root,
          " is not one of the skeleton's ", motion.skeleton.size(), " joints");
  const auto below = children(motion.skeleton);
  const std::size_t removed = static_cast<std::size_t>(root);
  Vec3 rest = motion.skeleton.joints[removed].offset;
  for (std::size_t j = 0; j < removed; ++j) {
    require(below[j].size() == 1 && below[j].front() == j + 1, "joint '",
            motion.skeleton.joints[removed].name, "' cannot become the root: '",
            motion.skeleton.joints[j].name, "' above it has other children");
    rest = add(rest, motion.skeleton.joints[j].offset);
  }

  Motion out;
  out.rate = motion.rate;
  out.frames = motion.frames;
  out.skeleton.joints.assign(motion.skeleton.joints.begin() + root, motion.skeleton.joints.end());
  for (Joint& j : out.skeleton.joints) j.parent = std::max(j.parent - root, -1);
  Joint& top = out.skeleton.joints.front();
  top.offset = rest;
  std::vector<Channel> turns;
  for (const Channel c : top.channels)
    if (is_rotation(c)) turns.push_back(c);
  // The new root needs channels for any position and orientation.
  if (turns.size() < 3) turns = {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
  if (top.channels.size() < 6) {
    top.channels = {Channel::x_position, Channel::y_position, Channel::z_position};
    top.channels.insert(top.channels.end(), turns.begin(), turns.end());
  }

  const GlobalPose global = forward_kinematics(motion);
  const std::size_t joints = motion.skeleton.size();
  for (std::size_t f = 0; f < motion.frames; ++f) {
    for (std::size_t j = removed; j < joints; ++j) {
      const std::size_t at = f * joints + j;
      out.rotations.push_back(j == removed ? global.rotations[at] : motion.rotations[at]);
      out.positions.push_back(j == removed ? global.positions[at] : motion.positions[at]);
    }
  }
  return out;
}

}  // namespace motiongan::motion
