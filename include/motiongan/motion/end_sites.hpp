// End sites of bones that have none: some programs that read BVH files demand them.
#pragma once
#include <vector>

#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The skeleton with an end site at every joint without children: where it has none, half of the bone that
/// leads to the joint, going on in its direction.
inline Skeleton with_end_sites(Skeleton skeleton) {
  const auto below = children(skeleton);
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (below[j].empty() && !skeleton.joints[j].end_site)
      skeleton.joints[j].end_site = scale(skeleton.joints[j].offset, 0.5);
  return skeleton;
}

}  // namespace motiongan::motion
