// Finding and dropping the T-pose that some conversions prepend to a clip.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "motiongan/core/error.hpp"
#include "motiongan/core/fields.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// What to do with a clip's first frame, which in the CMU conversions is an added T-pose.
enum class FirstFrame {
  automatic,  ///< drop the frames that t_pose_frames finds
  keep,
  drop  ///< always drop frame 0
};
constexpr NameTable<FirstFrame, 3> enum_names(FirstFrame) {
  return {{{FirstFrame::automatic, "auto"}, {FirstFrame::keep, "keep"}, {FirstFrame::drop, "drop"}}};
}

namespace first_frame_detail {

/// Whether every rotation of the frame is a whole number of degrees and most are zero.
inline bool is_posed(const Clip& clip, std::size_t frame) {
  std::size_t turns = 0, zeros = 0, at = frame * clip.skeleton.channel_count();
  for (const Joint& joint : clip.skeleton.joints) {
    for (const Channel c : joint.channels) {
      const double value = clip.channels[at++];
      if (!is_rotation(c)) continue;
      if (value != std::round(value)) return false;
      ++turns;
      zeros += value == 0;
    }
  }
  return 2 * zeros > turns;
}

/// The largest change of a rotation channel between two frames, in degrees.
inline double step_between(const Clip& clip, std::size_t a, std::size_t b) {
  const std::size_t width = clip.skeleton.channel_count();
  double largest = 0;
  std::size_t i = 0;
  for (const Joint& joint : clip.skeleton.joints) {
    for (const Channel c : joint.channels) {
      const double change = clip.channels[a * width + i] - clip.channels[b * width + i];
      if (is_rotation(c)) largest = std::max(largest, std::abs(std::remainder(change, 360.0)));
      ++i;
    }
  }
  return largest;
}

}  // namespace first_frame_detail

/// Number of frames at the start that are a pose prepended to the motion: up to four frames whose rotations
/// are whole numbers of degrees and mostly zero (in the CMU files all but seven, which are angles such as
/// 21), followed by a jump of more than one degree and more than three times the next step. 0 if the clip
/// starts with its motion.
inline std::size_t t_pose_frames(const Clip& clip) {
  namespace detail = first_frame_detail;
  require(clip.channels.size() == clip.frames * clip.skeleton.channel_count(), "clip '", clip.id, "' has ",
          clip.channels.size(), " values, expected ", clip.frames, " frames x ",
          clip.skeleton.channel_count(), " channels");
  std::size_t posed = 0;
  while (posed < clip.frames && posed < 5 && detail::is_posed(clip, posed)) ++posed;
  if (posed == 0 || posed == 5 || posed == clip.frames) return 0;
  const double jump = detail::step_between(clip, posed - 1, posed);
  const double step = posed + 1 < clip.frames ? detail::step_between(clip, posed, posed + 1) : 0;
  return jump > 1 && jump > 3 * step ? posed : 0;
}

/// Removes the first frames according to `rule`; returns how many.
inline std::size_t drop_first_frames(Clip& clip, FirstFrame rule) {
  std::size_t count = 0;
  if (rule == FirstFrame::automatic) count = t_pose_frames(clip);
  if (rule == FirstFrame::drop) count = std::min<std::size_t>(1, clip.frames);
  const std::size_t values = count * clip.skeleton.channel_count();
  clip.channels.erase(clip.channels.begin(), clip.channels.begin() + static_cast<std::ptrdiff_t>(values));
  clip.frames -= count;
  return count;
}

}  // namespace motiongan::motion
