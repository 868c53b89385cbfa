// NPSS, against numpy and by hand.
#include "motiongan/metrics/npss.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace npss_test {

using namespace motiongan;

namespace {

constexpr std::size_t frames = 25;

/// [25, 4]: f(frame, dimension).
template <class F>
std::vector<double> sequence(F&& f) {
  std::vector<double> out;
  for (int t = 0; t < static_cast<int>(frames); ++t)
    for (int d = 0; d < 4; ++d) out.push_back(f(t, d));
  return out;
}

}  // namespace

TEST_CASE("two sequences of four dimensions, compared with numpy.fft") {
  const auto truth1 = sequence([](int t, int d) { return std::sin(0.4 * t * (d + 1)) + 0.1 * d; });
  const auto truth2 = sequence([](int t, int d) { return std::cos(0.3 * t * (d + 1)) * (d + 1); });
  const auto made1 = sequence([](int t, int d) { return std::sin(0.5 * t * (d + 1)) + 0.2 * d; });
  const auto made2 = sequence([](int t, int d) { return std::cos(0.3 * t * (d + 1) + 0.1 * t) * (d + 1); });
  Npss magnitude, real(SpectralPower::real_part);
  for (Npss* const npss : {&magnitude, &real}) {
    npss->add(truth1, made1, frames);
    npss->add(truth2, made2, frames);
    CHECK(npss->sequences() == 2);
  }
  CHECK(magnitude.value() == doctest::Approx(0.6653816319228626).epsilon(1e-9));
  CHECK(real.value() == doctest::Approx(1.837268953610913).epsilon(1e-9));
  Npss same;
  same.add(truth1, truth1, frames);
  CHECK(same.value() == 0);
}

TEST_CASE("by hand: all power moves from frequency 0 to frequency 1") {
  // 1 1 1 1 has all its power at 0; 1 0 -1 0 has half at 1 and half at 3. Cumulative: 1 1 1 1 and
  // 0 1/2 1/2 1, with a distance of 1 + 1/2 + 1/2 + 0.
  const std::vector<double> flat{1, 1, 1, 1}, wave{1, 0, -1, 0};
  Npss one, weighted;
  one.add(flat, wave, 4);
  CHECK(one.value() == doctest::Approx(2));
  // Add a correct dimension of nine times the power, and a constant zero one, which has no weight.
  const std::vector<double> truth{1, 3, 0, 1, 3, 0, 1, 3, 0, 1, 3, 0},
      made{1, 3, 5, 0, 3, 4, -1, 3, 3, 0, 3, 2};
  weighted.add(truth, made, 4);
  CHECK(weighted.value() == doctest::Approx(2.0 / 10));
  // A scaled copy has the same normalised spectrum.
  Npss louder;
  louder.add(wave, std::vector<double>{5, 0, -5, 0}, 4);
  CHECK(louder.value() < 1e-12);
}

TEST_CASE("angles of a motion follow the prediction papers, without the root") {
  motion::Motion m;
  m.skeleton.joints = {{"Hips", -1, {}, {}, {}}, {"Knee", 0, {0, -2, 0}, {}, {}}};
  m.rate = 10;
  m.frames = 2;
  m.positions.resize(4);
  m.rotations = {
      {}, motion::axis_rotation(0, 0.5), motion::axis_rotation(1, 1), motion::axis_rotation(0, 0.7)};
  const std::vector<double> angles = prediction_angles(m);
  REQUIRE(angles.size() == 6);
  CHECK(std::abs(angles[0]) == doctest::Approx(0.5).epsilon(1e-6));
  CHECK(std::abs(angles[3]) == doctest::Approx(0.7).epsilon(1e-6));
  CHECK(angles[0] * angles[3] > 0);
  for (const std::size_t i : {1u, 2u, 4u, 5u}) CHECK(std::abs(angles[i]) < 1e-9);
}

TEST_CASE("sequences that do not fit are rejected") {
  Npss npss;
  const std::vector<double> four(4), three(3);
  CHECK_THROWS_WITH_AS(npss.value(), doctest::Contains("no sequence was added"), Error);
  CHECK_THROWS_WITH_AS(npss.add(four, three, 1), doctest::Contains("found 4 true and 3 predicted"), Error);
  CHECK_THROWS_WITH_AS(npss.add(four, four, 3), doctest::Contains("of 3 frames"), Error);
}

}  // namespace npss_test
