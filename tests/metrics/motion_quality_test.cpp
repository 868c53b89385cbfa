// Quality of a set of motions: each by its own body, whatever their order and size.
#include "motiongan/metrics/motion_quality.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "../support/bodies.hpp"
#include "motiongan/motion/body.hpp"

namespace motion_quality_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("bodies of different size measure alike, in any order") {
  // A child and an adult who move alike, relative to their legs.
  const Motion adult = standing_body(60, 5), child = scaled(adult, 0.6);
  const MotionQuality alone = measure_quality(std::vector{adult}),
                      first = measure_quality(std::vector{adult, child}),
                      last = measure_quality(std::vector{child, adult});
  CHECK(alone.length_unit == "legs");
  CHECK(alone.jerk > 0);
  for (const MotionQuality& q : {first, last}) {
    CHECK(q.jerk == doctest::Approx(alone.jerk).epsilon(1e-9));
    REQUIRE(q.feet.has_value());
    CHECK(q.feet->ratio() == alone.feet->ratio());
    CHECK(q.feet->contact_share() == alone.feet->contact_share());
  }
  // Different motions of different bodies: the order does not matter.
  const Motion fast = scaled(standing_body(60, 9), 0.6);
  CHECK(measure_quality(std::vector{adult, fast}).jerk ==
        doctest::Approx(measure_quality(std::vector{fast, adult}).jerk).epsilon(1e-12));
  // In metres the unit is the files'.
  FootSkateOptions metres;
  metres.unit_metres = 0.01;
  CHECK(measure_quality(std::vector{child}, metres).jerk ==
        doctest::Approx(0.6 * measure_quality(std::vector{adult}, metres).jerk).epsilon(1e-9));
}

}  // namespace motion_quality_test
