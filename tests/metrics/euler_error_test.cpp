// The motion-prediction papers' error, against numpy and against published values on real data.
#include "motiongan/metrics/euler_error.hpp"

#include <doctest/doctest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "motiongan/formats/bvh.hpp"

namespace euler_error_test {

using namespace motiongan;
using motion::Mat3, motion::Motion, motion::Vec3;
namespace fs = std::filesystem;

namespace {

/// Errors after frame 50 of a prediction that repeats the 50th of 75 ground-truth frames.
std::vector<double> zero_velocity(const std::vector<double>& rows, std::size_t width) {
  std::vector<double> held = rows;
  for (std::size_t f = 50; f < 75; ++f)
    for (std::size_t d = 0; d < width; ++d) held[f * width + d] = rows[49 * width + d];
  std::vector<double> errors = euler_errors(rows, held, 75);
  for (std::size_t f = 0; f < 50; ++f) REQUIRE(errors[f] == 0);
  errors.erase(errors.begin(), errors.begin() + 50);
  return errors;
}

/// The papers' draw: 8 start frames that leave room for 75 of `frames` frames.
std::vector<std::size_t> draws(std::size_t frames) {
  std::mt19937 bits(1234567890);
  const auto most = static_cast<std::uint32_t>(frames - 75 - 1);
  std::uint32_t mask = 1;
  while (mask < most) mask = 2 * mask + 1;
  std::vector<std::size_t> out;
  while (out.size() < 8) {
    const auto value = static_cast<std::uint32_t>(bits()) & mask;
    if (value <= most) out.push_back(value);
  }
  return out;
}

fs::path shared_data() {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const fs::path shared = set ? fs::path(set) : fs::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared";
  if (fs::is_directory(shared / "data" / "cmu-expmap")) return shared / "data";
  MESSAGE("skipped: no data folder in " << shared.string());
  return {};
}

/// Every second row of a text file, without the root's position and rotation, [frames, 111].
std::vector<double> every_second_row(const fs::path& path) {
  const std::string text = motion::read_text(path, "text");
  std::vector<double> out;
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t stop = std::min(text.find_first_of(",\r\n", at), text.size());
    double value = 0;
    if (std::from_chars(text.data() + at, text.data() + stop, value).ec == std::errc()) {
      if (count / 117 % 2 == 0 && count % 117 >= 6) out.push_back(value);
      ++count;
    }
    at = stop + 1;
  }
  REQUIRE(count % 117 == 0);
  return out;
}

void check_near(const Vec3& found, const Vec3& expected) {
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(found[i] - expected[i]) < 1e-10);
}

}  // namespace

TEST_CASE("Euler angles of exponential maps, compared with numpy") {
  check_near(prediction_euler(Vec3{.3, -.5, .7}), {-0.466206990629, 0.342361170104, -0.802038665255});
  check_near(prediction_euler(Vec3{0, 0, 0}), {0, 0, 0});
  check_near(prediction_euler(Vec3{2.5, .4, -1.1}), {-2.51717938454, 0.697079472319, 0.550810925932});
  check_near(prediction_euler(Vec3{1e-5, 0, 0}), {-9.88219505483e-06, 0, 0});  // the epsilon shows
  check_near(prediction_euler(Vec3{-.2, 3.0, .1}), {3.06606072873, -0.128461867995, -3.00359584477});
  check_near(prediction_euler(Vec3{0, motion::pi / 2, 0}), {0, -1.57040673474, 0});
}

TEST_CASE("Euler angles where R02 is 1 or -1") {
  check_near(prediction_euler(Mat3{0, 0, 1, 0.6, 0.8, 0, -0.8, 0.6, 0}), {0, -motion::pi / 2, 0});
  check_near(prediction_euler(Mat3{0, 0, -1, 0.6, 0.8, 0, 0.8, -0.6, 0}), {motion::pi, motion::pi / 2, 0});
  check_near(prediction_euler(Mat3{0, 0, 1 + 1e-15, 0, 1, 0, -1, 0, 0}), {0, -motion::pi / 2, 0});
}

