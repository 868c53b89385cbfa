// Bone lengths, seams and distances, by hand and on procedural motion.
#include "motiongan/metrics/position_metrics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "../support/messages.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace position_metrics_test {

using namespace motiongan;
using motion::Vec3;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

/// Bones of length 2, 0 and 4.
motion::Skeleton chain() {
  motion::Skeleton s;
  s.joints = {{"A", -1, {7, 7, 7}, {}, {}},
              {"B", 0, {2, 0, 0}, {}, {}},
              {"C", 1, {0, 0, 0}, {}, {}},
              {"D", 2, {0, 4, 0}, {}, {}}};
  return s;
}

}  // namespace

TEST_CASE("bone-length error in percent, relative to the rest pose or a frame") {
  const std::vector<Vec3> positions{{0, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 4, 0},   // as at rest
                                    {0, 0, 0}, {0, 3, 0}, {0, 3, 0}, {0, 3, 3}};  // errors of 50% and 25%
  CHECK(bone_length_error(chain(), positions) == doctest::Approx((0 + 0 + 50 + 25) / 4.0));
  const std::vector<Vec3> reference{{1, 1, 1}, {1, 2, 1}, {1, 2, 1}, {1, 5, 1}};  // lengths 1 and 3
  CHECK(bone_length_error(chain(), positions, reference) == doctest::Approx((100 + 100 / 3.0 + 200 + 0) / 4));
  CHECK(says(message_of([&] { bone_length_error(chain(), positions, std::vector<Vec3>(4)); }), "joint 'B'"));
  CHECK_THROWS_AS(bone_length_error(chain(), positions, std::vector<Vec3>(3)), Error);
  CHECK_THROWS_AS(bone_length_error(chain(), {}), Error);
  CHECK_THROWS_AS(bone_length_error(chain(), std::vector<Vec3>(5)), Error);
  motion::Skeleton point;
  point.joints = {{"A", -1, {1, 0, 0}, {}, {}}};
  CHECK_THROWS_AS(bone_length_error(point, std::vector<Vec3>(2)), Error);
}

TEST_CASE("steps between frames, with and without the root's step") {
  const std::vector<Vec3> a{{0, 0, 0}, {1, 0, 0}}, b{{3, 0, 0}, {4, 0, 4}};
  const FrameStep step = seam_jump(a, b);
  CHECK(step.world == doctest::Approx((3 + 5) / 2.0));
  CHECK(step.body == doctest::Approx((0 + 4) / 2.0));
  CHECK(seam_jump(a, b, 0.01).world == doctest::Approx(0.04));
  CHECK_THROWS_AS(seam_jump(a, std::vector<Vec3>(3)), Error);

  // The root moves by 1, 10, 2, the other joint relative to it by 5, 0, 7.
  const std::vector<Vec3> walk{{0, 0, 0},  {0, 0, 0},  {1, 0, 0},  {1, 5, 0},
                               {11, 0, 0}, {11, 5, 0}, {13, 0, 0}, {13, 12, 0}};
  CHECK(median_step(walk, 2).body == doctest::Approx(2.5));
  CHECK(median_step(walk, 2, 2).body == doctest::Approx(5));
  CHECK(median_step(walk, 2).world == doctest::Approx((2 + std::sqrt(53.0)) / 2));  // of 3.05, 10 and 4.64
  CHECK_THROWS_AS(median_step(walk, 8), Error);
  CHECK_THROWS_AS(median_step(walk, 3), Error);
}

TEST_CASE("distances over the ground") {
  const std::vector<Vec3> square{{0, 5, 0}, {9, 9, 9}, {3, 0, 0}, {9, 9, 9}, {3, 7, 4}, {9, 9, 9}};
  const Distance d = distance_travelled(square, 2);
  CHECK(d.path == doctest::Approx(7));
  CHECK(d.net == doctest::Approx(5));
  CHECK(distance_travelled(square, 2, 0.1).net == doctest::Approx(0.5));
  CHECK(distance_travelled({}, 2).path == 0);
  CHECK_THROWS_AS(distance_travelled(square, 4), Error);
}

TEST_CASE("the procedural walk keeps its bone lengths and travels") {
  const motion::LabelledMotion l = motion::procedural_motion(0, {.seconds = 4});
  const std::vector<Vec3> positions = motion::joint_positions(l.motion);
  const std::size_t joints = l.motion.skeleton.size();
  CHECK(bone_length_error(l.motion.skeleton, positions) < 1e-10);
  const Distance d = distance_travelled(positions, joints, 0.01);  // centimetres
  CHECK(d.path > 1);
  CHECK(d.path < 20);
  CHECK(d.net <= d.path);
  const FrameStep step = median_step(positions, joints, 0.01);
  CHECK(step.world > step.body);
  CHECK(step.world > 0.005);
  CHECK(step.world < 0.2);
}

}  // namespace position_metrics_test
