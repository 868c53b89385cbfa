// The joint that carries a body through space.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Whether joint j moves relative to its parent by more than a millionth of the total bone length.
inline bool has_moving_track(const Motion& motion, std::size_t j) {
  double size = 0;
  for (const Joint& joint : motion.skeleton.joints) size += length(joint.offset);
  const double tolerance = 1e-6 * std::max(size, 1e-3);
  for (std::size_t f = 1; f < motion.frames; ++f)
    if (length(subtract(motion.position(f, j), motion.position(0, j))) > tolerance) return true;
  return false;
}

namespace root_joint_detail {

/// Length of all bones from each joint's parent downwards, end sites included, [joints].
inline std::vector<double> length_below(const Motion& motion) {
  const Skeleton& skeleton = motion.skeleton;
  std::vector<double> out(skeleton.size(), 0);
  for (std::size_t j = skeleton.size(); j-- > 0;) {
    const Joint& joint = skeleton.joints[j];
    // Bones held in position channels have no offsets.
    out[j] += std::max(length(joint.offset), motion.frames > 0 ? length(motion.position(0, j)) : 0);
    if (joint.end_site) out[j] += length(*joint.end_site);
    if (joint.parent >= 0) out[static_cast<std::size_t>(joint.parent)] += out[j];
  }
  return out;
}

/// The child of joint j that the body hangs from: an only child; else the one above both feet or, if no
/// joints are named like feet, the one with three quarters of the bones below j by length. -1 if there is
/// none: the body branches here.
inline int body_child(const Motion& motion, std::size_t j, const std::vector<std::size_t>& branches) {
  if (branches.size() == 1) return static_cast<int>(branches.front());
  if (branches.empty()) return -1;
  const std::vector<std::size_t> feet = feet_detail::feet_by_name(motion.skeleton);
  const std::vector<std::size_t> feet_below = feet_detail::count_below(motion.skeleton, feet);
  if (feet_below[j] == 2) {
    for (const std::size_t child : branches)
      if (feet_below[child] == 2) return static_cast<int>(child);
    return -1;
  }
  const std::vector<double> lengths = length_below(motion);
  double sum = 0;
  for (const std::size_t child : branches) sum += lengths[child];
  for (const std::size_t child : branches)
    if (sum > 0 && lengths[child] >= 0.75 * sum) return static_cast<int>(child);
  return -1;
}

}  // namespace root_joint_detail

/// The joints that carry the body, from the top: joint 0 and, as long as the body hangs from one child, that
/// child. The last one is where the body branches (the hips), or the end of a chain.
inline std::vector<std::size_t> body_chain(const Motion& motion) {
  const auto below = children(motion.skeleton);
  std::vector<std::size_t> out;
  for (int j = motion.skeleton.size() > 0 ? 0 : -1; j >= 0;) {
    out.push_back(static_cast<std::size_t>(j));
    j = root_joint_detail::body_child(motion, out.back(), below[out.back()]);
  }
  return out;
}

/// The root of the motion: the first joint from the top whose position changes over time, searched down the
/// chain that carries the body. Bandai-Namco files move `Hips`, a child of a resting `joint_Root`; Unreal's
/// move `pelvis`, beside `ik_foot_root`. Where a joint has several children, the body hangs from the one
/// above both feet or, if no joints are named like feet, from the one with three quarters of the bones by
/// length. 0 if nothing travels.
inline int moving_root(const Motion& motion) {
  check_motion(motion);
  if (motion.skeleton.size() > 0 && has_moving_track(motion, 0)) return 0;  // nearly always
  for (const std::size_t j : body_chain(motion))
    if (has_moving_track(motion, j)) return static_cast<int>(j);
  return 0;
}

/// The joints that fold_into_root(motion, root) removes beside those above `root`: other branches, such as
/// `ik_foot_root` or props beside the body. In joint order.
inline std::vector<std::size_t> joints_beside(const Skeleton& skeleton, int root) {
  std::vector<char> kept(skeleton.size(), 0), above(skeleton.size(), 0);
  for (int j = root; j > 0;) {
    j = skeleton.joints[static_cast<std::size_t>(j)].parent;
    above[static_cast<std::size_t>(j)] = 1;
  }
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    kept[j] = static_cast<int>(j) == root || (parent >= 0 && kept[static_cast<std::size_t>(parent)] != 0);
    if (kept[j] == 0 && above[j] == 0) out.push_back(j);
  }
  return out;
}

