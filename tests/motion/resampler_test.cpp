// Resampling of motion in pieces, and aligned to its end.
#include "motiongan/motion/resampler.hpp"

#include <doctest/doctest.h>

#include "../support/messages.hpp"
#include "../support/walking_clips.hpp"

namespace resampler_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

TEST_CASE("pieces of any size give the resampled whole bit for bit, at lower and higher rates") {
  const Motion whole = walk(203.0 / 30, 30, 1.3);
  REQUIRE(whole.frames > 150);
  for (const double rate : {30.0, 12.5, 60.0, 7.0, 100.0, 0.01}) {
    const Motion expected = resample(whole, rate);
    for (const std::size_t size : {1, 2, 64, 1000}) {
      CAPTURE(rate);
      CAPTURE(size);
      Resampler resampler(whole.frames, 30, rate);
      CHECK(resampler.total() == expected.frames);
      Motion all = slice(expected, 0, 0);
      for (std::size_t at = 0; at < whole.frames; at += size)
        all = join(std::move(all), resampler.append(slice(whole, at, std::min(size, whole.frames - at))));
      CHECK(all.frames == expected.frames);
      CHECK(all.rotations == expected.rotations);
      CHECK(all.positions == expected.positions);
      CHECK(says(message_of([&] { resampler.append(slice(whole, 0, 1)); }), "frames to resample"));
    }
  }
  Resampler other(10, 25, 5);
  CHECK(says(message_of([&] { other.append(whole); }), "a piece of 30 frames per second"));
  CHECK(says(message_of([] { Resampler(10, 30, 0); }), "cannot resample from 30 to 0"));
}

TEST_CASE("aligned to the end: the last frame is kept, and steps count backwards") {
  const Motion whole = walk(2, 30, 1.3);
  const Motion back = resample_to_end(whole, 12.5);
  CHECK(back.frames == resample(whole, 12.5).frames);
  CHECK(back.rate == 12.5);
  for (std::size_t j = 0; j < whole.skeleton.size(); ++j) {
    CHECK(back.rotation(back.frames - 1, j) == whole.rotation(whole.frames - 1, j));
    CHECK(back.rotation(back.frames - 6, j) ==
          whole.rotation(whole.frames - 13, j));  // 5 steps are 12 frames
  }
  CHECK(back.rotation(0, 1) != whole.rotation(0, 1));
  CHECK(resample_to_end(slice(whole, 0, 1), 4).frames == 1);
}

TEST_CASE("motions are joined") {
  const Motion whole = walk(1, 30, 1.3);
  const Motion joined = join(slice(whole, 0, 9), slice(whole, 9, whole.frames - 9));
  CHECK(joined.frames == whole.frames);
  CHECK(joined.rotations == whole.rotations);
  CHECK(joined.positions == whole.positions);
  CHECK(says(message_of([&] { join(whole, resample(whole, 10)); }), "cannot follow one of"));
}

}  // namespace resampler_test
