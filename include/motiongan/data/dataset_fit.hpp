// What a data set takes from its training clips as a whole: the floor, means and deviations.
#pragma once
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "motiongan/data/clip_source.hpp"
#include "motiongan/data/normalizer.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/motion/percentile.hpp"

namespace motiongan::motion::dataset_detail {

/// A clip that will be used, and its source.
struct Used {
  std::size_t source = 0;
  EncodedClip clip;
  LoadChange change{};
  double speed = 1;       ///< relative to the source
  bool mirrored = false;  ///< left and right exchanged

  bool derived() const { return mirrored || speed != 1; }
};

/// Gives a layout with a support its floor, the median height of the support over the training clips,
/// and changes the clips' poses accordingly.
inline void find_floor(std::vector<Used>& used, const std::vector<bool>& is_train, PoseLayout& layout) {
  if (!layout.has_support()) return;
  const std::size_t dof = layout.dof(), at = layout.position_dim() + 1;
  std::vector<double> heights;
  for (std::size_t c = 0; c < used.size(); ++c)
    for (std::size_t f = 0; is_train[c] && f < used[c].clip.frames; ++f)
      heights.push_back(used[c].clip.poses[f * dof + at]);
  layout = layout.with_floor(percentile(std::move(heights), 0.5));
  for (Used& u : used)
    for (std::size_t f = 0; f < u.clip.frames; ++f)
      u.clip.poses[f * dof + at] = layout.lowered(u.clip.poses[f * dof + at]);
}

/// Mean and deviation over the training clips; for the root's x, z and yaw, unless they are steps and turns,
/// over training windows.
inline Normalizer fit_normalizer(const std::vector<Used>& used, const std::vector<bool>& is_train,
                                 const PoseLayout& layout, std::size_t frames, std::size_t stride) {
  const std::size_t dof = layout.dof();
  std::vector<double> mean(dof), std(dof);
  std::size_t rows = 0;
  const auto for_rows = [&](auto&& work) {
    for (std::size_t c = 0; c < used.size(); ++c)
      if (is_train[c])
        for (std::size_t f = 0; f < used[c].clip.frames; ++f) work(used[c].clip.poses.data() + f * dof);
  };
  for_rows([&](const double* pose) {
    ++rows;
    for (std::size_t d = 0; d < dof; ++d) mean[d] += pose[d];
  });
  for (double& m : mean) m /= static_cast<double>(rows);
  for_rows([&](const double* pose) {
    for (std::size_t d = 0; d < dof; ++d) std[d] += (pose[d] - mean[d]) * (pose[d] - mean[d]);
  });
  for (double& s : std) s = std::sqrt(s / static_cast<double>(rows));

  // Dimensions relative to a window's first frame: mean 0, root mean square over all windows. x and z share
  // one scale if windows are rotated or hold steps, so that rotations in the ground plane are preserved.
  std::vector<std::size_t> relative;
  if (layout.root_position() && !layout.has_steps())
    relative = {layout.position_dim(), layout.position_dim() + 2};
  if (layout.has_yaw() && !layout.has_steps()) relative.push_back(layout.yaw_dim());
  for (const std::size_t d : relative) {
    double squares = 0, count = 0;
    for (std::size_t c = 0; c < used.size(); ++c) {
      if (!is_train[c]) continue;
      const EncodedClip& clip = used[c].clip;
      for (std::size_t start = 0; start + (frames - 1) * stride < clip.frames; ++start) {
        for (std::size_t i = 0; i < frames; ++i) {
          const double moved = clip.poses[(start + i * stride) * dof + d] - clip.poses[start * dof + d];
          squares += moved * moved;
        }
        count += static_cast<double>(frames);
      }
    }
    mean[d] = 0;
    std[d] = std::sqrt(squares / count);
  }
  if (layout.has_yaw() && layout.root_position()) {
    double &x = std[layout.position_dim()], &z = std[layout.position_dim() + 2];
    x = z = std::sqrt((x * x + z * z) / 2);
  }
  return Normalizer(std::move(mean), std::move(std));
}

}  // namespace motiongan::motion::dataset_detail
