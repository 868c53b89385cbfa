// The track of the root over the ground: steps and turns integrated, and the inverse.
#pragma once
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Ground position and heading of the root after the last frame of a motion given in steps. If `started` is
/// false there was no such frame: the next frame is placed at x, z, yaw itself, and its own step and turn,
/// which lead there from an unknown frame, are ignored.
struct RootTrack {
  double x = 0, z = 0;  ///< in the file's unit
  double yaw = 0;       ///< radians
  bool started = false;
  double height = 0;  ///< the root's y, in the file's unit; used only by PositionLayout
  /// joints_about_root() of the last frame; used only with RootRotation::support.
  std::vector<Vec3> joints = {};
};

/// Rotates ground coordinates by `yaw` radians about y, as axis_rotation(1, yaw) rotates a vector.
inline void turn_ground(double& x, double& z, double yaw) {
  const double cosine = std::cos(yaw), sine = std::sin(yaw), old_x = x, old_z = z;
  x = cosine * old_x + sine * old_z;
  z = cosine * old_z - sine * old_x;
}

/// Advances the track by one frame: a step in the heading of the previous frame, then the turn (radians).
inline void advance(RootTrack& track, double step_x, double step_z, double turn) {
  if (track.started) {
    turn_ground(step_x, step_z, track.yaw);
    track.x += step_x;
    track.z += step_z;
    track.yaw += turn;
  }
  track.started = true;
}

/// Dimensions of the root's track in a pose vector.
struct TrackDims {
  std::size_t yaw = 0;
  std::optional<std::size_t> position;  ///< of x; y and z follow
};

/// Converts poses [frames, dof] in place from the root's yaw (unwrapped) and position to its turn and step
/// over `step` frames: the inverse of advance(). The first `step` frames have no predecessor and take the
/// values of frame `step`, or zeros if there is none.
inline void differ_track(std::span<double> poses, std::size_t dof, const TrackDims& dims, std::size_t step) {
  const std::size_t frames = poses.size() / dof;
  for (std::size_t f = frames; f-- > step;) {  // backwards, because the earlier frame is needed unmodified
    double* const pose = &poses[f * dof];
    const double* const before = pose - step * dof;
    pose[dims.yaw] -= before[dims.yaw];
    if (!dims.position) continue;
    double &x = pose[*dims.position], &z = pose[*dims.position + 2];
    x -= before[*dims.position];
    z -= before[*dims.position + 2];
    turn_ground(x, z, -before[dims.yaw]);
  }
  for (std::size_t f = 0; f < step && f < frames; ++f) {
    const auto take = [&](std::size_t d) { poses[f * dof + d] = step < frames ? poses[step * dof + d] : 0; };
    take(dims.yaw);
    if (!dims.position) continue;
    take(*dims.position);
    take(*dims.position + 2);
  }
}

/// The motion moved over the ground so that `root` in frame 0 is at the x, z of `to`. With `facing` it is
/// also rotated so that the root's yaw there is that of `to`. Heights do not change. A motion without frames
/// is returned unchanged.
inline Motion placed_at(Motion motion, std::size_t root, const RootTrack& to, bool facing) {
  if (motion.frames == 0) return motion;
  const Vec3 first = motion.position(0, root);
  const double turn = facing ? to.yaw - heading_from_quat(motion.rotation(0, root))[1] : 0;
  const Quat rotation = axis_rotation(1, turn);
  for (std::size_t f = 0; f < motion.frames; ++f) {
    Vec3& p = motion.position(f, root);
    double x = p[0] - first[0], z = p[2] - first[2];
    if (facing) {
      turn_ground(x, z, turn);
      motion.rotation(f, root) = multiply(rotation, motion.rotation(f, root));
    }
    p[0] = to.x + x;
    p[2] = to.z + z;
  }
  return motion;
}

}  // namespace motiongan::motion
