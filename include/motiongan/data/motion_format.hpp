// What is needed to use a trained model: everything in a data set except its clips.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/normalizer.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/skeleton.hpp"
#include "motiongan/motion/skeleton_match.hpp"

namespace motiongan::motion {

/// Conversion between network values and motion, and between captions and word indices.
struct MotionFormat {
  /// Sizes beyond any model's, which a damaged file may claim.
  static constexpr std::size_t most_frames = 65536, most_dof = 65536, most_words = 1'000'000,
                               most_descriptions = 500;

  PoseLayout layout;      ///< holds the skeleton
  Normalizer normalizer;  ///< mean and standard deviation of each dimension
  Vocabulary vocabulary;  ///< the words of the training captions
  /// Distinct training captions, those of most clips first, at most most_descriptions; empty if unknown.
  std::vector<std::string> descriptions = {};
  double rate = 0;         ///< frames per second of a window
  std::size_t frames = 0;  ///< N, frames of a window
  ClipSpace space{};       ///< unit of its motion, and the up axis of the clips that it was fitted to

  /// Kept dimensions (indices 0 .. kept dof - 1) that are relative to the first frame of each window: the
  /// root's x, z (y is up) and yaw, so that it does not matter where a motion was recorded. Their mean is 0
  /// and their deviation is the root mean square over windows. None with steps and turns.
  std::vector<std::size_t> relative_dims;

  /// Smallest and largest normalised value of each kept dimension over the training windows; empty if
  /// unknown.
  std::vector<double> low, high;  ///< [kept dof] each

  const Skeleton& skeleton() const { return layout.skeleton(); }

  /// Values per frame that a network sees.
  std::size_t dof() const { return normalizer.kept_dof(); }

  /// Whether each kept dimension is relative to the window's first frame, [kept dof].
  std::vector<bool> relative_mask() const {
    std::vector<bool> mask(dof(), false);
    for (const std::size_t k : relative_dims) mask.at(k) = true;
    return mask;
  }

  /// The kept dimensions involved in rotating a window; yaw = value * yaw_scale in radians.
  struct Turning {
    std::size_t x, z, yaw;
    double yaw_scale;
  };

  /// Set if windows are rotated to face the same way: the layout has heading and position, and x, z and yaw
  /// are all kept.
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

  /// Converts normalised poses [any number of frames, dof()] to window form, in place: relative dimensions
  /// are counted from the first frame, and x and z rotated back by its yaw.
  template <class T>
  void make_relative(std::span<T> poses) const {
    const std::optional<Turning> turned = turning();
    const double yaw =
        turned && !poses.empty() ? static_cast<double>(poses[turned->yaw]) * turned->yaw_scale : 0;
    // Backwards, because all rows need the first one, which becomes zero.
    for (std::size_t i = poses.size() / dof(); i-- > 0;) {
      T* const pose = &poses[i * dof()];
      for (const std::size_t k : relative_dims) pose[k] -= poses[k];
      if (!turned) continue;
      double x = static_cast<double>(pose[turned->x]), z = static_cast<double>(pose[turned->z]);
      turn_ground(x, z, -yaw);
      pose[turned->x] = static_cast<T>(x);
      pose[turned->z] = static_cast<T>(z);
    }
  }

  /// The motion of normalised poses [any number of frames, dof()], at `rate`. Relative dimensions start at
  /// the origin; steps and turns are integrated from `track`, see PoseLayout::decode.
  Motion to_motion(std::span<const float> normalised, RootTrack* track = nullptr) const {
    const std::vector<double> poses = normalizer.denormalize(normalised);
    return layout.decode(poses, poses.size() / layout.dof(), rate, track);
  }

  /// Throws Error, naming the joints, unless `other` has the same joints as this format; bone lengths and
  /// channels may differ. `what` names its owner in the message, such as "the prior walk.bvh".
  void require_skeleton(const Skeleton& other, const std::string& what) const {
    require_same_joints(skeleton(), other, what);
  }

  /// A motion as a network sees it, [prior.frames, dof()]: normalised, in window form.
  /// place(to_motion(encode_window(prior)), prior) reproduces the prior except for dropped dimensions.
  /// Exponential maps start within half a turn, as those of a clip do. Throws Error if the motion has another
  /// skeleton or another rate.
  std::vector<float> encode_window(const Motion& prior) const {
    require_skeleton(prior.skeleton, "the motion to encode");
    require(std::abs(prior.rate / rate - 1) < 1e-6, "the motion to encode has ", prior.rate,
            " frames per second, expected ", rate, "; resample() it");
    std::vector<double> poses = normalizer.normalize<double>(layout.encode(prior));
    make_relative(std::span<double>(poses));
    return {poses.begin(), poses.end()};
  }

  /// Moves a motion from to_motion over the ground so that in its first frame the root is placed and faces as
  /// in the prior's first frame (x, z and yaw; with RootRotation::expmap, which keeps the heading, only x and
  /// z). Throws Error if the number of joints differs.
  Motion place(Motion made, const Motion& prior) const {
    require(made.skeleton.size() == skeleton().size(), "a motion of ", made.skeleton.size(),
            " joints cannot be placed, expected ", skeleton().size());
    return placed_at(std::move(made), layout.root(), layout.track_of(prior, 0), layout.has_yaw());
  }

  /// Throws Error unless the members are consistent.
  void check() const {
    require(layout.skeleton().size() > 0, "a motion format has no skeleton");
    require(layout.dof() <= most_dof, "a motion format has ", layout.dof(),
            " pose dimensions, expected at most ", most_dof);
    require(normalizer.full_dof() == layout.dof(), "a normalizer of ", normalizer.full_dof(),
            " dimensions does not fit a pose of ", layout.dof());
    require(normalizer.kept_dof() > 0, "all ", layout.dof(), " pose dimensions are constant: nothing moves");
    require(rate > 0 && rate < 1e6, "a motion format has a rate of ", rate,
            " frames per second, expected more than 0");
    require(frames > 0 && frames <= most_frames, "a motion format has windows of ", frames,
            " frames, expected 1 to ", most_frames);
    require(vocabulary.size() <= most_words, "a motion format has ", vocabulary.size(),
            " words, expected at most ", most_words);
    for (std::size_t i = 0; i < relative_dims.size(); ++i)
      require(relative_dims[i] < dof() && (i == 0 || relative_dims[i] > relative_dims[i - 1]),
              "relative dimension ", relative_dims[i], " is out of order or not one of the ", dof(),
              " kept dimensions");
    if (low.empty() && high.empty()) return;
    require(low.size() == dof() && high.size() == dof(), "the training range ('low', 'high') has ",
            low.size(), " and ", high.size(), " values, expected ", dof(), " each, or none");
    for (std::size_t k = 0; k < dof(); ++k)
      require(std::isfinite(low[k]) && std::isfinite(high[k]) && low[k] <= high[k],
              "the training range ('low', 'high') of kept dimension ", k, " is from ", low[k], " to ",
              high[k], ", expected finite numbers in order");
  }
};

}  // namespace motiongan::motion
