// Where a character stands: steps and turns added up to a track over the ground, and back.
#pragma once
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A place on the ground and a heading: where the root stands after the last frame of a motion that is given
/// in steps. `started` tells whether there was such a frame: if not, the next frame stands at x, z, yaw
/// itself, and its own step and turn, which lead there from a frame that nobody knows, are left out.
struct RootTrack {
  double x = 0, z = 0;  ///< in the file's unit
  double yaw = 0;       ///< radians
  bool started = false;
  double height = 0;  ///< the root's y, in the file's unit; PositionLayout sets and reads it
};

/// Turns the ground coordinates by `yaw` radians about y, as axis_rotation(1, yaw) turns a vector.
inline void turn_ground(double& x, double& z, double yaw) {
  const double cosine = std::cos(yaw), sine = std::sin(yaw), old_x = x, old_z = z;
  x = cosine * old_x + sine * old_z;
  z = cosine * old_z - sine * old_x;
}

/// Takes the track one frame on: a step in the heading's frame of the frame before, then the turn.
inline void advance(RootTrack& track, double step_x, double step_z, double turn) {
  if (track.started) {
    turn_ground(step_x, step_z, track.yaw);
    track.x += step_x;
    track.z += step_z;
    track.yaw += turn;
  }
  track.started = true;
}

/// Where poses hold the root's track.
struct TrackDims {
  std::size_t yaw = 0;
  std::optional<std::size_t> position;  ///< of x; y and z follow
};

/// Poses [frames, dof] with the root's yaw (counted through whole turns) and position become poses with its
/// turn and step over `step` frames: the inverse of advance(). The first `step` frames have no predecessor:
/// they take the values of frame `step`, zeros where there is none.
inline void differ_track(std::span<double> poses, std::size_t dof, const TrackDims& dims, std::size_t step) {
  const std::size_t frames = poses.size() / dof;
  for (std::size_t f = frames; f-- > step;) {  // backwards: the earlier frame is needed as it was
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

/// The motion moved over the ground so that `root` in its frame 0 stands at the x, z of `to`; with `facing`
/// it is turned too, so that the root's yaw there is that of `to`. Heights stay. A motion without frames is
/// left as it is.
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
