// Loading labelled clips: finding files, reading them, resampling to one rate.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/action_options.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/position_clip.hpp"
#include "motiongan/motion/root_joint.hpp"

namespace motiongan::motion {

/// Joint positions of a motion at `rate` frames per second, of the joint `root` (negative: moving_root) and
/// those below it.
inline PositionClip positions_of(const Motion& motion, const std::string& id, double rate, int root = -1) {
  const Motion folded = fold_into_root(resample(motion, rate, id), root < 0 ? moving_root(motion) : root);
  return {id, folded.skeleton, rate, folded.frames, joint_positions(folded)};
}

/// The clip resampled to `rate` frames per second, linearly, from its first frame to at most its last. Throws
/// Error, naming the clip, if a rate is not positive, or for too many frames (see resampled_frames).
inline PositionClip resample(const PositionClip& clip, double rate) {
  const std::size_t joints = clip.skeleton.size();
  require(clip.positions.size() == clip.frames * joints, "clip '", clip.id, "' has ", clip.positions.size(),
          " positions, expected ", clip.frames, " frames x ", joints, " joints");
  const std::size_t frames = resampled_frames(clip.frames, clip.rate, rate, joints, clip.id);
  PositionClip out{clip.id, clip.skeleton, rate, frames, {}};
  out.positions.reserve(frames * joints);
  for (std::size_t f = 0; f < frames; ++f) {
    const BetweenFrames at = between_frames(f, clip.rate / rate, clip.frames);
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3 &a = clip.positions[at.before * joints + j], &b = clip.positions[at.after * joints + j];
      out.positions.push_back(at.t == 0 ? a : add(scale(a, 1 - at.t), scale(b, at.t)));
    }
  }
  return out;
}

namespace action_dataset_detail {

/// A clip as loaded for the data set.
struct Loaded {
  PositionClip clip;  ///< at the data set's rate
  double seconds = 0;
  int root = 0;                ///< the joint of the file that travels; joints above it are folded into it
  std::size_t dropped = 0;     ///< T-pose frames
  double height = 0;           ///< of the body, see body_height
  double unit_metres = 0;      ///< if the file says so; 0: unknown
  std::optional<UpAxis> up{};  ///< of the file; unset: unknown
  std::vector<std::string> notes{};
};

/// A candidate clip: its name and how to load it.
struct Source {
  std::string id;
  std::string name;                  ///< file name without extension, for labels and subjects
  std::optional<std::string> label;  ///< if the clip comes with one
  /// root negative: the clip's own
  std::function<Loaded(int root, const LoadChange&)> load{};
};

/// A time with two decimals: "1.40 s".
inline std::string seconds_text(double seconds) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

inline Loaded load_motion(LoadedMotion loaded, const std::string& id, double rate, int root) {
  const Motion& motion = loaded.motion;
  check_motion(motion);
  Loaded out;
  out.root = root < 0 ? moving_root(motion) : root;
  out.seconds = motion.frames == 0 ? 0 : static_cast<double>(motion.frames) / motion.rate;
  out.clip = positions_of(motion, id, rate, out.root);
  out.height = body_height(out.clip.skeleton);
  out.dropped = loaded.dropped;
  out.up = loaded.up;
  out.unit_metres = loaded.unit_metres;
  out.notes = std::move(loaded.notes);
  const std::vector<std::size_t> beside = joints_beside(motion.skeleton, out.root);
  if (!beside.empty())
    out.notes.push_back(concat("clip '", id, "': ", beside.size(), beside.size() == 1 ? " joint" : " joints",
                               " beside the body left out, first '",
                               motion.skeleton.joints[beside.front()].name, "'"));
  return out;
}

inline Loaded load_positions(const LoadedPositions& loaded, double rate) {
  const PositionClip& clip = loaded.clip;
  Loaded out;
  out.seconds = clip.frames == 0 ? 0 : static_cast<double>(clip.frames) / clip.rate;
  out.clip = resample(clip, rate);
  out.height = body_height(clip.skeleton);
  out.up = loaded.up;
  return out;
}

inline Loaded load_file(const std::filesystem::path& file, const std::string& id,
                        const ActionDatasetOptions& o, int root, const LoadChange& change) {
  const ClipOptions how = changed(o.clips, change);
  if (!holds_positions(file)) return load_motion(read_motion(file, how), id, o.rate, root);
  Loaded out = load_positions(read_positions(file, how, o.rate), o.rate);
  out.clip.id = id;
  return out;
}

/// The motion files of a folder but the label file and the bone list; or the file itself. Throws Error if
/// there are none.
inline std::vector<std::filesystem::path> clip_files(const std::filesystem::path& where,
                                                     const ActionDatasetOptions& options) {
  return find_motion_files(where, {options.labels, options.clips.bones});
}

}  // namespace action_dataset_detail

}  // namespace motiongan::motion
