// Bone-length error of a motion.
#pragma once
#include "motiongan/metrics/position_metrics.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/root_joint.hpp"

namespace motiongan {

/// Absolute deviation of a motion's bones from their rest lengths, in percent, averaged over bones and
/// frames. Joints above the moving root are not counted as bones. It is 0 by construction where joints only
/// rotate, as in DVGAN's motion, and is meaningful for motion generated as positions and for BVH files with
/// position channels below the root. Throws Error if the skeleton has no bone or the motion no frame.
inline double bone_length_error(const motion::Motion& motion) {
  const motion::Motion folded = motion::fold_into_root(motion, motion::moving_root(motion));
  return bone_length_error(folded.skeleton, motion::joint_positions(folded));
}

}  // namespace motiongan
