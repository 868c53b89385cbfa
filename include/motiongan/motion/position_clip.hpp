// A motion as points: where every joint is, without rotations.
#pragma once
#include <string>
#include <vector>

#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// What forward kinematics makes of a Motion, or a file of positions holds. Of the skeleton, names, parents
/// and offsets count; offsets are those of the file, or mean bone vectors where the file has only positions.
struct PositionClip {
  std::string id;
  Skeleton skeleton;
  double rate = 0;  ///< frames per second
  std::size_t frames = 0;
  std::vector<Vec3> positions;  ///< [frames, joints], in the world, y up, in the file's unit
};

}  // namespace motiongan::motion
