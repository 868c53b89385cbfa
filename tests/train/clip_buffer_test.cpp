// Windows of clips on the device.
#include <doctest/doctest.h>

#include <motiongan/train/clip_buffer.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace clip_buffer_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("a window that exceeds the buffer is an error" * doctest::test_suite("double")) {
  const std::vector<float> clip(20);
  const ClipBuffer buffer(double_context(), 2, {std::span<const float>(clip)});
  CHECK_NOTHROW(buffer.gather({0, 7}, 3));
  CHECK(says(message_of([&] {
               buffer.gather({0, 8}, 3);
             }),
             "a window's first frame: index 8 at place 1 of 2, expected 0 to 7"));
  CHECK_NOTHROW(buffer.gather({5}, 3, 2));
  CHECK_THROWS_AS(buffer.gather({6}, 3, 2), Error);
  CHECK_THROWS_AS(buffer.gather({-1}, 1), Error);
}

}  // namespace clip_buffer_test
