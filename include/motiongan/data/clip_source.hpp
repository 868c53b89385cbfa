// Loading and encoding of clips on two threads, with results that do not depend on their timing.
#pragma once
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/data/dataset_options.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// What a data set changes in a clip to make it like the others.
struct LoadChange {
  std::optional<UpAxis> up{};  ///< instead of the one detected
  double scale = 1;            ///< lengths are multiplied by it
  bool operator==(const LoadChange&) const = default;
};

/// The options with the change.
inline ClipOptions changed(ClipOptions options, const LoadChange& change) {
  if (change.up) options.up = change.up;
  options.scale *= change.scale;
  return options;
}

/// A motion in memory for a data set; it is y up.
inline LoadedMotion in_memory(const Motion& motion, const LoadChange& change) {
  LoadedMotion out;
  out.motion = scaled(motion, change.scale);
  return out;
}

/// A candidate clip: its name and how to load its motion.
struct ClipSource {
  std::string id;
  std::string name;                                     ///< path of the file, if any, for captions from names
  std::vector<std::string> captions;                    ///< those it comes with, may be empty
  std::function<LoadedMotion(const LoadChange&)> load;  ///< reads it; throws Error if that fails
  std::string whole = {};               ///< id of the clip that this is a part of; empty if it is none
  std::vector<CaptionPart> parts = {};  ///< if captions describe only parts of the clip: these parts
};

/// A clip's poses, and what is needed to match it with others.
struct EncodedClip {
  Skeleton skeleton;                 ///< of the clip
  double source_rate = 0;            ///< frames per second of the file
  std::size_t source_frames = 0;     ///< at that rate
  std::size_t stride = 0;            ///< frames of `poses` between two frames of a window
  int root = 0;                      ///< the joint that travels
  double height = 0;                 ///< of the body, see body_height
  double unit_metres = 0;            ///< if the file says so; 0: unknown
  std::optional<UpAxis> up{};        ///< of the file; unset: unknown
  std::size_t dropped = 0;           ///< frames removed at the start
  std::vector<std::string> notes{};  ///< what was corrected
  std::size_t frames = 0;            ///< of `poses`; 0 if the clip is too short
  std::vector<double> poses;         ///< [frames, full dof]
  /// The length of the clip.
  double seconds() const { return source_frames == 0 ? 0 : static_cast<double>(source_frames) / source_rate; }
};

/// Frames of a clip at `source_rate` between two frames of a window at `rate`: their ratio if it is an
/// integer, else rounded down (the clip is then resampled to rate * stride), at least 1.
inline std::size_t natural_stride(double source_rate, double rate) {
  const double ratio = source_rate / rate;
  const double whole = std::round(ratio);
  if (whole >= 1 && std::abs(ratio - whole) < 1e-6 * ratio) return static_cast<std::size_t>(whole);
  return static_cast<std::size_t>(std::max(1.0, std::floor(ratio)));
}

/// Whether the clip lasts at least as long as `frames` frames at `rate`.
inline bool long_enough(const EncodedClip& clip, std::size_t frames, double rate) {
  return clip.seconds() >= static_cast<double>(frames) / rate * (1 - 1e-9);
}

/// Runs `work(i)` for 0 <= i < count on two threads; of several exceptions, that of the smallest i is
/// rethrown.
inline void in_two_threads(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::vector<std::exception_ptr> errors(count);
  std::atomic<std::size_t> next{0};
  const auto worker = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    }
  };
  std::thread second(worker);  // it catches all that is thrown
  worker();
  second.join();
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

/// The same, but returns the messages of Errors, [count]; empty where there was none.
inline std::vector<std::string> errors_in_two_threads(std::size_t count,
                                                      const std::function<void(std::size_t)>& work) {
  std::vector<std::string> errors(count);
  in_two_threads(count, [&](std::size_t i) {
    try {
      work(i);
    } catch (const Error& error) {
      errors[i] = error.what();
    }
  });
  return errors;
}

/// Encodes a clip at its natural stride (`stride` 0) or the given one. Its root position is that of its own
/// travelling joint (`root` -1) or of the given joint. Clips too short for a window are not encoded.
inline EncodedClip encode_clip(Motion motion, const DatasetOptions& options, std::size_t stride, int root) {
  const auto [frames, rate] = std::pair{options.frames, options.rate};
  EncodedClip out;
  check_motion(motion);
  out.source_rate = motion.rate;
  out.source_frames = motion.frames;
  out.root = root < 0 ? moving_root(motion) : root;
  out.stride = stride != 0 ? stride : natural_stride(motion.rate, rate);
  out.skeleton = motion.skeleton;
  out.height = body_height(out.skeleton);
  if (!long_enough(out, frames, rate)) return out;
  const double target = rate * static_cast<double>(out.stride);
  if (std::abs(motion.rate / target - 1) > 1e-6) motion = resample(motion, target);
  out.frames = motion.frames;
  out.poses =
      PoseLayout(out.skeleton, options.root_position, static_cast<std::size_t>(out.root), options.rotation())
          .encode(motion, out.stride);
  return out;
}

/// The same, with what is known of the file. Throws Error, naming the clip `id`, if it cannot be encoded.
inline EncodedClip encode_clip(LoadedMotion loaded, const DatasetOptions& options, std::size_t stride,
                               int root, const std::string& id) {
  EncodedClip out;
  try {
    out = encode_clip(std::move(loaded.motion), options, stride, root);
  } catch (const Error& error) {
    throw Error("clip '", id, "': ", error.what());
  }
  out.up = loaded.up;
  out.unit_metres = loaded.unit_metres;
  out.dropped = loaded.dropped;
  out.notes = std::move(loaded.notes);
  return out;
}

}  // namespace motiongan::motion
