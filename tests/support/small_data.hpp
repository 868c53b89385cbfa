// A small data set of procedural motion.
#pragma once
#include <motiongan/data/dataset.hpp>
#include <motiongan/models/dvgan.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/messages.hpp"

namespace motiongan::testing {

/// Windows of `frames` frames at 4 Hz from 12 clips of six seconds, with captions of different lengths.
inline const motion::Dataset& small_data(std::size_t frames = 8) {
  const auto make = [](std::size_t n) {
    return motion::Dataset::from_motions(
        motion::procedural_motions({.clips = 12, .seconds = 6, .rate = 8, .seed = 3}),
        {.frames = n, .rate = 4});
  };
  static const motion::Dataset eight = make(8), sixteen = make(16);
  require(frames == 8 || frames == 16, "small_data: 8 or 16 frames");
  return frames == 8 ? eight : sixteen;
}

/// The values of all parameters, to compare two models bit for bit.
template <class Model>
std::vector<std::vector<float>> all_values(Model& model) {
  std::vector<std::vector<float>> all;
  for (const NamedParameter& p : named_parameters(model)) all.push_back(p.value->value().to_host());
  return all;
}

}  // namespace motiongan::testing
