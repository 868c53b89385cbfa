// Rotations without what positions do not tell: motion of models that know rotations beside that of others.
#pragma once
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/position_rotations.hpp"

namespace motiongan::motion {

/// The motion with its rotations found anew from the places of its joints (motion_from_positions). Joints are
/// where they were, up to rounding; twists about single bones are gone, and with them whether rotations were
/// captured or found from positions, as those of an ActionGan are. Bring real and generated clips to this
/// form before one measure of rotations judges both. Throws Error as motion_from_positions() does.
inline Motion untwisted(const Motion& motion) {
  return motion_from_positions({.id = {},
                                .skeleton = motion.skeleton,
                                .rate = motion.rate,
                                .frames = motion.frames,
                                .positions = joint_positions(motion)});
}

}  // namespace motiongan::motion
