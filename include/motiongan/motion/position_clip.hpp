// A motion as joint positions, without rotations.
#pragma once
#include <string>
#include <vector>

#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Joint positions, from forward kinematics of a Motion or from a file. Only names, parents and offsets of
/// the skeleton are used; the offsets are those of the file, or estimated from the positions if the file has
/// only positions (with_offsets_of).
struct PositionClip {
  std::string id;
  Skeleton skeleton;
  double rate = 0;  ///< frames per second
  std::size_t frames = 0;
  std::vector<Vec3> positions;  ///< [frames, joints], world coordinates, y up, in the file's unit
};

}  // namespace motiongan::motion
