// A small data set of curved walks in any form of the root, and windows of it.
#pragma once
#include <algorithm>
#include <vector>

#include "motiongan/data/dataset.hpp"
#include "walking_clips.hpp"

namespace motiongan::testing {

inline constexpr motion::RootRotation root_forms[] = {
    motion::RootRotation::expmap, motion::RootRotation::heading, motion::RootRotation::velocity,
    motion::RootRotation::support};

/// Three clips, windows of 8 frames at 5 per second.
inline motion::Dataset walking_data(motion::RootRotation form, bool position = true) {
  return motion::Dataset::from_motions(
      {{"a", motion::curved_walk_on_legs(0.3, {1, 0, 2}, 60), {"walk"}},
       {"b", motion::curved_walk_on_legs(-2, {5, 0.2, -3}, 50), {"walk"}},
       {"c", motion::curved_walk_on_legs(1, {}, 45), {"walk"}}},
      {.frames = 8, .rate = 5, .root_position = position, .root_rotation = form, .train_share = 1});
}

/// A window of clip `clip`, normalised, [frames, dof].
inline std::vector<float> window_of(const motion::Dataset& data, std::size_t clip) {
  std::vector<float> window(data.format.frames * data.format.dof());
  data.window(data.train[clip], 11, window);
  return window;
}

/// Those of the first `batch` clips, [frames, batch, dof].
inline Tensor windows_of(const motion::Dataset& data, const Context& context, std::size_t batch) {
  const std::size_t frames = data.format.frames, dof = data.format.dof();
  std::vector<float> all(frames * batch * dof);
  for (std::size_t b = 0; b < batch; ++b) {
    const std::vector<float> window = window_of(data, b);
    for (std::size_t f = 0; f < frames; ++f)
      std::copy_n(window.begin() + static_cast<std::ptrdiff_t>(f * dof), dof,
                  all.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof));
  }
  return Tensor::from(context, {frames, batch, dof}, all);
}

}  // namespace motiongan::testing
