// What a data set is made of, and how.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "motiongan/data/first_frame.hpp"
#include "motiongan/data/pose.hpp"

namespace motiongan::motion {

struct DatasetOptions {
  std::size_t frames = 32;           ///< N, frames of a window
  double rate = 4.0;                 ///< frames per second of a window
  std::filesystem::path captions{};  ///< lines of `clip id <TAB> description`; empty: captions from names
  bool root_position = true;         ///< whether the root's position is part of a pose
  RootRotation root_rotation = RootRotation::heading;  ///< the papers: expmap; for long motion: velocity
  double train_share = 0.67;                           ///< of the clips; the rest is for testing
  std::uint64_t split_seed = 1;
  FirstFrame first_frame = FirstFrame::automatic;  ///< for BVH files
};

}  // namespace motiongan::motion
