// The pose vector that networks see: exponential maps of the joints' local rotations, and the root's
// position.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// How the root's rotation stands in a pose vector.
enum class RootRotation {
  expmap,   ///< as every other joint's (the papers)
  heading,  ///< tilt about x, yaw about y, tilt about z: q = yaw * tilt, the tilt an exponential map without
            ///< y
  velocity  ///< as heading, but yaw and the position's x and z as what they change by since the frame before
};

/// What each number of a pose vector means (SPEC section 6): for joint j, numbers 3j .. 3j + 2 are the
/// exponential map of its local rotation in radians; then, if asked for, the position of the root joint (x,
/// y, z in its parent's frame, in the file's unit).
///
/// The root's exponential map is badly conditioned once somebody turns: near a whole turn its direction says
/// nothing about the rotation, near half a turn a small change tilts the body twice as much.
/// RootRotation::heading keeps the turn in one number, however many turns it counts, and upright bodies stay
/// near zero in the others.
///
/// In a long motion, place and yaw leave whatever range a network was trained on. RootRotation::velocity
/// holds the turn since the frame before, and, as x and z of the position, the step since the frame before in
/// the heading's frame of the frame before (turned back by its yaw). Only y is then a place: the height.
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

  /// Whether the root's rotation is kept as tilt and yaw (or turn).
  bool has_yaw() const { return root_rotation_ != RootRotation::expmap; }

  /// Whether poses hold steps and turns, which decode() adds up.
  bool has_steps() const { return root_rotation_ == RootRotation::velocity; }

  /// Index of the root's yaw, or of its turn; Error where the layout has none.
  std::size_t yaw_dim() const {
    require(has_yaw(), "this pose layout has no yaw");
    return 3 * root_ + 1;
  }

  /// `LeftArm.x` for a rotation, `Hips.yaw` or `Hips.turn` for the root's yaw, `Hips.position.x` or
  /// `Hips.step.x` for its position.
  std::string name(std::size_t dim) const {
    require(dim < dof(), "pose dimension ", dim, " does not exist; there are ", dof());
    const std::string& root = skeleton_.joints[root_].name;
    if (has_yaw() && dim == yaw_dim()) return root + (has_steps() ? ".turn" : ".yaw");
    const std::string part(1, "xyz"[dim % 3]);
    if (dim < 3 * skeleton_.size()) return skeleton_.joints[dim / 3].name + "." + part;
    return root + (has_steps() && part != "y" ? ".step." : ".position.") + part;
  }

  /// The motion's poses, [frames, dof], exponential maps unwrapped over time. Error if the motion has another
  /// number of joints. Positions of joints other than the root are not kept: decode() gives them their
  /// offsets.
  ///
  /// Steps and turns (RootRotation::velocity) are differences over `step` frames, for poses of which every
  /// step-th one will be used. The first `step` frames have no predecessor: they take the values of frame
  /// `step`; zeros where there is none.
  std::vector<double> encode(const Motion& motion, std::size_t step = 1) const {
    check_motion(motion);
    require(step > 0, "poses cannot be encoded with a step of 0 frames, expected at least 1");
    const std::size_t joints = skeleton_.size();
    require(motion.skeleton.size() == joints, "a motion of ", motion.skeleton.size(),
            " joints does not fit a pose layout of ", joints, " joints");
    std::vector<double> out;
    out.reserve(motion.frames * dof());
    std::vector<Vec3> previous(joints, Vec3{});
    for (std::size_t f = 0; f < motion.frames; ++f) {
      for (std::size_t j = 0; j < joints; ++j) {
        const bool turns = j == root_ && has_yaw();
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
    if (has_steps())
      differ_track(out, dof(), {yaw_dim(), root_position_ ? std::optional(position_dim()) : std::nullopt},
                   step);
    return out;
  }

  /// The motion of poses [frames, dof]. Without root position, every joint stays at its offset.
  ///
  /// Steps and turns are added up from `track` (null: from the origin) on, which then tells where the last
  /// frame stands: a motion decoded in pieces over one track is, bit for bit, the one decoded at once. The
  /// first frame of a track that is not started stands at the track's x, z and yaw. Other root forms leave
  /// the track alone.
  Motion decode(std::span<const double> poses, std::size_t frames, double rate,
                RootTrack* track = nullptr) const {
    require(poses.size() == frames * dof(), "found ", poses.size(), " pose values, expected ", frames,
            " frames x ", dof(), " dimensions");
    Motion motion;
    motion.skeleton = skeleton_;
    motion.rate = rate;
    motion.frames = frames;
    motion.rotations.reserve(frames * skeleton_.size());
    motion.positions.reserve(frames * skeleton_.size());
    RootTrack own;
    RootTrack& at = track != nullptr ? *track : own;
    for (std::size_t f = 0; f < frames; ++f) {
      const std::span<const double> pose = poses.subspan(f * dof(), dof());
      const Vec3 place = root_position_ ? Vec3{pose[dof() - 3], pose[dof() - 2], pose[dof() - 1]} : Vec3{};
      if (has_steps()) advance(at, place[0], place[2], pose[yaw_dim()]);
      for (std::size_t j = 0; j < skeleton_.size(); ++j) {
        Vec3 r{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]};
        const bool turns = j == root_ && has_yaw();
        if (turns && has_steps()) r[1] = at.yaw;
        motion.rotations.push_back(turns ? quat_from_heading(r) : quat_from_expmap(r));
        motion.positions.push_back(skeleton_.joints[j].offset);
      }
      if (root_position_) motion.position(f, root_) = has_steps() ? Vec3{at.x, place[1], at.z} : place;
    }
    return motion;
  }

  /// Where the root stands in a frame of a motion of this skeleton, from which a continuation can go on. The
  /// yaw is within half a turn of 0. Error if the motion has no such frame or another number of joints.
  RootTrack track_of(const Motion& motion, std::size_t frame) const {
    check_motion(motion);
    require(motion.skeleton.size() == skeleton_.size() && frame < motion.frames, "frame ", frame,
            " of a motion of ", motion.frames, " frames and ", motion.skeleton.size(),
            " joints was asked for; the pose layout has ", skeleton_.size(), " joints");
    const Vec3& p = motion.position(frame, root_);
    return {p[0], p[2], heading_from_quat(motion.rotation(frame, root_))[1], true};
  }

 private:
  Skeleton skeleton_;
  bool root_position_ = true;
  std::size_t root_ = 0;
  RootRotation root_rotation_ = RootRotation::expmap;
};

}  // namespace motiongan::motion