TEST_CASE("errors per frame, compared with numpy; constant ground-truth angles do not count") {
  std::vector<double> truth, prediction;
  for (int k = 0; k < 4; ++k) {
    truth.insert(truth.end(), {.1 * k, .2 * k * k, -.3, .5, .6, .7});
    prediction.insert(prediction.end(), {.1 * k + .05, .1 * k, -.3 * k, 9, 9, 9});
  }
  const std::vector<double> expected{0.304137985896, 0.111007689613, 0.650949279707, 2.35337623192};
  const std::vector<double> errors = euler_errors(truth, prediction, 4);
  REQUIRE(errors.size() == 4);
  for (std::size_t f = 0; f < 4; ++f) CHECK(std::abs(errors[f] - expected[f]) < 1e-10);

  // The same as motions: inverse rotations of two joints below an ignored root.
  Motion a, b;
  for (Motion* m : {&a, &b}) {
    m->skeleton.joints = {{"Hips", -1, {}, {}, {}}, {"Arm", 0, {}, {}, {}}, {"Hand", 1, {}, {}, {}}};
    m->rate = 25;
    m->frames = 4;
    m->positions.assign(12, Vec3{});
    for (std::size_t f = 0; f < 4; ++f) {
      const double* row = (m == &a ? truth : prediction).data() + 6 * f;
      m->rotations.push_back(motion::quat_from_expmap({0, m == &a ? 0.4 : 0.1 * double(f), 0}));
      m->rotations.push_back(motion::quat_from_expmap({-row[0], -row[1], -row[2]}));
      m->rotations.push_back(motion::quat_from_expmap({-row[3], -row[4], -row[5]}));
    }
  }
  const std::vector<double> of_motions = euler_errors(a, b);
  for (std::size_t f = 0; f < 4; ++f) CHECK(std::abs(of_motions[f] - expected[f]) < 1e-6);
  CHECK(euler_errors(a, b, 1)[1] == 0);  // the moving arm is the root here, and left out

  Motion other = b;
  other.rate = 30;
  CHECK_THROWS_WITH_AS(euler_errors(a, other), doctest::Contains("25 frames per second, the prediction 30"),
                       Error);
  CHECK_THROWS_WITH_AS(euler_errors(a, motion::slice(b, 0, 3)), doctest::Contains("4 frames of 3 joints"),
                       Error);
  CHECK_THROWS_WITH_AS(euler_errors(a, b, 3), doctest::Contains("root joint 3"), Error);
  CHECK_THROWS_WITH_AS(euler_errors(truth, prediction, 5), doctest::Contains("24 values in 5 frames"), Error);
  CHECK_THROWS_WITH_AS(euler_errors(truth, std::span(prediction).first(6), 4),
                       doctest::Contains("of the ground truth and 6"), Error);
}

TEST_CASE("zero velocity on the CMU texts gives the published errors") {
  const fs::path data = shared_data();
  if (data.empty()) return;
  const std::vector<std::size_t> shown{1, 3, 7, 9, 13, 24};
  const std::vector<std::pair<std::string, std::vector<double>>> published{
      {"walking", {.407, .602, .832, .951, 1.085, 1.338}},
      {"basketball", {.488, .821, 1.404, 1.640, 2.048, 2.831}},
      {"jumping", {.363, .616, 1.484, 1.683, 1.988, 2.027}}};
  std::size_t compared = 0;
  for (const auto& entry : published) {
    const std::string& action = entry.first;
    const std::vector<double>& expected = entry.second;
    const fs::path path = data / "cmu-expmap" / "test" / action / (action + "_1.txt");
    if (!fs::exists(path)) continue;
    CAPTURE(action);
    const std::vector<double> rows = every_second_row(path);
    std::vector<double> mean(25);
    for (const std::size_t start : draws(rows.size() / 111)) {
      const auto first = rows.begin() + static_cast<std::ptrdiff_t>(start * 111);
      const std::vector<double> errors = zero_velocity({first, first + 75 * 111}, 111);
      for (std::size_t f = 0; f < 25; ++f) mean[f] += errors[f] / 8;
    }
    for (std::size_t i = 0; i < shown.size(); ++i) CHECK(std::abs(mean[shown[i]] - expected[i]) < 6e-4);
    ++compared;
  }
  MESSAGE("compared " << compared << " actions with the published errors");
  CHECK(compared > 0);
}

TEST_CASE("a BVH file gives the errors of its text file") {
  const fs::path data = shared_data();
  const fs::path text = data / "cmu-expmap" / "test" / "walking_extra" / "walking_10.txt";
  const fs::path bvh = data / "cmu" / "35" / "35_10.bvh";
  if (data.empty() || !fs::exists(text) || !fs::exists(bvh)) return;
  const std::vector<double> rows = every_second_row(text);
  const Motion whole = motion::resample(motion::to_motion(motion::read_bvh(bvh)), 60);  // every second frame
  REQUIRE(rows.size() == whole.frames * 111);
  const Motion truth = motion::slice(whole, 40, 75);
  Motion held = truth;
  for (std::size_t f = 50; f < 75; ++f)
    for (std::size_t j = 0; j < held.skeleton.size(); ++j) held.rotation(f, j) = truth.rotation(49, j);
  const std::vector<double> of_bvh = euler_errors(truth, held);
  const std::vector<double> of_text = zero_velocity({rows.begin() + 40 * 111, rows.begin() + 115 * 111}, 111);
  for (std::size_t f = 0; f < 25; ++f) CHECK(std::abs(of_bvh[50 + f] - of_text[f]) < 1e-6);
  CHECK(of_text[24] > 0.5);
}

}  // namespace euler_error_test
