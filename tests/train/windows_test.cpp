// Windows gathered on the device equal those of the data set on the host.
#include "motiongan/train/windows.hpp"

#include <doctest/doctest.h>

#include "motiongan/procedural/procedural.hpp"

namespace windows_test {

using namespace motiongan;

TEST_CASE("the device gathers the same windows as the host, with and without rotation") {
  const Context context;
  for (const motion::RootRotation mode : {motion::RootRotation::heading, motion::RootRotation::expmap})
    for (const bool root_position : {true, false}) {
      // Clips of exactly 8 frames: one window per clip.
      const auto motions = motion::procedural_motions({.clips = 4, .seconds = 2, .rate = 4});
      const auto data = motion::Dataset::from_motions(
          motions, {.frames = 8, .rate = 4, .root_position = root_position, .root_rotation = mode});
      REQUIRE(data.train.size() >= 2);
      const std::size_t dof = data.format.dof(), batch = 16;
      const CaptionedBatch drawn = WindowSampler(context, data).draw(3, 7, batch);
      const std::vector<float> values = drawn.motion.to_host();
      std::vector<std::size_t> seen(data.train.size(), 0);
      for (std::size_t b = 0; b < batch; ++b) {
        std::vector<float> window(8 * dof);
        bool found = false;
        for (std::size_t c = 0; c < data.train.size() && !found; ++c) {
          data.window(data.train[c], 0, window);
          float worst = 0;
          for (std::size_t t = 0; t < 8; ++t)
            for (std::size_t d = 0; d < dof; ++d)
              worst = std::max(worst, std::abs(values[(t * batch + b) * dof + d] - window[t * dof + d]));
          found = worst < 1e-4f;
          seen[c] += found;
        }
        CHECK(found);
      }
      for (std::size_t count : seen) CHECK(count > 0);
    }
}

}  // namespace windows_test
