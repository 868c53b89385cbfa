// Cleaning up a motion that is still being made: with a bounded delay, in memory that does not grow.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/motion.hpp"

namespace motiongan::motion {

/// Cleans up a motion that comes in pieces, as clean() does a whole one. Every half second is cleaned up
/// together with the second before and the second after it, and the changes from one to the next are smooth.
/// So a frame comes out at most 1.5 seconds after it went in, and what comes out does not depend on the
/// pieces, bit for bit. A motion of up to that length is cleaned up as by clean(). The floor, if it is not
/// given, is that of the first 1.5 seconds.
///
///     CleanStream cleaner;
///     while (...) {
///       stream.step();
///       draw(cleaner.push(stream.motion(id)));   // no frame for 1.5 s, then one for each
///     }
///     draw(cleaner.finish());                    // the last 1.5 s
class CleanStream {
 public:
  /// Throws Error for options out of range.
  explicit CleanStream(CleanOptions options = {}) : options_(std::move(options)), floor_(options_.floor) {
    check(options_);
  }

  /// The frames that are ready now, the next ones of the motion; perhaps none. Throws Error if the number of
  /// joints or the rate is not that of the pieces before and, with `feet`, for a skeleton without legs.
  Motion push(const Motion& piece) {
    raw_ = raw_.skeleton.size() == 0 ? piece : join(std::move(raw_), piece);
    Motion out = slice(raw_, 0, 0);
    while (raw_.frames - done_ >= frames_of(step) + frames_of(margin))
      out = join(std::move(out), cleaned(frames_of(step)));
    return out;
  }

  /// All frames that are left. The next piece begins a new motion. Without any piece: an empty motion.
  Motion finish() {
    Motion out = raw_.frames > done_ ? cleaned(raw_.frames - done_) : std::exchange(raw_, {});
    *this = CleanStream(std::move(options_));
    return out;
  }

 private:
  // In seconds: what is cleaned up at a time; what is looked at before and after that, some more than the
  // longest reach of clean(); and how long the change from one result to the next takes.
  static constexpr double step = 0.5, margin = 1, change = 0.25;

  std::size_t frames_of(double seconds) const {
    return std::max<std::size_t>(static_cast<std::size_t>(std::round(seconds * raw_.rate)), 1);
  }

  /// The next `count` frames.
  Motion cleaned(std::size_t count) {
    const std::size_t end = std::min(done_ + count + frames_of(margin), raw_.frames);
    if (options_.feet && !floor_) {
      const Motion seen = slice(raw_, 0, end);
      floor_ = floor_under(options_.smooth ? low_pass(seen, options_.cutoff) : seen, options_.foot_joints);
    }
    CleanOptions now = options_;
    now.floor = floor_, now.given = 0;
    const Motion window = clean(slice(raw_, 0, end), now);
    Motion out = slice(window, done_, count);
    for (std::size_t f = 0; f < std::min(before_.frames, count); ++f)
      clean_detail::blend_frame(
          before_, out, f,
          clean_detail::ease(static_cast<double>(f + 1) / static_cast<double>(before_.frames + 1)));
    out = clean_detail::after_given(slice(raw_, done_, count), std::move(out), options_.given,
                                    2 * options_.blend * raw_.rate, dropped_ + done_);
    done_ += count;
    before_ = slice(window, done_, std::min(frames_of(change), end - done_));
    const std::size_t old = done_ - std::min(frames_of(margin), done_);
    raw_ = slice(raw_, old, raw_.frames - old);
    done_ -= old, dropped_ += old;
    return out;
  }

  CleanOptions options_;
  std::optional<double> floor_;  ///< in the file's unit
  Motion raw_;                   ///< as it came, from frame `dropped_` of the motion on
  std::size_t done_ = 0;         ///< frames of `raw_` that have come out
  std::size_t dropped_ = 0;
  Motion before_;  ///< the first frames after them, as they were cleaned up with those before
};

}  // namespace motiongan::motion
