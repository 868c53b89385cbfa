// A motion with its descriptions.
#pragma once
#include <string>
#include <vector>

#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A clip for training: the motion and one or more descriptions, each of which is true of it.
struct LabelledMotion {
  std::string id;  ///< unique within a data set; file name without folder and extension
  Motion motion;
  std::vector<std::string> captions;
};

}  // namespace motiongan::motion
