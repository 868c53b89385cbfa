// A clip of a text-conditioned data set.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace motiongan::motion {

/// One clip, normalised, at the data set's common source rate.
struct DatasetClip {
  std::string id;
  std::vector<std::string> captions;        ///< its descriptions
  std::vector<std::vector<int>> sentences;  ///< the captions as word indices of the vocabulary
  std::size_t frames = 0;
  std::vector<float> poses;  ///< [frames, kept dof]
  bool derived = false;      ///< mirrored or stretched from another training clip
};

}  // namespace motiongan::motion
