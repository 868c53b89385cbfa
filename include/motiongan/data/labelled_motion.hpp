// A motion together with what people say about it.
#pragma once
#include <string>
#include <vector>

#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A clip as training sees it: the motion and one or more descriptions that are all true of it.
struct LabelledMotion {
  std::string id;  ///< unique within a data set; the file's name without folder and extension
  Motion motion;
  std::vector<std::string> captions;
};

}  // namespace motiongan::motion
