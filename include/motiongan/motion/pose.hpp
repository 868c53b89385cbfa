// The pose vector that networks see: exponential maps of the joints' local rotations, and the root's
// position.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// What each number of a pose vector means (SPEC section 6): for joint j, numbers 3j .. 3j + 2 are the
/// exponential map of its local rotation in radians; then, if asked for, the position of the root joint (x,
/// y, z in its parent's frame, in the file's unit).
class PoseLayout {
 public:
  PoseLayout() = default;

  /// `root` is the joint whose position is kept (see moving_root). Error if the skeleton has no such joint.
  explicit PoseLayout(Skeleton skeleton, bool root_position = true, std::size_t root = 0)
      : skeleton_(std::move(skeleton)), root_position_(root_position), root_(root) {
    require(root < skeleton_.size(), "root joint ", root, " is not one of the skeleton's ", skeleton_.size(),
            " joints");
  }

  const Skeleton& skeleton() const { return skeleton_; }
  bool root_position() const { return root_position_; }
  std::size_t root() const { return root_; }

  /// Numbers in a pose: 3 per joint, and 3 for the root's position.
  std::size_t dof() const { return 3 * skeleton_.size() + (root_position_ ? 3 : 0); }

  /// Index of the root position's x; Error where the layout has none.
  std::size_t position_dim() const {
    require(root_position_, "this pose layout has no root position");
    return 3 * skeleton_.size();
  }

  /// `LeftArm.x` for a rotation, `Hips.position.x` for the root's position.
  std::string name(std::size_t dim) const {
    require(dim < dof(), "pose dimension ", dim, " does not exist; there are ", dof());
    const std::string part(1, "xyz"[dim % 3]);
    if (dim < 3 * skeleton_.size()) return skeleton_.joints[dim / 3].name + "." + part;
    return skeleton_.joints[root_].name + ".position." + part;
  }

  /// The motion's poses, [frames, dof], exponential maps unwrapped over time. Error if the motion has another
  /// number of joints. Positions of joints other than the root are not kept: decode() gives them their
  /// offsets.
  std::vector<double> encode(const Motion& motion) const {
    check_motion(motion);
    const std::size_t joints = skeleton_.size();
    require(motion.skeleton.size() == joints, "a motion of ", motion.skeleton.size(),
            " joints does not fit a pose layout of ", joints, " joints");
    std::vector<double> out;
    out.reserve(motion.frames * dof());
    std::vector<Vec3> previous(joints, Vec3{});
    for (std::size_t f = 0; f < motion.frames; ++f) {
      for (std::size_t j = 0; j < joints; ++j) {
        const Vec3 r = expmap_from_quat(motion.rotation(f, j));
        previous[j] = f == 0 ? r : unwrap_expmap(r, previous[j]);
        out.insert(out.end(), previous[j].begin(), previous[j].end());
      }
      if (!root_position_) continue;
      const Vec3& p = motion.position(f, root_);
      out.insert(out.end(), p.begin(), p.end());
    }
    return out;
  }

  /// The motion of poses [frames, dof]. Without root position, every joint stays at its offset.
  Motion decode(std::span<const double> poses, std::size_t frames, double rate) const {
    require(poses.size() == frames * dof(), "found ", poses.size(), " pose values, expected ", frames,
            " frames x ", dof(), " dimensions");
    Motion motion;
    motion.skeleton = skeleton_;
    motion.rate = rate;
    motion.frames = frames;
    motion.rotations.reserve(frames * skeleton_.size());
    motion.positions.reserve(frames * skeleton_.size());
    for (std::size_t f = 0; f < frames; ++f) {
      const std::span<const double> pose = poses.subspan(f * dof(), dof());
      for (std::size_t j = 0; j < skeleton_.size(); ++j) {
        motion.rotations.push_back(quat_from_expmap({pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]}));
        motion.positions.push_back(skeleton_.joints[j].offset);
      }
      if (!root_position_) continue;
      const std::size_t at = position_dim();
      motion.position(f, root_) = {pose[at], pose[at + 1], pose[at + 2]};
    }
    return motion;
  }

 private:
  Skeleton skeleton_;
  bool root_position_ = true;
  std::size_t root_ = 0;
};

}  // namespace motiongan::motion
