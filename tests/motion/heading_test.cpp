// Yaw and tilt, and windows that start at the origin facing the same way.
#include "motiongan/motion/heading.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "../support/walking_clips.hpp"
#include "motiongan/data/dataset.hpp"

namespace heading_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

Quat about(std::size_t axis, double angle) { return axis_rotation(axis, angle); }

}  // namespace

TEST_CASE("a rotation converts to tilt, yaw, tilt and back") {
  for (double yaw : {-3.0, -1.0, 0.0, 0.5, 3.1})
    for (double x : {-1.5, 0.0, 0.3})
      for (double z : {-0.7, 0.0, 2.0}) {
        const Quat q = multiply(about(1, yaw), quat_from_expmap({x, 0, z}));
        const Vec3 h = heading_from_quat(q);
        CHECK(h[0] == doctest::Approx(x).epsilon(1e-12));
        CHECK(h[1] == doctest::Approx(yaw).epsilon(1e-12));
        CHECK(h[2] == doctest::Approx(z).epsilon(1e-12));
        CHECK(angle_between(quat_from_heading(h), q) < 1e-7);
      }
  CHECK(angle_between(quat_from_heading(heading_from_quat(about(0, pi))), about(0, pi)) <
        1e-7);  // upside down
}

TEST_CASE("the yaw is unwrapped over whole turns") {
  Motion m = curved_walk(0, {}, 200);  // 18 radians
  const PoseLayout layout(m.skeleton, true, 0, RootRotation::heading);
  CHECK(layout.yaw_dim() == 1);
  CHECK(layout.name(1) == "Hips.yaw");
  CHECK(layout.name(2) == "Hips.z");
  const std::vector<double> poses = layout.encode(m);
  CHECK(poses[199 * layout.dof() + 1] == doctest::Approx(0.9 * 19.9));
  const Motion back = layout.decode(poses, m.frames, m.rate);
  for (std::size_t f = 0; f < m.frames; ++f)
    for (std::size_t j = 0; j < 2; ++j) CHECK(angle_between(back.rotation(f, j), m.rotation(f, j)) < 1e-7);
  CHECK_THROWS_WITH_AS(PoseLayout(m.skeleton).yaw_dim(), doctest::Contains("no yaw"), Error);
}

TEST_CASE("a window does not depend on where and in which direction it was recorded") {
  const Vec3 there{5, 0, -3};
  const Dataset data = Dataset::from_motions({{"a", curved_walk(0, {}, 40), {"walk"}},
                                              {"b", curved_walk(2.5, there, 40), {"walk"}},
                                              {"c", curved_walk(-1, {}, 40), {"walk"}}},
                                             {.frames = 8, .rate = 5, .train_share = 1});
  REQUIRE(data.train.size() >= 2);
  CHECK(data.stride == 2);
  CHECK(data.format.relative_dims.size() == 3);
  const std::size_t dof = data.format.dof();
  std::vector<float> first(8 * dof), other(8 * dof);
  for (std::size_t start : {std::size_t{0}, std::size_t{9}, std::size_t{20}}) {
    data.window(data.train[0], start, first);
    data.window(data.train[1], start, other);
    for (std::size_t i = 0; i < first.size(); ++i) CHECK(first[i] == doctest::Approx(other[i]).epsilon(1e-4));
    // As motion again, it starts at the origin with yaw 0 and repeats the recording relative to that.
    const Motion source = curved_walk(0, {}, 40), motion = data.to_motion(first);
    const Quat turn_back =
        inverse(quat_from_heading({0, heading_from_quat(source.rotation(start, 0))[1], 0}));
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t f = start + 2 * i;
      CHECK(angle_between(motion.rotation(i, 0), multiply(turn_back, source.rotation(f, 0))) < 1e-5);
      Vec3 moved = subtract(source.position(f, 0), source.position(start, 0));
      moved[1] = source.position(f, 0)[1];
      const Vec3 expected = rotate(turn_back, moved);
      for (std::size_t c = 0; c < 3; ++c)
        CHECK(motion.position(i, 0)[c] == doctest::Approx(expected[c]).epsilon(1e-5));
    }
  }
}

}  // namespace heading_test