/// The motion of `root` and the joints below it, with the transforms of the joints above folded into it: the
/// joints that remain keep their world positions. Branches beside the body are removed (joints_beside).
/// Throws Error if there is no such joint.
inline Motion fold_into_root(const Motion& motion, int root) {
  check_motion(motion);
  if (root == 0) return motion;
  require(root > 0 && static_cast<std::size_t>(root) < motion.skeleton.size(), "root joint ", root,
          " is not one of the skeleton's ", motion.skeleton.size(), " joints");
  const auto top = static_cast<std::size_t>(root);
  std::vector<std::size_t> kept{top};
  std::vector<int> index(motion.skeleton.size(), -1);
  index[top] = 0;
  for (std::size_t j = top + 1; j < motion.skeleton.size(); ++j) {
    const int parent = motion.skeleton.joints[j].parent;
    if (parent < 0 || index[static_cast<std::size_t>(parent)] < 0) continue;
    index[j] = static_cast<int>(kept.size());
    kept.push_back(j);
  }

  Motion out;
  out.rate = motion.rate;
  out.frames = motion.frames;
  for (const std::size_t j : kept) {
    Joint joint = motion.skeleton.joints[j];
    joint.parent = j == top ? -1 : index[static_cast<std::size_t>(joint.parent)];
    out.skeleton.joints.push_back(std::move(joint));
  }
  Joint& first = out.skeleton.joints.front();
  Vec3 rest = first.offset;
  for (int j = motion.skeleton.joints[top].parent; j >= 0;
       j = motion.skeleton.joints[static_cast<std::size_t>(j)].parent)
    rest = add(rest, motion.skeleton.joints[static_cast<std::size_t>(j)].offset);
  first.offset = rest;
  std::vector<Channel> turns;
  for (const Channel c : first.channels)
    if (is_rotation(c)) turns.push_back(c);
  // The new root needs channels for any position and orientation.
  if (turns.size() < 3) turns = {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
  if (first.channels.size() < 6) {
    first.channels = {Channel::x_position, Channel::y_position, Channel::z_position};
    first.channels.insert(first.channels.end(), turns.begin(), turns.end());
  }

  const GlobalPose global = forward_kinematics(motion);
  const std::size_t joints = motion.skeleton.size();
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (const std::size_t j : kept) {
      const std::size_t at = f * joints + j;
      out.rotations.push_back(j == top ? global.rotations[at] : motion.rotations[at]);
      out.positions.push_back(j == top ? global.positions[at] : motion.positions[at]);
    }
  return out;
}

/// The motion with identity rotations and zero offsets of parents above `root`, whose transforms move into
/// `root`: its position and rotation are then those in the world. Nothing changes if the joints above stand
/// unrotated at the origin, as they nearly always do. Files that turn the body from Z up to Y up in a joint
/// above it need this, since a pose holds the root relative to its parent.
inline Motion with_world_root(Motion motion, int root) {
  check_motion(motion);
  if (root == 0) return motion;
  std::vector<std::size_t> above;
  for (int j = motion.skeleton.joints[static_cast<std::size_t>(root)].parent; j >= 0;
       j = motion.skeleton.joints[static_cast<std::size_t>(j)].parent)
    above.push_back(static_cast<std::size_t>(j));
  bool turned = false;
  for (std::size_t f = 0; f < motion.frames && !turned; ++f)
    for (const std::size_t j : above) turned = turned || angle_between(Quat{}, motion.rotation(f, j)) > 1e-6;
  if (!turned) return motion;
  const GlobalPose global = forward_kinematics(motion);
  const std::size_t joints = motion.skeleton.size();
  Vec3 origin{};  // of the root's parent, once unrotated
  for (std::size_t f = 0; f < motion.frames; ++f) {
    origin = {};
    for (const std::size_t j : above) {
      motion.rotation(f, j) = Quat{};
      origin = add(origin, motion.position(f, j));
    }
    const std::size_t at = f * joints + static_cast<std::size_t>(root);
    motion.rotations[at] = global.rotations[at];
    motion.positions[at] = subtract(global.positions[at], origin);
  }
  return motion;
}

}  // namespace motiongan::motion
