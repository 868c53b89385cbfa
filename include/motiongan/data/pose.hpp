// The pose vector of rotations: exponential maps of the joints' local rotations, and the root's position.
#pragma once
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/core/fields.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/skeleton.hpp"
#include "motiongan/motion/support.hpp"

namespace motiongan::motion {

/// How a pose vector represents the root's rotation.
enum class RootRotation {
  expmap,    ///< like every other joint (the papers)
  heading,   ///< tilt about x, yaw about y, tilt about z: q = yaw * tilt, the tilt an exponential map without
             ///< y
  velocity,  ///< as heading, but yaw and the position's x and z as changes since the previous frame
  support    ///< as velocity, but the position is that of the joints that bear the body
};
constexpr NameTable<RootRotation, 4> enum_names(RootRotation) {
  return {{{RootRotation::expmap, "expmap"},
           {RootRotation::heading, "heading"},
           {RootRotation::velocity, "velocity"},
           {RootRotation::support, "support"}}};
}

/// Layout of a pose vector: for joint j, values 3j .. 3j + 2 are the exponential map of its local rotation in
/// radians; then, optionally, the position of the root joint (x, y, z in its parent's frame, in the file's
/// unit).
///
/// The root's exponential map is badly conditioned once a body turns: near a full turn its direction says
/// nothing about the rotation, near half a turn a small change tilts the body twice as much.
/// RootRotation::heading keeps the turn in one unwrapped value, and the others stay near zero for upright
/// bodies.
///
/// In a long motion, position and yaw leave whatever range a network was trained on. RootRotation::velocity
/// instead holds the turn since the previous frame and, as x and z of the position, the step since the
/// previous frame in that frame's heading (rotated back by its yaw). Only y, the height, remains absolute.
///
/// A small error of the root moves the whole body, feet included. RootRotation::support holds instead the
/// height and the step of the joints that bear the body (support_weights), which are all but 0 while a foot
/// stands. The root follows from them and from the rotations: feet stand on the ground by construction.
/// Because a climber's or a jumper's height would otherwise set the scale of errors on the ground,
/// with_floor() makes heights logarithmic away from the floor.
class PoseLayout {
 public:
  PoseLayout() = default;

  /// `root` is the joint whose position is kept (see moving_root). Throws Error if the skeleton has no such
  /// joint.
  explicit PoseLayout(Skeleton skeleton, bool root_position = true, std::size_t root = 0,
                      RootRotation root_rotation = RootRotation::expmap)
      : skeleton_(std::move(skeleton)),
        root_position_(root_position),
        root_(root),
        root_rotation_(root_rotation) {
    require(root < skeleton_.size(), "root joint ", root, " is not one of the skeleton's ", skeleton_.size(),
            " joints");
    if (!has_support()) return;
    softness_ = body_unit(skeleton_) / 50;
    require(softness_ > 0, "the skeleton has no bones of positive length: nothing bears it");
  }

  const Skeleton& skeleton() const { return skeleton_; }
  /// Whether the root's position is part of a pose.
  bool root_position() const { return root_position_; }
  /// The joint that moves the body.
  std::size_t root() const { return root_; }
  RootRotation root_rotation() const { return root_rotation_; }

  /// With RootRotation::support, the same layout with the heights h of the support as asinh((h - floor) / (2
  /// softness)); other forms are not changed.
  PoseLayout with_floor(double floor) const {
    PoseLayout out = *this;
    if (has_support()) out.floor_ = floor;
    return out;
  }
  /// The same layout for a body of the same joints with other offsets.
  PoseLayout of_body(Skeleton skeleton) const {
    const PoseLayout out(std::move(skeleton), root_position_, root_, root_rotation_);
    return floor_ ? out.with_floor(*floor_) : out;
  }
  /// In the file's unit; unset: heights are as they are.
  const std::optional<double>& floor() const { return floor_; }
  /// Of RootRotation::support, in the file's unit: a fiftieth of the body's unit.
  double softness() const { return softness_; }

