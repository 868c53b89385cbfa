// Motions as pose vectors and back, and their normalisation.
#include "motiongan/data/pose.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "motiongan/data/normalizer.hpp"

namespace pose_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

Motion spinning(std::size_t frames) {
  Motion m;
  m.skeleton.joints = {
      {"World", -1, {0, 0, 0}, {}, {}}, {"Hips", 0, {0, 1, 0}, {}, {}}, {"Arm", 1, {1, 2, 3}, {}, {}}};
  m.rate = 10;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f);
    m.rotations.insert(m.rotations.end(), {Quat{}, quat_from_expmap({0, 0.3 * t, 0}),
                                           quat_from_expmap({0.1 * t, -0.2, 0.5 * std::sin(t)})});
    m.positions.insert(m.positions.end(), {Vec3{}, Vec3{t, 1, -t}, Vec3{1, 2, 3}});
  }
  return m;
}

}  // namespace

TEST_CASE("the values of a pose and their names") {
  const PoseLayout with(spinning(1).skeleton, true, 1), without(spinning(1).skeleton, false);
  CHECK(with.dof() == 12);
  CHECK(without.dof() == 9);
  CHECK(with.name(0) == "World.x");
  CHECK(with.name(5) == "Hips.z");
  CHECK(with.name(10) == "Hips.position.y");
  CHECK(with.position_dim() == 9);
  CHECK_THROWS_WITH_AS(without.name(9), doctest::Contains("dimension 9 does not exist; there are 9"), Error);
  CHECK_THROWS_AS(without.position_dim(), Error);
  CHECK_THROWS_WITH_AS(PoseLayout(spinning(1).skeleton, true, 3), doctest::Contains("root joint 3"), Error);
}

TEST_CASE("poses of a motion are continuous and decode to the motion") {
  const Motion m = spinning(60);  // the hips make almost three turns
  const PoseLayout layout(m.skeleton, true, 1);
  const std::vector<double> poses = layout.encode(m);
  REQUIRE(poses.size() == 60 * 12);
  for (std::size_t f = 0; f < 60; ++f) {
    CHECK(poses[f * 12 + 4] == doctest::Approx(0.3 * double(f)).epsilon(1e-12));
    CHECK(poses[f * 12 + 9] == double(f));
    CHECK(poses[f * 12 + 11] == -double(f));
  }
  for (std::size_t i = 12; i < poses.size(); ++i) CHECK(std::abs(poses[i] - poses[i - 12]) < 1.01);
  const Motion back = layout.decode(poses, 60, 10);
  CHECK(back.skeleton == m.skeleton);
  CHECK(back.positions == m.positions);
  for (std::size_t i = 0; i < m.rotations.size(); ++i)
    CHECK(angle_between(back.rotations[i], m.rotations[i]) < 1e-12);

  const PoseLayout still(m.skeleton, false);
  CHECK(still.decode(still.encode(m), 60, 10).position(7, 1) == Vec3{0, 1, 0});  // the offset
  CHECK_THROWS_WITH_AS(layout.decode(poses, 59, 10), doctest::Contains("found 720 pose values, expected 59"),
                       Error);
  Motion other = m;
  other.skeleton.joints.pop_back();
  other.rotations.resize(120);
  other.positions.resize(120);
  CHECK_THROWS_WITH_AS(layout.encode(other), doctest::Contains("2 joints does not fit"), Error);
}

TEST_CASE("normalised values have mean 0 and deviation 1; constants are dropped and restored") {
  std::vector<double> poses;
  for (int f = 0; f < 50; ++f) poses.insert(poses.end(), {3.0 * f, 7.25, std::sin(f), 1e-5 * f});
  const Normalizer n = Normalizer::fit(poses, 4);
  CHECK(n.kept() == std::vector<std::size_t>{0, 2, 3});
  CHECK(n.mean()[0] == doctest::Approx(73.5));
  CHECK(n.std()[0] == doctest::Approx(3 * std::sqrt((50.0 * 50 - 1) / 12)));  // ddof 0
  const std::vector<double> out = n.normalize<double>(poses);
  REQUIRE(out.size() == 150);
  for (std::size_t k = 0; k < 3; ++k) {
    double sum = 0, squares = 0;
    for (std::size_t f = 0; f < 50; ++f) sum += out[f * 3 + k], squares += out[f * 3 + k] * out[f * 3 + k];
    CHECK(std::abs(sum) < 1e-10);
    CHECK(squares == doctest::Approx(50));
  }
  const std::vector<double> back = n.denormalize(std::span<const double>(out));
  for (std::size_t i = 0; i < poses.size(); ++i) CHECK(std::abs(back[i] - poses[i]) < 1e-12);
  const std::vector<float> coarse = n.normalize<float>(poses);
  CHECK(n.denormalize(std::span<const float>(coarse))[4 * 49] == doctest::Approx(147));

  std::vector<double> still;
  for (int f = 0; f < 50; ++f) still.insert(still.end(), {1e-6 * f, double(f)});
  CHECK(Normalizer::fit(still, 2).kept() == std::vector<std::size_t>{1});
}

TEST_CASE("sizes that do not match are errors") {
  const Normalizer n({1, 2, 3}, {1, 0, 1});
  const std::vector<double> seven(7);
  CHECK_THROWS_WITH_AS(n.normalize<float>(seven),
                       doctest::Contains("7 values to normalise, expected a multiple of 3"), Error);
  CHECK_THROWS_WITH_AS(n.denormalize(std::span<const double>(seven)), doctest::Contains("a multiple of 2"),
                       Error);
  CHECK_THROWS_AS(Normalizer({1, 2}, {1}), Error);
  CHECK_THROWS_AS(Normalizer({1}, {-1}), Error);
  CHECK_THROWS_AS(Normalizer({std::nan("")}, {1}), Error);
  CHECK_THROWS_AS(Normalizer::fit({}, 3), Error);
  CHECK_THROWS_AS(Normalizer::fit(seven, 0), Error);
}

}  // namespace pose_test
