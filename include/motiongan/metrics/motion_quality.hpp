// Quality measures of a set of motions that need no model: foot skating, jerk, bone-length error.
#pragma once
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

/// Measures motions of one skeleton. Lengths are in metres if `options.unit_metres` is given, otherwise in
/// leg lengths (which foot_skate takes to be 1 m), or in the files' unit if the skeleton has no feet. Throws
/// Error without motions, for motions of fewer than 4 frames, and for feet in the options that do not exist.
inline MotionQuality measure_quality(std::span<const motion::Motion> motions,
                                     const FootSkateOptions& options = {}) {
  require(!motions.empty(), "there is no motion to measure; expected at least one");
  const motion::Skeleton& skeleton = motions.front().skeleton;
  MotionQuality out;
  std::vector<std::size_t> feet;
  if (!options.feet.empty() || has_feet(skeleton)) feet = find_feet(skeleton, options.feet);
  double scale = 1;
  if (options.unit_metres > 0) {
    scale = options.unit_metres, out.length_unit = "m";
  } else if (!feet.empty()) {
    scale = 1 / leg_length(skeleton, feet), out.length_unit = "legs";
  } else {
    out.length_unit = "units";
  }
  if (!feet.empty()) out.feet.emplace();
  double thirds = 0, jerk = 0, bones = 0;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const motion::Motion& motion = motions[m];
    require(motion.frames >= 4, "motion ", m, " has ", motion.frames,
            " frames; expected at least 4, for a third derivative");
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
