// Conversion between BVH channels and local rotations; resampling, slicing and joining of motions.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/frame_rate.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A clip's channels as local rotations and positions. A position channel replaces that component of the
/// joint's offset; joints without rotation channels do not rotate. Throws Error if the number of channel
/// values is wrong.
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

/// Converts local rotations to Euler angles in each joint's channel order, continuous over all frames
/// appended so far, so a motion may come in pieces. Anything without a channel is lost (a rotation about a
/// missing axis, a position without position channels).
class ChannelEncoder {
 public:
  explicit ChannelEncoder(const Skeleton& skeleton) : previous_(skeleton.size(), Vec3{}) {
    for (const Joint& j : skeleton.joints) {
      channels_.push_back(j.channels);
      orders_.emplace_back(j.channels);
    }
  }

  /// Appends the motion's channels [frames, channels] to `out`, in degrees and length units as in a Clip.
  /// Throws Error if the number of joints differs.
  void append(const Motion& motion, std::vector<double>& out) {
    check_motion(motion);
    require(motion.skeleton.size() == orders_.size(), "a motion of ", motion.skeleton.size(),
            " joints does not fit the channels of ", orders_.size(), " joints");
    for (std::size_t f = 0; f < motion.frames; ++f, started_ = true) {
      for (std::size_t j = 0; j < orders_.size(); ++j) {
        const Quat& q = motion.rotation(f, j);
        // The first frame has no predecessor: it takes the smallest angles.
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
  std::vector<std::vector<Channel>> channels_;  // per joint
  std::vector<EulerOrder> orders_;
  std::vector<Vec3> previous_;  // angles of the previous frame, [joints]
  bool started_ = false;
};

/// The motion in its skeleton's own channels, with continuous Euler angles (see ChannelEncoder). Throws Error
/// if the rate is not positive.
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

/// Where a resampled frame lies: a fraction `t` of the way from source frame `before` to `after`.
struct BetweenFrames {
  std::size_t before = 0, after = 0;  ///< equal if a source frame is used unchanged
  double t = 0;                       ///< 0 at `before`, 1 at `after`
};

/// Number of frames that resample() makes from `frames` frames. Throws Error if a rate is not positive, or
/// for a billion frames or more.
inline std::size_t resampled_frames(std::size_t frames, double from, double to) {
  require(std::isfinite(to) && to > 0 && std::isfinite(from) && from > 0, "cannot resample from ", from,
          " to ", to, " frames per second, expected more than 0");
  if (frames == 0 || from == to) return frames;
  const double count = std::floor(static_cast<double>(frames - 1) * to / from * (1 + 1e-12) + 1e-9);
  require(count < 1e9, "resampling ", frames, " frames from ", from, " to ", to, " per second would make ",
          count, " frames, expected fewer than 1e9");
  return static_cast<std::size_t>(count) + 1;
}

/// The same for a clip of `joints` joints that is resampled in memory. Throws Error, starting with `name` if
/// that is given, also if it would become both longer than it is and larger than 50 million joint positions:
/// a clip whose frame time is wrong by a factor of a million lasts for years.
inline std::size_t resampled_frames(std::size_t frames, double from, double to, std::size_t joints,
                                    std::string_view name) {
  constexpr double most = 5e7;
  const auto [n, j] = std::pair{static_cast<double>(frames), static_cast<double>(joints)};
  const double made = n * to / from;
  require(!(made > n && made * j > most), name, name.empty() ? "" : ": ", "resampling ", frames,
          " frames from ", from, " to ", to, " per second (", n / from, " s) would make ", made,
          " frames of ", joints, " joints, expected at most ", std::floor(most / std::max(j, 1.0)),
          "; is the clip's frame time right? --fps gives its rate");
  return resampled_frames(frames, from, to);
}

/// Where output frame `f` lies in a motion of `frames` frames; `step` is the number of source frames per
/// output frame.
inline BetweenFrames between_frames(std::size_t f, double step, std::size_t frames) {
  const double at = std::min(static_cast<double>(f) * step, static_cast<double>(frames - 1));
  const double nearest = std::round(at);
  if (std::abs(at - nearest) < 1e-9) {  // use a source frame unchanged
    const auto same = static_cast<std::size_t>(nearest);
    return {same, same, 0};
  }
  const auto before = static_cast<std::size_t>(std::floor(at));
  return {before, before + 1, at - std::floor(at)};
}

/// Appends the interpolated frame to `out`: rotations by slerp, positions linearly.
inline void append_between(const Motion& motion, const BetweenFrames& at, Motion& out) {
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    const Vec3 &a = motion.position(at.before, j), &b = motion.position(at.after, j);
    const Quat &q = motion.rotation(at.before, j), &r = motion.rotation(at.after, j);
    out.positions.push_back(at.t == 0 ? a : add(scale(a, 1 - at.t), scale(b, at.t)));
    out.rotations.push_back(at.t == 0 ? q : slerp(q, r, at.t));
  }
  ++out.frames;
}

/// The motion resampled to `rate` frames per second: rotations by slerp, positions linearly. The output
/// frames lie at 0, 1/rate, 2/rate, ... seconds, none after the last source frame. `name` is the clip's, for
/// messages. Throws Error if a rate is not positive, or for too many frames (see resampled_frames).
inline Motion resample(const Motion& motion, double rate, std::string_view name = {}) {
  check_motion(motion);
  require(std::isfinite(rate) && rate > 0, "cannot resample to ", rate,
          " frames per second, expected more than 0");
  Motion out;
  if (motion.frames == 0 || rate == motion.rate) {
    out = motion;
    out.rate = rate;
    return out;
  }
  const std::size_t frames = resampled_frames(motion.frames, motion.rate, rate, motion.skeleton.size(), name);
  out.skeleton = motion.skeleton;
  out.rate = rate;
  out.rotations.reserve(frames * motion.skeleton.size());
  out.positions.reserve(frames * motion.skeleton.size());
  for (std::size_t f = 0; f < frames; ++f)
    append_between(motion, between_frames(f, motion.rate / rate, motion.frames), out);
  return out;
}

/// Frames first .. first + count - 1. Throws Error if the motion does not have them.
inline Motion slice(const Motion& motion, std::size_t first, std::size_t count) {
  check_motion(motion);
  require(first <= motion.frames && count <= motion.frames - first, "cannot take frames ", first, " to ",
          first + count, " of a motion of ", motion.frames, " frames");
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

/// `second` appended to `first`, in the skeleton of `first`. Throws Error if the numbers of joints or the
/// rates differ.
inline Motion join(Motion first, const Motion& second) {
  check_motion(first);
  check_motion(second);
  require(first.skeleton.size() == second.skeleton.size() && first.rate == second.rate, "a motion of ",
          second.skeleton.size(), " joints at ", second.rate, " frames per second cannot follow one of ",
          first.skeleton.size(), " joints at ", first.rate);
  first.frames += second.frames;
  first.rotations.insert(first.rotations.end(), second.rotations.begin(), second.rotations.end());
  first.positions.insert(first.positions.end(), second.positions.begin(), second.positions.end());
  return first;
}

}  // namespace motiongan::motion
