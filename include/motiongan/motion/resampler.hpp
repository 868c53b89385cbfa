// Another rate for motion that comes in pieces, and for motion that is counted from its end.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// resample() for a motion that is still being made: the pieces that it gives back, joined, are the resampled
/// whole, bit for bit. Memory does not grow; of the motion it keeps what the next frame needs.
class Resampler {
 public:
  /// `frames` at `from` frames per second will come, to be made frames at `to`. Error if a rate is not
  /// positive.
  Resampler(std::size_t frames, double from, double to)
      : frames_(frames), total_(resampled_frames(frames, from, to)), from_(from), to_(to) {}

  /// Frames that all pieces together give.
  std::size_t total() const { return total_; }

  /// The frames that can be told now; perhaps none. Error for a piece of another rate or skeleton, or more
  /// frames than were announced.
  Motion append(Motion piece) {
    require(std::abs(piece.rate / from_ - 1) < 1e-6, "a piece of ", piece.rate,
            " frames per second cannot be resampled, expected ", from_);
    piece.rate = from_;
    held_ = held_.frames == 0 ? std::move(piece) : join(std::move(held_), piece);
    const std::size_t end = first_ + held_.frames;  // of what is known
    require(end <= frames_, end, " frames came to be resampled, expected the ", frames_, " announced");
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
  std::size_t frames_, total_, made_ = 0, first_ = 0;  // first_: the frame that held_ begins with
  double from_, to_;
  Motion held_;
};

/// As resample(), but counted back from the end: the last frame is the motion's last, and what is not a whole
/// number of steps is left out at the start. For a motion that is to be continued.
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
