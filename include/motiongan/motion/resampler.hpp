// Resampling of motion that arrives in pieces, and resampling aligned to the last frame.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Streaming version of resample(): the pieces it returns, joined, equal the resampled whole bit for bit.
/// Memory use is bounded: only the frames needed next are kept.
class Resampler {
 public:
  /// For `frames` input frames at `from` frames per second, output at `to`. Throws Error if a rate is not
  /// positive.
  Resampler(std::size_t frames, double from, double to)
      : frames_(frames), total_(resampled_frames(frames, from, to)), from_(from), to_(to) {}

  /// Total number of output frames.
  std::size_t total() const { return total_; }

  /// Returns the output frames that can be computed so far, possibly none. Throws Error for a piece with
  /// another rate or skeleton, or more frames than announced.
  Motion append(Motion piece) {
    require(std::abs(piece.rate / from_ - 1) < 1e-6, "a piece of ", piece.rate,
            " frames per second was appended to a resampler, expected ", from_);
    piece.rate = from_;
    held_ = held_.frames == 0 ? std::move(piece) : join(std::move(held_), piece);
    const std::size_t end = first_ + held_.frames;  // of the input so far
    require(end <= frames_, "got ", end, " frames to resample, expected the ", frames_, " announced");
    Motion out;
    out.skeleton = held_.skeleton;
    out.rate = to_;
    std::size_t needed = end;
    for (; made_ < total_; ++made_) {
      BetweenFrames at =
          from_ == to_ ? BetweenFrames{made_, made_, 0} : between_frames(made_, from_ / to_, frames_);
      needed = at.before;
      if (at.after >= end) break;
      at.before -= first_;
      at.after -= first_;
      append_between(held_, at, out);
      needed = end;
    }
    const std::size_t gone = std::min(needed - first_, held_.frames);
    held_ = slice(held_, gone, held_.frames - gone);
    first_ += gone;
    return out;
  }

 private:
  std::size_t frames_, total_, made_ = 0, first_ = 0;  // first_: input frame at which held_ starts
  double from_, to_;
  Motion held_;
};

/// Like resample(), but aligned to the end: the last frame is kept, and a remainder shorter than one step is
/// dropped at the start. For a motion that will be continued.
inline Motion resample_to_end(const Motion& motion, double rate) {
  const auto reversed = [](const Motion& m) {
    Motion out = m;
    const std::size_t joints = m.skeleton.size();
    for (std::size_t f = 0; f < m.frames; ++f)
      for (std::size_t j = 0; j < joints; ++j) {
        out.rotation(f, j) = m.rotation(m.frames - 1 - f, j);
        out.position(f, j) = m.position(m.frames - 1 - f, j);
      }
    return out;
  };
  check_motion(motion);
  return reversed(resample(reversed(motion), rate));
}

}  // namespace motiongan::motion
