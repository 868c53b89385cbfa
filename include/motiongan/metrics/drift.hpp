// Drift of long generated motion: statistics of its poses, second by second.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/motion_format.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan {

/// Statistics of the poses of one second, or the mean of several such rows weighted by their frames. All
/// values but `outside` are in normalised units (standard deviations of the training data).
struct DriftRow {
  std::size_t second = 0, frames = 0;
  double mean = 0;     ///< distance of the mean pose from the training mean, RMS over dimensions
  double spread = 0;   ///< standard deviation over the second, RMS over dimensions
  double speed = 0;    ///< change of the pose per second, RMS over dimensions, mean over frames
  double outside = 0;  ///< fraction of values outside the training range, widened by 5% of its width at
                       ///< each end; NaN if the range is unknown
};

/// A whole motion, and its first and last tenth (in seconds, at least one second).
struct DriftSummary {
  double seconds = 0;
  DriftRow whole, first, last;  ///< `second` is that of the first row, `frames` the sum
};

/// Accumulates statistics of poses as they are generated. Memory grows by one row per second.
class DriftMeter {
 public:
  /// Measures motion of this format.
  explicit DriftMeter(const motion::MotionFormat& format)
      : rate_(format.rate), dof_(format.dof()), sum_(dof_), squares_(dof_), before_(dof_) {
    format.check();
    for (std::size_t k = 0; k < format.low.size(); ++k) {
      const double margin = 0.05 * (format.high[k] - format.low[k]);
      low_.push_back(format.low[k] - margin);
      high_.push_back(format.high[k] + margin);
    }
  }

  /// Adds the next normalised poses, [frames, dof], in pieces of any length. Throws Error if the size does
  /// not fit.
  void add(std::span<const float> poses, std::size_t frames) {
    require(poses.size() == frames * dof_, "found ", poses.size(), " pose values, expected ", frames,
            " frames x ", dof_, " dimensions");
    for (std::size_t f = 0; f < frames; ++f) add_frame(poses.subspan(f * dof_, dof_));
  }

  std::size_t frames() const { return frames_; }

  /// One row per second that has a frame; the last one may be incomplete. Frame f belongs to second
  /// floor(f / rate).
  std::vector<DriftRow> rows() const {
    std::vector<DriftRow> out = rows_;
    if (current_.frames > 0) out.push_back(finished_row());
    return out;
  }

  /// Throws Error if there are no frames.
  DriftSummary summary() const {
    const std::vector<DriftRow> all = rows();
    require(!all.empty(), "no frames were measured; a drift summary needs at least one");
    const std::size_t tenth = std::max<std::size_t>(1, all.size() / 10);
    const std::span<const DriftRow> span(all);
    return {static_cast<double>(frames_) / rate_, average(span), average(span.first(tenth)),
            average(span.last(tenth))};
  }

  /// Writes the rows as CSV: second, frames, mean, spread, speed, outside (empty if unknown).
  void write_csv(const std::filesystem::path& path) const {
    std::string text = "second,frames,mean,spread,speed,outside\n";
    for (const DriftRow& r : rows())
      text += concat(r.second, ',', r.frames, ',', r.mean, ',', r.spread, ',', r.speed, ',',
                     low_.empty() ? std::string() : concat(r.outside), '\n');
    motion::write_text_atomically(path, text);
  }

 private:
  void add_frame(std::span<const float> pose) {
    // The epsilon puts frame 3 at 3 frames per second into second 1, whatever the rounding of the division.
    const auto second = static_cast<std::size_t>(static_cast<double>(frames_) / rate_ + 1e-9);
    if (current_.frames > 0 && second != current_.second) {
      rows_.push_back(finished_row());
      current_ = {};
      std::fill(sum_.begin(), sum_.end(), 0.0);
      std::fill(squares_.begin(), squares_.end(), 0.0);
      steps_ = 0;
    }
    current_.second = second;
    ++current_.frames;
    double step = 0;
    for (std::size_t k = 0; k < dof_; ++k) {
      const double value = static_cast<double>(pose[k]), change = value - before_[k];
      sum_[k] += value;
      squares_[k] += value * value;
      step += change * change;
      before_[k] = value;
      // Negated so that a NaN counts as outside.
      if (!low_.empty() && !(value >= low_[k] && value <= high_[k])) current_.outside += 1;
    }
    if (frames_ > 0) {  // the very first frame has no predecessor
      current_.speed += std::sqrt(step / static_cast<double>(dof_)) * rate_;
      ++steps_;
    }
    ++frames_;
  }

  /// The current second: `current_` holds sums.
  DriftRow finished_row() const {
    DriftRow row = current_;
    const double n = static_cast<double>(row.frames), dof = static_cast<double>(dof_);
    for (std::size_t k = 0; k < dof_; ++k) {
      const double mean = sum_[k] / n;
      row.mean += mean * mean / dof;
      const double variance = squares_[k] / n - mean * mean;
      row.spread += variance < 0 ? 0 : variance / dof;  // rounding may go below 0; a NaN stays one
    }
    row.mean = std::sqrt(row.mean);
    row.spread = std::sqrt(row.spread);
    row.speed = steps_ > 0 ? row.speed / static_cast<double>(steps_) : 0;
    row.outside = low_.empty() ? std::numeric_limits<double>::quiet_NaN() : row.outside / (n * dof);
    return row;
  }

  static DriftRow average(std::span<const DriftRow> rows) {
    DriftRow out;
    out.second = rows.front().second;
    for (const DriftRow& r : rows) out.frames += r.frames;
    for (const DriftRow& r : rows) {
      const double weight = static_cast<double>(r.frames) / static_cast<double>(out.frames);
      out.mean += weight * r.mean;
      out.spread += weight * r.spread;
      out.speed += weight * r.speed;
      out.outside += weight * r.outside;
    }
    return out;
  }

  double rate_;
  std::size_t dof_, frames_ = 0, steps_ = 0;
  std::vector<double> low_, high_;              // widened, [dof] or empty
  std::vector<double> sum_, squares_, before_;  // of the current second; the previous frame, [dof]
  DriftRow current_;
  std::vector<DriftRow> rows_;
};

}  // namespace motiongan
