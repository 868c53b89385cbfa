// Quality measures of a set of motions that need no model: foot skating, jerk, bone-length error.
#pragma once
#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "motiongan/core/error.hpp"
#include "motiongan/metrics/bone_length_error.hpp"
#include "motiongan/metrics/foot_skate.hpp"
#include "motiongan/metrics/jerk.hpp"

namespace motiongan {

/// Measures of a set of motions, averaged over all steps and frames. Compare sets of one rate and similar
/// lengths.
struct MotionQuality {
  std::size_t motions = 0, frames = 0;
  std::optional<FootSkate> feet;  ///< unset if the skeleton has no feet (see find_feet)
  double jerk = 0;                ///< see mean_jerk; in `length_unit` per second cubed
  double bone_error = 0;          ///< percent, see bone_length_error
  std::string length_unit;        ///< "m"; "legs" if the file's unit is unknown; "units" without feet
};

/// Measures motions. Lengths are in metres if `options.unit_metres` is given, otherwise in leg lengths of
/// each motion's own body (which foot_skate takes to be 1 m), or in the files' unit if a skeleton has no
/// feet. Throws Error without motions, for motions of fewer than 4 frames, and for feet in the options that
/// do not exist.
inline MotionQuality measure_quality(std::span<const motion::Motion> motions,
                                     const FootSkateOptions& options = {}) {
  require(!motions.empty(), "there is no motion to measure; expected at least one");
  MotionQuality out;
  const bool by_name = options.feet.empty();
  const bool feet = !by_name || std::all_of(motions.begin(), motions.end(),
                                            [](const motion::Motion& m) { return has_feet(m.skeleton); });
  out.length_unit = options.unit_metres > 0 ? "m" : feet ? "legs" : "units";
  if (feet) out.feet.emplace();
  double thirds = 0, jerk = 0, bones = 0;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const motion::Motion& motion = motions[m];
    require(motion.frames >= 4, "motion ", m, " has ", motion.frames,
            " frames; expected at least 4, for a third derivative");
    // Each motion by its own legs: bodies of different size, in any order, measure alike.
    double scale = 1;
    if (options.unit_metres > 0)
      scale = options.unit_metres;
    else if (feet)
      scale = 1 / leg_length(motion.skeleton, find_feet(motion.skeleton, options.feet));
    const std::vector<motion::Vec3> positions = motion::joint_positions(motion);
    if (out.feet) *out.feet += foot_skate(motion.skeleton, positions, motion.rate, options);
    const double weight = static_cast<double>(motion.frames - 3);
    jerk += weight * mean_jerk(positions, motion.skeleton.size(), motion.rate, scale);
    thirds += weight;
    bones += static_cast<double>(motion.frames) * bone_length_error(motion);
    out.frames += motion.frames;
  }
  out.motions = motions.size();
  out.jerk = jerk / thirds;
  out.bone_error = bones / static_cast<double>(out.frames);
  return out;
}

}  // namespace motiongan
