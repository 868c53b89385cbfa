// Bone-length error of motions: rotations keep lengths, position channels may not.
#include "motiongan/metrics/bone_length_error.hpp"

#include <doctest/doctest.h>

namespace bone_length_error_test {

using namespace motiongan;

namespace {

/// A static joint, moving hips, and a leg of two bones of lengths 2 and 4.
motion::Motion walker() {
  motion::Motion m;
  m.skeleton.joints = {{"World", -1, {}, {}, {}},
                       {"Hips", 0, {0, 1, 0}, {}, {}},
                       {"Knee", 1, {0, -2, 0}, {}, {}},
                       {"Foot", 2, {0, -4, 0}, {}, {}}};
  m.rate = 10;
  m.frames = 3;
  for (int f = 0; f < 3; ++f) {
    m.rotations.insert(m.rotations.end(), {{}, {}, motion::axis_rotation(0, 0.4 * f), {}});
    m.positions.insert(m.positions.end(), {{}, {7.0 * f, 1, 0}, {0, -2, 0}, {0, -4, 0}});
  }
  return m;
}

}  // namespace

TEST_CASE("rotations, and a moving root below a static joint, have no error") {
  CHECK(bone_length_error(walker()) < 1e-12);
}

TEST_CASE("one wrong bone in one frame of three, by hand") {
  motion::Motion m = walker();
  m.position(1, 3) = {0, -5, 0};  // 25% in one of 2 bones x 3 frames
  CHECK(bone_length_error(m) == doctest::Approx(25.0 / 6));
  m.position(2, 2) = {0, 0, 1};  // and 50% in another
  CHECK(bone_length_error(m) == doctest::Approx(75.0 / 6));
}

TEST_CASE("a skeleton without bones is rejected") {
  motion::Motion m;
  m.skeleton.joints = {{"Hips", -1, {}, {}, {}}};
  m.rate = 10;
  m.frames = 1;
  m.rotations.resize(1);
  m.positions.resize(1);
  CHECK_THROWS_WITH_AS(bone_length_error(m), doctest::Contains("no bone with a length"), Error);
}

}  // namespace bone_length_error_test
