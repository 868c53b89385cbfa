// Height, legs and the up axis of bodies, and turning a z-up world to y up.
#include "motiongan/motion/body.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "../support/bodies.hpp"

namespace body_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("height and legs of a body") {
  const Skeleton body = body_skeleton();
  // From the toes' end at -95 to the head's at 75.
  CHECK(body_height(body) == doctest::Approx(170));
  CHECK(leg_length(body) == doctest::Approx(84 + std::hypot(10.0, 5.0)));
  CHECK(body_height(in_z_up(standing_body(1)).skeleton) == doctest::Approx(170));
  CHECK(body_height(scaled(body, 0.01)) == doctest::Approx(1.7));
  CHECK(likely_unit_metres(170) == 0.01);
  CHECK(likely_unit_metres(1.7) == 1);
  CHECK(likely_unit_metres(1700) == 0.001);
  CHECK(likely_unit_metres(26) == 0);  // CMU's
  // The root's offset, which files use for anything, does not count.
  Skeleton far = body;
  far.joints.front().offset = {0, 1e4, 0};
  CHECK(body_height(far) == doctest::Approx(170));
  CHECK(body_height(Skeleton{}) == 0);
  CHECK(leg_length(Skeleton{}) == 0);
}

TEST_CASE("sizes are made alike only if they differ by more than those of people") {
  const Skeleton body = body_skeleton();
  CHECK(scale_to(body, scaled(body, 0.01)) == doctest::Approx(100));
  CHECK(scale_to(body, scaled(body, 0.7)) == 1);
  CHECK(scale_to(body, scaled(body, 0.6)) == doctest::Approx(1 / 0.6));
  CHECK(scale_to(body, Skeleton{}) == 1);
}

TEST_CASE("the up axis is detected where it is sure") {
  const Motion y = standing_body(80), z = in_z_up(y);
  CHECK(detect_up_axis(y, 0) == UpAxis::y);
  CHECK(detect_up_axis(z, 0) == UpAxis::z);
  CHECK(rest_up_axis(y.skeleton) == UpAxis::y);
  CHECK(rest_up_axis(z.skeleton) == UpAxis::z);
  CHECK(detect_up_axis(y.skeleton, joint_positions(y)) == UpAxis::y);
  CHECK(detect_up_axis(z.skeleton, joint_positions(z)) == UpAxis::z);  // it walks

  // A y-up body that lies down with its head to +z stays in place: not sure.
  Motion lying = standing_body(40, 0);
  for (std::size_t f = 0; f < lying.frames; ++f) lying.rotation(f, 0) = axis_rotation(0, pi / 2);
  CHECK_FALSE(detect_up_axis(lying, 0).has_value());
  CHECK_FALSE(detect_up_axis(lying.skeleton, joint_positions(lying)).has_value());
  // A y-up rest pose walking over the xy plane, as SMPL bodies in z-up worlds do.
  Motion smpl = standing_body(80);
  for (std::size_t f = 0; f < smpl.frames; ++f) {
    smpl.rotation(f, 0) = axis_rotation(0, pi / 2);
    smpl.position(f, 0) = {0, -2 * static_cast<double>(f), 95};
  }
  CHECK(detect_up_axis(smpl, 0) == UpAxis::z);
  const std::vector<Vec3> p = joint_positions(from_z_up(smpl)), expected = joint_positions(standing_body(80));
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(length(subtract(p[i], expected[i])) < 1e-9);

  Motion nameless = y;
  for (Joint& joint : nameless.skeleton.joints)
    joint.name = "j" + std::to_string(&joint - &nameless.skeleton.joints[0]);
  CHECK_FALSE(detect_up_axis(nameless, 0).has_value());
}

TEST_CASE("a z-up motion is turned exactly") {
  const Motion y = standing_body(30), back = from_z_up(in_z_up(y));
  CHECK(back.positions == y.positions);
  CHECK(back.rotations == y.rotations);
  for (std::size_t j = 0; j < y.skeleton.size(); ++j) {
    CHECK(back.skeleton.joints[j].offset == y.skeleton.joints[j].offset);
    CHECK(back.skeleton.joints[j].end_site == y.skeleton.joints[j].end_site);
  }
  // Channels keep their meaning: turns about z, which was up, are turns about y.
  CHECK(back.skeleton.joints[1].channels ==
        std::vector<Channel>{Channel::y_rotation, Channel::x_rotation, Channel::z_rotation});
}

}  // namespace body_test
