// From BVH's channels to local rotations and back, and changing a motion's rate and length.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Frames per second of a frame time as files print it: 0.0083333 means 120. A rate within 0.05% of a whole
/// number is that number (29.97 and 59.94, 0.1% off, stay what they are).
inline double rate_from_frame_time(double frame_time) {
  require(std::isfinite(frame_time) && frame_time > 0, "frame time ", frame_time,
          " seconds, expected a positive number");
  const double rate = 1.0 / frame_time, whole = std::round(rate);
  return std::abs(rate - whole) <= 5e-4 * rate ? whole : rate;
}

/// The clip's channels as local rotations and positions. A position channel replaces its part of the joint's
/// offset; joints without rotation channels do not turn.
inline Motion to_motion(const Clip& clip) {
  const std::size_t joints = clip.skeleton.size(), width = clip.skeleton.channel_count();
  require(clip.channels.size() == clip.frames * width, "clip '", clip.id, "' has ", clip.channels.size(),
          " values, expected ", clip.frames, " frames x ", width, " channels");
  Motion motion;
  motion.skeleton = clip.skeleton;
  motion.rate = rate_from_frame_time(clip.frame_time);
  motion.frames = clip.frames;
  motion.rotations.resize(clip.frames * joints);
  motion.positions.resize(clip.frames * joints);
  std::vector<EulerOrder> orders;
  for (const Joint& j : clip.skeleton.joints) orders.emplace_back(j.channels);
  const double* value = clip.channels.data();
  for (std::size_t f = 0; f < clip.frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const Joint& joint = clip.skeleton.joints[j];
      Vec3 position = joint.offset, angles{};
      std::size_t turn = 0;
      for (const Channel c : joint.channels) {
        if (is_rotation(c))
          angles[turn++] = radians(*value++);
        else
          position[axis(c)] = *value++;
      }
      motion.rotation(f, j) = quat_from_euler(orders[j], angles);
      motion.position(f, j) = position;
    }
  }
  return motion;
}

/// Local rotations as Euler angles in each joint's order, continuous over all the frames that it was ever
/// given: a motion may come in pieces. What a joint has no channel for is left out (a rotation about a
/// missing axis, a position without position channels).
class ChannelEncoder {
 public:
  explicit ChannelEncoder(const Skeleton& skeleton) : previous_(skeleton.size(), Vec3{}) {
    for (const Joint& j : skeleton.joints) {
      channels_.push_back(j.channels);
      orders_.emplace_back(j.channels);
    }
  }

  /// Appends the motion's channels [frames, channels] to `out`: degrees and length units, as in a Clip. Error
  /// if the motion has another number of joints.
  void append(const Motion& motion, std::vector<double>& out) {
    check_motion(motion);
    require(motion.skeleton.size() == orders_.size(), "a motion of ", motion.skeleton.size(),
            " joints does not fit the channels of ", orders_.size(), " joints");
    for (std::size_t f = 0; f < motion.frames; ++f, started_ = true) {
      for (std::size_t j = 0; j < orders_.size(); ++j) {
        const Quat& q = motion.rotation(f, j);
        // The first frame has nothing to be continuous with: it takes the smallest angles.
        const Vec3 angles =
            started_ ? euler_from_quat_near(orders_[j], q, previous_[j]) : euler_from_quat(orders_[j], q);
        previous_[j] = angles;
        std::size_t turn = 0;
        for (const Channel c : channels_[j])
          out.push_back(is_rotation(c) ? degrees(angles[turn++]) : motion.position(f, j)[axis(c)]);
      }
    }
  }

 private:
  std::vector<std::vector<Channel>> channels_;  // of each joint
  std::vector<EulerOrder> orders_;
  std::vector<Vec3> previous_;  // angles of the frame before, [joints]
  bool started_ = false;
};

/// The motion in its skeleton's own channels, see ChannelEncoder.
inline Clip to_clip(const Motion& motion, std::string id) {
  check_motion(motion);
  require(motion.rate > 0, "motion '", id, "' has a rate of ", motion.rate,
          " frames per second, expected more than 0");
  Clip clip;
  clip.id = std::move(id);
  clip.skeleton = motion.skeleton;
  clip.frame_time = 1.0 / motion.rate;
  clip.frames = motion.frames;
  clip.channels.reserve(motion.frames * motion.skeleton.channel_count());
  ChannelEncoder(motion.skeleton).append(motion, clip.channels);
  return clip;
}

/// The motion between its first and last frame at another rate: rotations by slerp, positions linearly. The
/// new frames lie at 0, 1/rate, 2/rate ... and none after the last old one.
inline Motion resample(const Motion& motion, double rate) {
  check_motion(motion);
  require(std::isfinite(rate) && rate > 0, "cannot resample to ", rate,
          " frames per second, expected more than 0");
  if (motion.frames == 0 || rate == motion.rate) {
    Motion same = motion;
    same.rate = rate;
    return same;
  }
  const std::size_t joints = motion.skeleton.size();
  const std::size_t last = motion.frames - 1;
  const double step = motion.rate / rate;  // old frames per new one
  const double count = std::floor(static_cast<double>(last) / step * (1 + 1e-12) + 1e-9);
  require(count < 1e9, "resampling ", motion.frames, " frames from ", motion.rate, " to ", rate,
          " per second would make ", count, " frames, expected fewer than 1e9");
  Motion out;
  out.skeleton = motion.skeleton;
  out.rate = rate;
  out.frames = static_cast<std::size_t>(count) + 1;
  out.rotations.reserve(out.frames * joints);
  out.positions.reserve(out.frames * joints);
  for (std::size_t f = 0; f < out.frames; ++f) {
    const double at = std::min(static_cast<double>(f) * step, static_cast<double>(last));
    const double nearest = std::round(at);
    const bool exact = std::abs(at - nearest) < 1e-9;  // an old frame is taken as it is
    const auto before = static_cast<std::size_t>(exact ? nearest : std::floor(at));
    const std::size_t after = std::min(before + 1, last);
    const double t = exact ? 0 : at - std::floor(at);
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3 &a = motion.position(before, j), &b = motion.position(after, j);
      out.positions.push_back(t == 0 ? a : add(scale(a, 1 - t), scale(b, t)));
      out.rotations.push_back(t == 0 ? motion.rotation(before, j)
                                     : slerp(motion.rotation(before, j), motion.rotation(after, j), t));
    }
  }
  return out;
}

/// Frames first .. first + count - 1; Error where the motion does not have them.
inline Motion slice(const Motion& motion, std::size_t first, std::size_t count) {
  check_motion(motion);
  require(first <= motion.frames && count <= motion.frames - first, "cannot take frames ", first, " to ",
          first + count, " of a motion of ", motion.frames);
  const auto joints = static_cast<std::ptrdiff_t>(motion.skeleton.size());
  const auto begin = static_cast<std::ptrdiff_t>(first) * joints;
  const auto end = begin + static_cast<std::ptrdiff_t>(count) * joints;
  Motion out;
  out.skeleton = motion.skeleton;
  out.rate = motion.rate;
  out.frames = count;
  out.rotations.assign(motion.rotations.begin() + begin, motion.rotations.begin() + end);
  out.positions.assign(motion.positions.begin() + begin, motion.positions.begin() + end);
  return out;
}

}  // namespace motiongan::motion
