// The pose vector that networks see: exponential maps of the joints' local rotations, and the root's
// position.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// How the root's rotation stands in a pose vector.
enum class RootRotation {
  expmap,  ///< as every other joint's (the papers)
  heading  ///< tilt about x, yaw about y, tilt about z: q = yaw * tilt, the tilt an exponential map without y
};

/// What each number of a pose vector means (SPEC section 6): for joint j, numbers 3j .. 3j + 2 are the
/// exponential map of its local rotation in radians; then, if asked for, the position of the root joint (x,
/// y, z in its parent's frame, in the file's unit).
///
/// The root's exponential map is badly conditioned once somebody turns: near a whole turn its direction says
/// nothing about the rotation, near half a turn a small change tilts the body twice as much.
/// RootRotation::heading keeps the turn in one number, however many turns it counts, and upright bodies stay
/// near zero in the others.
class PoseLayout {
 public:
  PoseLayout() = default;

  /// `root` is the joint whose position is kept (see moving_root). Error if the skeleton has no such joint.
  explicit PoseLayout(Skeleton skeleton, bool root_position = true, std::size_t root = 0,
                      RootRotation root_rotation = RootRotation::expmap)
      : skeleton_(std::move(skeleton)),
        root_position_(root_position),
        root_(root),
        root_rotation_(root_rotation) {
    require(root < skeleton_.size(), "root joint ", root, " is not one of the skeleton's ", skeleton_.size(),
            " joints");
  }

  const Skeleton& skeleton() const { return skeleton_; }
  bool root_position() const { return root_position_; }
  std::size_t root() const { return root_; }
  RootRotation root_rotation() const { return root_rotation_; }

  /// Numbers in a pose: 3 per joint, and 3 for the root's position.
  std::size_t dof() const { return 3 * skeleton_.size() + (root_position_ ? 3 : 0); }

  /// Index of the root position's x; Error where the layout has none.
  std::size_t position_dim() const {
    require(root_position_, "this pose layout has no root position");
    return 3 * skeleton_.size();
  }

  /// Index of the root's yaw; Error where the layout has none.
  std::size_t yaw_dim() const {
    require(root_rotation_ == RootRotation::heading, "this pose layout has no yaw");
    return 3 * root_ + 1;
  }

  /// `LeftArm.x` for a rotation, `Hips.yaw` for the root's yaw, `Hips.position.x` for its position.
  std::string name(std::size_t dim) const {
    require(dim < dof(), "pose dimension ", dim, " does not exist; there are ", dof());
    if (root_rotation_ == RootRotation::heading && dim == yaw_dim())
      return skeleton_.joints[root_].name + ".yaw";
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
        const bool turns = j == root_ && root_rotation_ == RootRotation::heading;
        const Vec3 r =
            turns ? heading_from_quat(motion.rotation(f, j)) : expmap_from_quat(motion.rotation(f, j));
        if (f == 0)
          previous[j] = r;
        else if (turns)
          previous[j] = unwrap_heading(r, previous[j]);
        else
          previous[j] = unwrap_expmap(r, previous[j]);
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
        const Vec3 r{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]};
        const bool turns = j == root_ && root_rotation_ == RootRotation::heading;
        motion.rotations.push_back(turns ? quat_from_heading(r) : quat_from_expmap(r));
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
  RootRotation root_rotation_ = RootRotation::expmap;
};

}  // namespace motiongan::motion