  /// The value of a pose for a height of the support, and the reverse.
  double lowered(double height) const {
    return floor_ ? std::asinh((height - *floor_) / (2 * softness_)) : height;
  }
  double lifted(double value) const { return floor_ ? *floor_ + 2 * softness_ * std::sinh(value) : value; }

  /// Values per pose: 3 per joint, plus 3 for the root's position.
  std::size_t dof() const { return 3 * skeleton_.size() + (root_position_ ? 3 : 0); }

  /// Index of the root position's x. Throws Error if the layout has none.
  std::size_t position_dim() const {
    require(root_position_, "this pose layout has no root position");
    return 3 * skeleton_.size();
  }

  /// Whether the root's rotation is stored as tilt and yaw (or turn).
  bool has_yaw() const { return root_rotation_ != RootRotation::expmap; }

  /// Whether poses hold steps and turns, which decode() integrates.
  bool has_steps() const {
    return root_rotation_ == RootRotation::velocity || root_rotation_ == RootRotation::support;
  }

  /// Whether the root's position is given by the joints that bear the body.
  bool has_support() const { return root_rotation_ == RootRotation::support && root_position_; }

  /// Index of the root's yaw, or of its turn. Throws Error if the layout has none.
  std::size_t yaw_dim() const {
    require(has_yaw(), "this pose layout has no yaw");
    return 3 * root_ + 1;
  }

  /// `LeftArm.x` for a rotation, `Hips.yaw` or `Hips.turn` for the root's yaw, `Hips.position.x`,
  /// `Hips.step.x` or `Hips.support.x` for its position. Throws Error for a dimension that does not exist.
  std::string name(std::size_t dim) const {
    require(dim < dof(), "pose dimension ", dim, " does not exist; there are ", dof());
    const std::string& root = skeleton_.joints[root_].name;
    if (has_yaw() && dim == yaw_dim()) return root + (has_steps() ? ".turn" : ".yaw");
    const std::string part(1, "xyz"[dim % 3]);
    if (dim < 3 * skeleton_.size()) return skeleton_.joints[dim / 3].name + "." + part;
    if (has_support()) return root + ".support." + part;
    return root + (has_steps() && part != "y" ? ".step." : ".position.") + part;
  }

  /// The motion's poses, [frames, dof], exponential maps unwrapped over time. Positions of joints other than
  /// the root are lost: decode() gives these joints their offsets. Throws Error if the number of joints
  /// differs.
  ///
  /// Steps and turns (RootRotation::velocity) are differences over `step` frames, for use of every step-th
  /// pose. The first `step` frames have no predecessor: they take the values of frame `step`, or zeros if
  /// there is none.
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
    if (has_support()) move_to_support(motion, out, step);
    return out;
  }

