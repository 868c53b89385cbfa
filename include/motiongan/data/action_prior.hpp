// The prior of an attention model, the given second of motion, taken from a clip.
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/data/action_dataset.hpp"
#include "motiongan/data/action_source.hpp"
#include "motiongan/data/position_format.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan {
namespace motion {

/// The T frames that precede generated motion, at the format's rate.
struct ActionPrior {
  std::string id;                 ///< id of the clip
  std::size_t first_frame = 0;    ///< in the clip, at the format's rate
  Skeleton skeleton;              ///< with the clip's own bone lengths
  std::vector<float> poses;       ///< [T, dof], normalised
  std::vector<Vec3> positions;    ///< [T, joints], world space, in the clip's unit
  std::vector<RootTrack> places;  ///< [T], position and heading of the root
};

/// A BVH motion as a position clip at the format's rate, from the format's root joint down. Throws Error if
/// the skeleton has no joint of that name.
inline PositionClip clip_for(const Motion& motion, const PositionFormat& format, const std::string& id) {
  const int root = motion.skeleton.find(format.skeleton().joints.front().name);
  require(root >= 0, "the clip ", id, " has no joint '", format.skeleton().joints.front().name,
          "', the root of the model's skeleton");
  return positions_of(motion, id, format.rate, root);
}

/// The T frames of `clip` from `first_frame`, counted at the format's rate; a clip of another rate is
/// resampled. Throws Error for another skeleton, naming the joints, and if the clip is too short.
inline ActionPrior prior_from(const PositionClip& clip, const PositionFormat& format,
                              std::size_t first_frame = 0) {
  format.require_skeleton(clip.skeleton, "the prior " + clip.id);
  const bool same_rate = std::abs(clip.rate / format.rate - 1) < 1e-6;
  const PositionClip own = same_rate ? PositionClip{} : resample(clip, format.rate);
  const PositionClip& at_rate = same_rate ? clip : own;
  const std::size_t needed = format.frames, joints = clip.skeleton.size(), end = first_frame + needed;
  const auto seconds = [&](std::size_t frames) {
    return action_dataset_detail::seconds_text(static_cast<double>(frames) / format.rate);
  };
  const std::size_t left = at_rate.frames - std::min(at_rate.frames, first_frame);
  require(first_frame < at_rate.frames && left >= needed, "the prior ", clip.id, " has ", left, " frames (",
          seconds(left), ") from frame ", first_frame, " (", seconds(first_frame), ") on, at ", format.rate,
          " per second; ", needed, " frames (", seconds(needed),
          ") are needed: give a clip of at least that, ", "or start earlier");
  // Root steps are relative to the previous frame, so encode from the clip's start, not from first_frame.
  const std::span<const Vec3> before(at_rate.positions.data(), end * joints);
  ActionPrior out{clip.id, first_frame, clip.skeleton, {}, {}, {}};
  std::vector<RootTrack> places;
  try {
    places = format.layout.places(before);
  } catch (const Error& error) {
    throw Error("the prior ", clip.id, ": ", error.what());
  }
  const std::vector<float> poses = format.normalizer.normalize<float>(format.layout.encode(before, places));
  const auto tail = [&](const auto& all, std::size_t width) {
    return std::decay_t<decltype(all)>(all.end() - static_cast<std::ptrdiff_t>(needed * width), all.end());
  };
  out.poses = tail(poses, format.dof());
  out.places = tail(places, 1);
  out.positions.assign(before.end() - static_cast<std::ptrdiff_t>(needed * joints), before.end());
  return out;
}

inline PositionClip ActionDataset::clip(const ActionClip& clip) const {
  return {clip.id, clip.skeleton, format.rate, clip.frames, format.restore(clip.poses, clip.places)};
}

inline ActionPrior ActionDataset::prior(const ActionClip& of, std::size_t first_frame) const {
  return prior_from(clip(of), format, first_frame);
}

}  // namespace motion

using motion::ActionPrior;
using motion::prior_from;

}  // namespace motiongan
