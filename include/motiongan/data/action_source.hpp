// Loading labelled clips: finding files, reading them, resampling to one rate.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/action_options.hpp"
#include "motiongan/data/first_frame.hpp"
#include "motiongan/formats/bvh_reader.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

/// Joint positions of a motion at `rate` frames per second, of the joint `root` (negative: moving_root) and
/// those below it.
inline PositionClip positions_of(const Motion& motion, const std::string& id, double rate, int root = -1) {
  const Motion folded = fold_into_root(resample(motion, rate), root < 0 ? moving_root(motion) : root);
  return {id, folded.skeleton, rate, folded.frames, joint_positions(folded)};
}

/// The clip resampled to `rate` frames per second, linearly, from its first frame to at most its last. Throws
/// Error if a rate is not positive.
inline PositionClip resample(const PositionClip& clip, double rate) {
  const std::size_t joints = clip.skeleton.size();
  require(clip.positions.size() == clip.frames * joints, "clip '", clip.id, "' has ", clip.positions.size(),
          " positions, expected ", clip.frames, " frames x ", joints, " joints");
  const std::size_t frames = resampled_frames(clip.frames, clip.rate, rate);
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
  int root = 0;             ///< the joint of the file that travels; joints above it are folded into it
  std::size_t dropped = 0;  ///< T-pose frames
};

/// A candidate clip: its name and how to load it.
struct Source {
  std::string id;
  std::string name;                        ///< file name without extension, for labels and subjects
  std::optional<std::string> label;        ///< if the clip comes with one
  std::function<Loaded(int root)> load{};  ///< root negative: the clip's own
};

/// A time with two decimals: "1.40 s".
inline std::string seconds_text(double seconds) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

inline Loaded load_motion(const Motion& motion, const std::string& id, double rate, int root) {
  check_motion(motion);
  Loaded out;
  out.root = root < 0 ? moving_root(motion) : root;
  out.seconds = motion.frames == 0 ? 0 : static_cast<double>(motion.frames) / motion.rate;
  out.clip = positions_of(motion, id, rate, out.root);
  return out;
}

inline Loaded load_positions(const PositionClip& clip, double rate) {
  Loaded out;
  out.seconds = clip.frames == 0 ? 0 : static_cast<double>(clip.frames) / clip.rate;
  out.clip = resample(clip, rate);
  return out;
}

inline Loaded load_file(const std::filesystem::path& file, const std::string& id,
                        const ActionDatasetOptions& o, int root) {
  if (extension_of(file) != ".bvh") {
    Loaded out = load_positions(read_position_file(file, o.bones, o.rate), o.rate);
    out.clip.id = id;
    return out;
  }
  Clip clip = read_bvh(file);
  const std::size_t dropped = drop_first_frames(clip, o.first_frame);
  Loaded out = load_motion(to_motion(clip), id, o.rate, root);
  out.dropped = dropped;
  return out;
}

/// The clips of a folder: all .bvh, .csv and .npy files but the label file and the bone list; or the file
/// itself. Throws Error if there are none.
inline std::vector<std::filesystem::path> clip_files(const std::filesystem::path& where,
                                                     const ActionDatasetOptions& options) {
  return find_clip_files(where, {".bvh", ".csv", ".npy"}, {options.labels, options.bones});
}

}  // namespace action_dataset_detail

}  // namespace motiongan::motion
