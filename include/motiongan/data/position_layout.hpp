// The pose vector of joint positions: the body relative to its root and heading, and the root's track.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Layout of a pose vector of positions: for joint j, values 3j .. 3j + 2 are its position relative to the
/// root (joint 0), rotated back by the body's yaw: R_y(-yaw) (p_j - p_root), in the file's unit; the root's
/// own are 0. With `root_track` four more: the root's step in x and in z since the previous frame, in that
/// frame's heading, its height y, and its turn since the previous frame, in radians. The first frame takes
/// the step and turn of the second (zeros if there is none).
///
/// The yaw is computed from positions alone, so that motion with and without rotations is treated the same:
/// the vectors from right to left joints (across_body) are summed and projected onto the ground; the body
/// faces perpendicular to the sum, and yaw 0 is facing +z with the left at +x. If the sum is shorter than a
/// thousandth of the mean bone (a body lying on its side), the previous frame's yaw is kept. The yaw is
/// unwrapped over whole turns. A body without such joints has yaw 0.
class PositionLayout {
 public:
  PositionLayout() = default;

  /// Uses the names, parents and offsets of `skeleton`. Throws Error if it has no joints.
  explicit PositionLayout(Skeleton skeleton, bool root_track = true)
      : skeleton_(std::move(skeleton)), root_track_(root_track), across_(across_body(skeleton_)) {
    require(skeleton_.size() > 0, "a position layout needs a skeleton of at least one joint");
    double sum = 0;
    for (const double bone : bone_lengths(skeleton_)) sum += bone;
    shortest_across_ = 1e-3 * sum / static_cast<double>(skeleton_.size());
  }

  const Skeleton& skeleton() const { return skeleton_; }
  /// Whether the root's track over the ground is part of the pose.
  bool root_track() const { return root_track_; }

  /// Values per pose: 3 per joint, plus 4 with the root's track.
  std::size_t dof() const { return 3 * skeleton_.size() + (root_track_ ? 4 : 0); }

  /// Index of the step in x; step in z, height and turn follow. Throws Error if the layout has no track.
  std::size_t track_dim() const {
    require(root_track_, "this position layout has no root track");
    return 3 * skeleton_.size();
  }

  /// `LeftArm.x`, or `Hips.step.x`, `Hips.step.z`, `Hips.height`, `Hips.turn`.
  std::string name(std::size_t dim) const {
    require(dim < dof(), "pose dimension ", dim, " does not exist; there are ", dof());
    const std::size_t joint = dim / 3;
    if (joint < skeleton_.size()) return skeleton_.joints[joint].name + "." + "xyz"[dim % 3];
    constexpr const char* parts[] = {".step.x", ".step.z", ".height", ".turn"};
    return skeleton_.joints[0].name + parts[dim - track_dim()];
  }

  /// Position and heading of the root in every frame of positions [frames, joints]: x, z, height, and the
  /// unwrapped yaw, which starts within half a turn of 0. Throws Error unless the positions are whole frames
  /// of finite numbers.
  std::vector<RootTrack> places(std::span<const Vec3> positions) const {
    check_rows(positions.size(), skeleton_.size(), "positions", "joints");
    const std::size_t joints = skeleton_.size(), frames = positions.size() / joints;
    std::vector<RootTrack> out(frames);
    double yaw = 0;
    bool known = false;  // whether any frame so far determines a yaw
    for (std::size_t f = 0; f < frames; ++f) {
      const Vec3* const frame = &positions[f * joints];
      for (std::size_t j = 0; j < joints; ++j)
        require(std::isfinite(frame[j][0]) && std::isfinite(frame[j][1]) && std::isfinite(frame[j][2]),
                "joint '", skeleton_.joints[j].name, "' has a position that is not a finite number in frame ",
                f);
      double x = 0, z = 0;
      for (const auto& [left, right] : across_) {
        x += frame[left][0] - frame[right][0];
        z += frame[left][2] - frame[right][2];
      }
      if (std::hypot(x, z) > shortest_across_) {
        yaw = known ? unwrap_angle(std::atan2(-z, x), yaw) : std::atan2(-z, x);
        // Earlier frames take the first known yaw, so that no turn is made up.
        for (std::size_t before = known ? f : 0; before < f; ++before) out[before].yaw = yaw;
        known = true;
      }
      out[f] = {frame[0][0], frame[0][2], yaw, true, frame[0][1]};
    }
    return out;
  }

