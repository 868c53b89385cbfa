// Whether a motion stretches its skeleton.
#pragma once
#include "motiongan/metrics/position_metrics.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan {

/// How much a motion's bones differ from the lengths of its skeleton's rest pose, in percent of those, mean
/// over bones and frames. Joints above the one that travels are no bones. It is 0 by construction where
/// joints only turn, as in what DVGAN makes; it says something of motion that was made as positions, and of
/// BVH files with position channels below the root. Error if the skeleton has no bone or the motion no frame.
inline double bone_length_error(const motion::Motion& motion) {
  const motion::Motion folded = motion::fold_into_root(motion, motion::moving_root(motion));
  return bone_length_error(folded.skeleton, motion::joint_positions(folded));
}

}  // namespace motiongan
