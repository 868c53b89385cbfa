// The distance of generative search, between a window of a clip and a hypothesis at a shift of whole frames.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/motion_format.hpp"

namespace motiongan {

/// Shifts range from -search_reach(N) to +search_reach(N) frames: N / 2, rounded down.
inline std::size_t search_reach(std::size_t frames) { return frames / 2; }

/// Root mean square difference of a window and a hypothesis, both normalised poses [N, dof], at a shift:
/// frame t of the hypothesis is compared with frame t + shift of the window, |shift| < N. Throws Error for
/// another size or shift. See docs/evaluation.md.
///
/// The mean is over the N - |shift| overlapping frames and all kept dimensions; 1 corresponds to one standard
/// deviation of the training clips in every dimension. Dimensions that are relative to a window's first frame
/// (the root's x, z and yaw) are made relative to the first overlapping frame, in both, because the frames
/// before it have no counterpart. A clip that contains a hypothesis therefore has distance 0 at the right
/// shift, wherever and in whichever direction it was recorded. With steps and turns no dimension is
/// relative; those that lead to a clip's first frame are not known, and taken from its second.
inline double search_distance(const motion::MotionFormat& format, std::span<const float> window,
                              std::span<const float> hypothesis, int shift) {
  const std::size_t dof = format.dof(), size = format.frames * dof;
  const auto apart = static_cast<std::size_t>(std::abs(shift));
  require(window.size() == size && hypothesis.size() == size, "a window of ", window.size(),
          " values and a hypothesis of ", hypothesis.size(), " cannot be compared; expected ", format.frames,
          " x ", dof, " each");
  require(apart < format.frames, "a shift of ", shift, " frames leaves no overlap, expected less than ",
          format.frames);
  const std::size_t count = size - apart * dof;
  const auto overlap = [&](std::span<const float> poses, bool late) {
    const auto part = poses.subspan(late ? apart * dof : 0, count);
    std::vector<double> out(part.begin(), part.end());
    format.make_relative(std::span<double>(out));
    return out;
  };
  const std::vector<double> a = overlap(window, shift > 0), b = overlap(hypothesis, shift < 0);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(count));
}

/// Splits the kept dimensions of a pose into plain ones and the track, which is made relative at each shift.
struct SearchLayout {
  std::vector<std::size_t> plain;
  std::vector<std::size_t> track;  ///< x, z, yaw if windows are turned; then other relative dimensions
  bool turned = false;             ///< whether windows are turned to a common heading
  double yaw_scale = 0;            ///< factor from the normalised yaw to radians

  explicit SearchLayout(const motion::MotionFormat& format) {
    std::vector<bool> rest = format.relative_mask();
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (!rest[k]) plain.push_back(k);
    if (const auto turning = format.turning()) {
      turned = true;
      yaw_scale = turning->yaw_scale;
      for (const std::size_t k : {turning->x, turning->z, turning->yaw}) {
        require(rest[k], "kept dimension ", k,
                " turns with the window but is not relative to its first frame: bad motion format");
        track.push_back(k);
        rest[k] = false;
      }
    }
    for (std::size_t k = 0; k < rest.size(); ++k)
      if (rest[k]) track.push_back(k);
  }

  /// Columns of the plain part; at least one, filled with zeros if every dimension is relative.
  std::size_t columns() const { return std::max<std::size_t>(1, plain.size()); }
};

/// Frames split by a SearchLayout.
struct SearchFrames {
  std::vector<float> plain;  ///< [frames, columns()]
  std::vector<float> track;  ///< [frames, track dimensions]

  /// Appends normalised poses [any number, dof].
  void add(const SearchLayout& layout, std::span<const float> poses) {
    const std::size_t dof = layout.plain.size() + layout.track.size();
    for (std::size_t row = 0; row < poses.size(); row += dof) {
      for (const std::size_t k : layout.plain) plain.push_back(poses[row + k]);
      if (layout.plain.empty()) plain.push_back(0);
      for (const std::size_t k : layout.track) track.push_back(poses[row + k]);
    }
  }

  /// `count` frames from `first` as poses [count, dof], relative to the first of them.
  std::vector<float> window(const motion::MotionFormat& format, const SearchLayout& layout, std::size_t first,
                            std::size_t count) const {
    const std::size_t dof = format.dof(), columns = layout.columns(), dims = layout.track.size();
    std::vector<float> out(count * dof);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < layout.plain.size(); ++k)
        out[i * dof + layout.plain[k]] = plain.at((first + i) * columns + k);
      for (std::size_t k = 0; k < dims; ++k)
        out[i * dof + layout.track[k]] = track.at((first + i) * dims + k);
    }
    format.make_relative(std::span<float>(out));
    return out;
  }
};

}  // namespace motiongan