  /// The motion of poses [frames, dof]. Without root position, every joint stays at its offset.
  ///
  /// Steps and turns are integrated from `track` (null: from the origin), which is updated to the last frame:
  /// a motion decoded in pieces over one track is, bit for bit, the one decoded at once. If the track is not
  /// started, the first frame is placed at its x, z and yaw. Other root representations leave the track
  /// unchanged.
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
      for (std::size_t j = 0; j < skeleton_.size(); ++j) {
        const Vec3 r{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]};
        motion.rotations.push_back(j == root_ && has_yaw() ? quat_from_heading(r) : quat_from_expmap(r));
        motion.positions.push_back(skeleton_.joints[j].offset);
      }
      Vec3 place = root_position_ ? Vec3{pose[dof() - 3], pose[dof() - 2], pose[dof() - 1]} : Vec3{};
      if (has_steps()) {
        place = advance_root(pose, frame_of(motion.rotations, f), frame_of(motion.positions, f), at);
        motion.rotation(f, root_) = quat_from_heading({pose[3 * root_], at.yaw, pose[3 * root_ + 2]});
      }
      if (root_position_) motion.position(f, root_) = place;
    }
    return motion;
  }

  /// Advances the track by one pose of steps and turns, as decode() does.
  void follow(std::span<const double> pose, RootTrack& track) const {
    std::vector<Quat> rotations;
    std::vector<Vec3> positions;
    for (std::size_t j = 0; has_support() && j < skeleton_.size(); ++j) {
      const Vec3 r{pose[3 * j], pose[3 * j + 1], pose[3 * j + 2]};
      rotations.push_back(j == root_ ? quat_from_heading(r) : quat_from_expmap(r));
      positions.push_back(skeleton_.joints[j].offset);
    }
    advance_root(pose, rotations, positions, track);
  }

  /// Position and heading of the root in a frame of a motion of this skeleton, for continuing it. The yaw is
  /// within half a turn of 0. Throws Error if the motion has no such frame or another number of joints.
  RootTrack track_of(const Motion& motion, std::size_t frame) const {
    check_motion(motion);
    require(motion.skeleton.size() == skeleton_.size() && frame < motion.frames, "frame ", frame,
            " of a motion of ", motion.frames, " frames and ", motion.skeleton.size(),
            " joints does not exist or does not fit the pose layout of ", skeleton_.size(), " joints");
    const Vec3& p = motion.position(frame, root_);
    RootTrack at{p[0], p[2], heading_from_quat(motion.rotation(frame, root_))[1], true};
    if (has_support()) at.joints = joints_of(motion, frame);
    return at;
  }

 private:
  template <class T>
  std::span<const T> frame_of(const std::vector<T>& values, std::size_t frame) const {
    return std::span(values).subspan(frame * skeleton_.size(), skeleton_.size());
  }

  std::vector<Vec3> joints_of(const Motion& motion, std::size_t frame) const {
    return joints_about_root(skeleton_, root_, frame_of(motion.rotations, frame),
                             frame_of(motion.positions, frame));
  }

  /// Replaces the root's height and steps in poses [frames, dof] by those of the support.
  void move_to_support(const Motion& motion, std::span<double> poses, std::size_t step) const {
    std::vector<std::vector<Vec3>> joints;  // of all frames
    for (std::size_t f = 0; f < motion.frames; ++f) joints.push_back(joints_of(motion, f));
    for (std::size_t f = 0; f < motion.frames; ++f) {
      double* const pose = &poses[f * dof()];
      double* const place = pose + position_dim();
      place[1] = lowered(place[1] + support_height(joints[f], softness_));
      // As in differ_track(): the first frames take the step of frame `step`.
      const std::size_t now = std::max(f, step);
      if (now >= motion.frames) continue;
      const GroundStep offset = support_offset(joints[now - step], joints[now], pose[yaw_dim()], softness_);
      place[0] += offset.x;
      place[2] += offset.z;
    }
  }

  /// Advances the track by a pose of steps and turns and returns the root's position. `rotations` and
  /// `positions` are the pose's local ones, [joints]; the root's yaw and position are not read.
  Vec3 advance_root(std::span<const double> pose, std::span<const Quat> rotations,
                    std::span<const Vec3> positions, RootTrack& at) const {
    Vec3 step = root_position_ ? Vec3{pose[dof() - 3], pose[dof() - 2], pose[dof() - 1]} : Vec3{};
    const double turn = pose[yaw_dim()];
    if (has_support()) {
      std::vector<Vec3> joints = joints_about_root(skeleton_, root_, rotations, positions);
      step[1] = lifted(step[1]) - support_height(joints, softness_);
      if (!at.joints.empty()) {
        const GroundStep offset = support_offset(at.joints, joints, turn, softness_);
        step[0] -= offset.x;
        step[2] -= offset.z;
      }
      at.joints = std::move(joints);
    }
    advance(at, step[0], step[2], turn);
    return {at.x, step[1], at.z};
  }

  Skeleton skeleton_;
  bool root_position_ = true;
  std::size_t root_ = 0;
  RootRotation root_rotation_ = RootRotation::expmap;
  std::optional<double> floor_;
  double softness_ = 0;
};

}  // namespace motiongan::motion
