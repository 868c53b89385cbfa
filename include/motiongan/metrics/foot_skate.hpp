// Foot skating: how often feet slide over the floor.
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
#include "motiongan/metrics/statistics_measure.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan {

/// Options of foot_skate().
struct FootSkateOptions {
  std::vector<std::string> feet = {};  ///< joint names; empty: found by find_feet()
  double unit_metres = 0;              ///< the file's unit in metres; 0: unknown, a leg counts as 1 m
  double height = 0.05;                ///< metres above the floor below which a foot is in contact
  double speed = 0.5;                  ///< horizontal speed in m/s above which a foot slides
  double seconds = 0.25;               ///< window over which the mean speed must exceed `speed` too
  std::optional<double> floor = {};    ///< floor height in the file's unit; unset: from the feet
  double floor_percentile = 0.05;      ///< percentile (0 .. 1) of the feet's heights used as the floor
};

/// Foot-skating counts of one motion; += combines several.
struct FootSkate {
  std::size_t steps = 0;    ///< pairs of consecutive frames
  std::size_t sliding = 0;  ///< steps in which a foot slides
  std::size_t contact = 0;  ///< steps in which a foot is near the floor

  /// The foot-skate ratio, 0 .. 1. It is also 0 if no foot is ever near the floor: check contact_share() too.
  double ratio() const { return steps > 0 ? static_cast<double>(sliding) / static_cast<double>(steps) : 0; }
  /// Fraction of steps with a foot near the floor, 0 .. 1.
  double contact_share() const {
    return steps > 0 ? static_cast<double>(contact) / static_cast<double>(steps) : 0;
  }
  /// Adds the counts of other motions.
  FootSkate& operator+=(const FootSkate& other) {
    steps += other.steps, sliding += other.sliding, contact += other.contact;
    return *this;
  }
};

using motion::find_feet;
using motion::has_feet;
using motion::leg_length;

/// Foot skating as measured by Karunratanakul et al. 2023 (GMD) and Xie et al. 2024 (OmniControl): the
/// fraction of steps between consecutive frames in which a foot is near the floor (below 5 cm) in both
/// frames, moves horizontally (x and z) faster than 0.5 m/s, and also does so on average over the surrounding
/// 0.25 s (5 steps at 20 frames per second in their code; as there, steps beyond the motion's ends count as
/// 0).
///
/// Their motion is in metres with the floor at 0. Here the floor is the 5th percentile of the heights of the
/// feet in the motion, and an unknown unit is derived by taking a leg to be 1 m long. A motion that floats is
/// therefore measured against a floor in the air. Fast movements between two frames are missed, so compare
/// motions of one rate. Real motion does not score 0, because feet roll and touch down while moving. A motion
/// without root translation slides whenever it walks.
///
/// `positions` are [frames, joints] in world space, y up, at `rate` frames per second. Throws Error if the
/// sizes do not fit, for fewer than 2 frames, for options out of range and if there are no feet.
inline FootSkate foot_skate(const motion::Skeleton& skeleton, std::span<const motion::Vec3> positions,
                            double rate, const FootSkateOptions& options = {}) {
  const std::size_t joints = skeleton.size();
  require(joints > 0 && positions.size() % joints == 0 && positions.size() >= 2 * joints, "found ",
          positions.size(), " positions, expected at least two whole frames of ", joints, " joints");
  require(
      rate > 0 && options.unit_metres >= 0 && options.height > 0 && options.speed > 0 && options.seconds > 0,
      "found a rate of ", rate, ", a unit of ", options.unit_metres, " m, a height of ", options.height,
      " m, a speed of ", options.speed, " m/s and a time of ", options.seconds,
      " s; expected values above 0 (an unknown unit: 0)");
  const std::vector<std::size_t> feet = find_feet(skeleton, options.feet);
  const double metre = 1 / (options.unit_metres > 0 ? options.unit_metres : 1 / leg_length(skeleton, feet));
  const std::size_t frames = positions.size() / joints, steps = frames - 1;
  double floor = options.floor.value_or(0);
  if (!options.floor) {
    std::vector<double> heights;
    for (std::size_t f = 0; f < frames; ++f)
      for (const std::size_t j : feet) heights.push_back(positions[f * joints + j][1]);
    floor = motion::percentile(std::move(heights), options.floor_percentile);
  }
  // An odd number of steps, so that the window is centred on its step.
  const auto reach = static_cast<std::size_t>(std::max(0.0, std::round((options.seconds * rate - 1) / 2)));

  std::vector<char> slides(steps, 0), stands(steps, 0);
  std::vector<double> speeds(steps);
  for (const std::size_t j : feet) {
    const auto at = [&](std::size_t f) -> const motion::Vec3& { return positions[f * joints + j]; };
    for (std::size_t f = 0; f < steps; ++f)
      speeds[f] = std::hypot(at(f + 1)[0] - at(f)[0], at(f + 1)[2] - at(f)[2]) * rate;
    const auto is_low = [&](std::size_t f) { return at(f)[1] - floor < options.height * metre; };
    for (std::size_t f = 0; f < steps; ++f) {
      if (!is_low(f) || !is_low(f + 1)) continue;
      stands[f] = 1;
      double mean = 0;
      for (std::size_t g = f - std::min(f, reach); g <= std::min(f + reach, steps - 1); ++g)
        mean += speeds[g] / static_cast<double>(2 * reach + 1);
      if (speeds[f] > options.speed * metre && mean > options.speed * metre) slides[f] = 1;
    }
  }
  return {steps, static_cast<std::size_t>(std::count(slides.begin(), slides.end(), 1)),
          static_cast<std::size_t>(std::count(stands.begin(), stands.end(), 1))};
}

/// The same for a motion, by forward kinematics.
inline FootSkate foot_skate(const motion::Motion& motion, const FootSkateOptions& options = {}) {
  return foot_skate(motion.skeleton, motion::joint_positions(motion), motion.rate, options);
}

}  // namespace motiongan
