// What must be known about motion to use a trained model: everything of a data set but its clips.
#pragma once
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/normalizer.hpp"
#include "motiongan/motion/pose.hpp"
#include "motiongan/motion/skeleton.hpp"
#include "motiongan/motion/vocabulary.hpp"

namespace motiongan::motion {

/// How the numbers that a network sees become motion, and captions become numbers.
struct MotionFormat {
  PoseLayout layout;  ///< holds the skeleton
  Normalizer normalizer;
  Vocabulary vocabulary;
  double rate = 0;         ///< frames per second of a window
  std::size_t frames = 0;  ///< N, frames of a window

  /// Kept dimensions (indices 0 .. kept dof - 1) that are counted from the first frame of each window: the
  /// root's x, z (y is up) and yaw, so that it does not matter where in the room a motion was recorded. Their
  /// mean is 0 and their deviation is the root mean square over windows.
  std::vector<std::size_t> relative_dims;

  const Skeleton& skeleton() const { return layout.skeleton(); }

  /// Numbers per frame that a network sees.
  std::size_t dof() const { return normalizer.kept_dof(); }

  /// Whether kept dimension k is counted from the window's first frame, [kept dof].
  std::vector<bool> relative_mask() const {
    std::vector<bool> mask(dof(), false);
    for (const std::size_t k : relative_dims) mask.at(k) = true;
    return mask;
  }

  /// The kept dimensions that a window's turn concerns; yaw = value * yaw_scale in radians.
  struct Turning {
    std::size_t x, z, yaw;
    double yaw_scale;
  };

  /// Where windows are turned to face the same way: the layout has a yaw and a position, and all three are
  /// kept.
  std::optional<Turning> turning() const {
    if (layout.root_rotation() != RootRotation::heading || !layout.root_position()) return std::nullopt;
    const auto& kept = normalizer.kept();
    const auto place = [&](std::size_t dim) {
      return static_cast<std::size_t>(std::find(kept.begin(), kept.end(), dim) - kept.begin());
    };
    const std::size_t p = layout.position_dim(), y = layout.yaw_dim();
    const Turning t{place(p), place(p + 2), place(y), normalizer.std()[y]};
    if (std::max({t.x, t.z, t.yaw}) >= kept.size()) return std::nullopt;
    return t;
  }

  /// The motion of normalised poses [any number of frames, dof()], at `rate`. Relative dimensions count from
  /// the origin.
  Motion to_motion(std::span<const float> normalised) const {
    const std::vector<double> poses = normalizer.denormalize(normalised);
    return layout.decode(poses, poses.size() / layout.dof(), rate);
  }

  /// Error unless the parts fit each other.
  void check() const {
    require(layout.skeleton().size() > 0, "a motion format has no skeleton");
    require(normalizer.full_dof() == layout.dof(), "a normalizer of ", normalizer.full_dof(),
            " dimensions does not fit a pose of ", layout.dof());
    require(normalizer.kept_dof() > 0, "all ", layout.dof(), " pose dimensions are constant: nothing moves");
    require(rate > 0 && rate < 1e6, "a motion format has a rate of ", rate,
            " frames per second, expected more than 0");
    require(frames > 0, "a motion format has windows of 0 frames, expected at least 1");
    for (std::size_t i = 0; i < relative_dims.size(); ++i)
      require(relative_dims[i] < dof() && (i == 0 || relative_dims[i] > relative_dims[i - 1]),
              "relative dimension ", relative_dims[i], " is out of order or not one of the ", dof(),
              " kept dimensions");
  }
};

}  // namespace motiongan::motion