  /// Position and heading of the root in a frame of positions [frames, joints], for continuing it. Throws
  /// Error if there is no such frame.
  RootTrack track_of(std::span<const Vec3> positions, std::size_t frame) const {
    check_rows(positions.size(), skeleton_.size(), "positions", "joints");
    require(frame < positions.size() / skeleton_.size(), "frame ", frame,
            " does not exist, the positions have ", positions.size() / skeleton_.size(), " frames");
    return places(positions.first((frame + 1) * skeleton_.size())).back();
  }

  /// Poses [frames, dof] of world positions [frames, joints].
  std::vector<double> encode(std::span<const Vec3> positions) const {
    return encode(positions, places(positions));
  }

  /// The same if places(positions) is already known.
  std::vector<double> encode(std::span<const Vec3> positions, std::span<const RootTrack> places) const {
    const std::size_t joints = skeleton_.size(), frames = places.size(), width = dof();
    require(positions.size() == frames * joints, "found ", positions.size(), " positions, expected ", frames,
            " frames x ", joints, " joints");
    std::vector<double> out(frames * width), tracks;
    for (std::size_t f = 0; f < frames; ++f) {
      const RootTrack& at = places[f];
      const double cosine = std::cos(at.yaw), sine = std::sin(at.yaw);
      double* pose = &out[f * width];
      for (std::size_t j = 0; j < joints; ++j, pose += 3) {
        const Vec3 p = subtract(positions[f * joints + j], {at.x, at.height, at.z});
        pose[0] = cosine * p[0] - sine * p[2];
        pose[1] = p[1];
        pose[2] = cosine * p[2] + sine * p[0];
      }
      tracks.insert(tracks.end(), {at.x, at.height, at.z, at.yaw});
    }
    if (!root_track_) return out;
    differ_track(tracks, 4, {3, 0}, 1);
    for (std::size_t f = 0; f < frames; ++f) {
      const double* const step = &tracks[4 * f];
      double* const pose = &out[f * width + track_dim()];
      pose[0] = step[0], pose[1] = step[2], pose[2] = step[1], pose[3] = step[3];
    }
    return out;
  }

  /// World positions [frames, joints] of poses [frames, dof].
  ///
  /// Steps and turns are integrated from `track` (null: from the origin), which is updated to the last frame:
  /// positions decoded in pieces over one track are, bit for bit, those decoded at once. If the track is not
  /// started, the first frame is placed at its x, z and yaw. Without root track the body stays at the track's
  /// x, z, yaw and height, and the track is unchanged.
  std::vector<Vec3> decode(std::span<const double> poses, RootTrack* track = nullptr) const {
    check_rows(poses.size(), dof(), "pose values", "dimensions");
    RootTrack own;
    RootTrack& at = track != nullptr ? *track : own;
    std::vector<Vec3> out;
    out.reserve(poses.size() / dof() * skeleton_.size());
    for (std::size_t row = 0; row < poses.size(); row += dof()) {
      if (root_track_) {
        const double* const step = &poses[row + track_dim()];
        advance(at, step[0], step[1], step[3]);
        at.height = step[2];
      }
      append_frame(poses.subspan(row, dof()), at, out);
    }
    return out;
  }

  /// World positions [frames, joints] of poses [frames, dof] placed at `places` [frames], ignoring the poses'
  /// own track. restore(encode(p), places(p)) is p up to rounding.
  std::vector<Vec3> restore(std::span<const double> poses, std::span<const RootTrack> places) const {
    require(poses.size() == places.size() * dof(), "found ", poses.size(), " pose values and ", places.size(),
            " places, expected ", dof(), " values for each place");
    std::vector<Vec3> out;
    out.reserve(places.size() * skeleton_.size());
    for (std::size_t f = 0; f < places.size(); ++f)
      append_frame(poses.subspan(f * dof(), dof()), places[f], out);
    return out;
  }

 private:
  static void check_rows(std::size_t values, std::size_t width, const char* what, const char* of) {
    require(width > 0, "a position layout without a skeleton cannot be used");
    require(values % width == 0, "found ", values, " ", what, ", expected a multiple of ", width,
            " (frames x ", of, ")");
  }

  void append_frame(std::span<const double> pose, const RootTrack& at, std::vector<Vec3>& out) const {
    const double cosine = std::cos(at.yaw), sine = std::sin(at.yaw);
    for (std::size_t j = 0; j < skeleton_.size(); ++j) {
      const double x = pose[3 * j], z = pose[3 * j + 2];
      out.push_back(
          {at.x + (cosine * x + sine * z), at.height + pose[3 * j + 1], at.z + (cosine * z - sine * x)});
    }
  }

  Skeleton skeleton_;
  bool root_track_ = true;
  std::vector<JointPair> across_;
  double shortest_across_ = 0;  ///< in the file's unit
};

}  // namespace motiongan::motion
