// The completion protocol: computed by hand on synthetic files, and published values on the CMU text.
#include <doctest/doctest.h>

#include <cstdlib>
#include <map>
#include <motiongan/experiments/completion_protocol.hpp>

#include "../support/expmap_files.hpp"
#include "../support/messages.hpp"

namespace completion_protocol_test {

using namespace motiongan;
using testing::ExpmapFolder;
using testing::message_of;
using testing::says;
using testing::swing;

namespace {

constexpr double near_float = 2e-6;  // files have seven digits

CompletionData small_h36m() {
  const ExpmapFolder folder;
  testing::write_small_h36m(folder.path());
  return CompletionData(motion::read_expmap_collection(folder.path(), {.actions = {"walking", "eating"}}));
}

}  // namespace

TEST_CASE("training clips are every second row, normalised by all rows; constant columns are dropped") {
  const CompletionData data = small_h36m();
  CHECK(data.actions() == std::vector<std::string>{"walking", "eating"});
  CHECK(data.columns() == 15);
  CHECK(data.dof() == 14);
  CHECK(data.rate() == 25);
  CHECK(data.train_count(0) == 3);
  CHECK(data.train_count(1) == 2);
  // The files have phases 0.3, 0.6, ... in the order of write_small_h36m().
  double mean = 0, square = 0;
  for (const double phase : {0.3, 0.6, 1.5, 0.9, 1.2})
    for (std::size_t f = 0; f < 200; ++f) mean += swing(f, 7, phase) / 1000;
  for (const double phase : {0.3, 0.6, 1.5, 0.9, 1.2})
    for (std::size_t f = 0; f < 200; ++f) square += std::pow(swing(f, 7, phase) - mean, 2) / 1000;
  CHECK(data.normalizer().mean()[7] == doctest::Approx(mean).epsilon(near_float));
  CHECK(data.normalizer().std()[7] == doctest::Approx(std::sqrt(square)).epsilon(near_float));
  const CompletionClip& clip = data.train()[3];
  CHECK(clip.label == 1);
  CHECK(clip.id == "S1/walking_2");
  CHECK(clip.frames == 100);
  CHECK(clip.poses[3 * 14 + 7] ==
        doctest::Approx((swing(6, 7, 0.6) - mean) / std::sqrt(square)).epsilon(1e-4));
  // Column 8 is dropped, so channel 8 of a pose is column 9.
  CHECK(data.normalizer().kept()[8] == 9);
}

TEST_CASE("tests alternate between the two files and start at NumPy's draws") {
  const CompletionData data = small_h36m();
  REQUIRE(data.tests().size() == 16);
  NumpyRandom random(1234567890);
  for (std::size_t i = 0; i < 8; ++i) {
    const CompletionTest& test = data.tests()[i];
    CHECK(test.action == 0);
    CHECK(test.label == 1);
    CHECK(test.file == (i % 2 == 0 ? "S5/walking_1" : "S5/walking_2"));
    const auto start = static_cast<std::size_t>(random.randint(16, 175 - 150));
    CHECK(test.start == start);
    CHECK(data.tests()[8 + i].start == start);  // every action restarts the generator
    const double phase = i % 2 == 0 ? 1.8 : 2.1;
    CHECK(test.prefix.size() == 50 * 14);
    CHECK(test.truth.size() == 75 * 15);
    CHECK(test.truth[60 * 15 + 10] == doctest::Approx(swing(2 * (start + 60), 10, phase)).epsilon(1e-4));
    CHECK(test.truth[60 * 15 + 8] == doctest::Approx(0.25));
    const auto seen = data.normalizer().denormalize(std::span<const float>(test.prefix));
    CHECK(seen[49 * 15 + 10] == doctest::Approx(swing(2 * (start + 49), 10, phase)).epsilon(1e-4));
  }
}

TEST_CASE("errors are of Euler angles of the columns from 6 on, at frames 1, 3, 7, 9, 13 and 24") {
  const CompletionData data = small_h36m();
  const CompletionTest& test = data.tests()[3];
  // Ground truth except for column 12, the first of the last joint, which is off by 0.1 from frame 7 on. The
  // root's columns are far off and must be ignored.
  std::vector<double> made(test.truth.begin() + 50 * 15, test.truth.end());
  for (std::size_t f = 0; f < 25; ++f) made[f * 15] += 5, made[f * 15 + 4] -= 3;
  for (std::size_t f = 7; f < 25; ++f) made[f * 15 + 12] += 0.1;
  const CompletionErrors errors =
      data.errors(test, data.normalizer().normalize<float>(std::span<const double>(made)));
  CHECK(errors[0] < 1e-5);
  CHECK(errors[1] < 1e-5);
  for (const std::size_t m : {2u, 3u, 4u, 5u}) {
    const std::size_t f = CompletionProtocol::measured[m];
    const double* const t = test.truth.data() + (50 + f) * 15 + 12;
    const auto a = prediction_euler(motion::Vec3{t[0], t[1], t[2]});
    const auto b = prediction_euler(motion::Vec3{t[0] + 0.1, t[1], t[2]});
    double squares = 0;
    for (std::size_t i = 0; i < 3; ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    CHECK(errors[m] == doctest::Approx(std::sqrt(squares)).epsilon(1e-4));
  }
}

TEST_CASE("zero velocity holds the last frame of the prefix; errors are means over eight tests") {
  const CompletionData data = small_h36m();
  const auto rows = zero_velocity_errors(data);
  REQUIRE(rows.size() == 2);
  double sum = 0;
  for (std::size_t t = 8; t < 16; ++t) {
    const CompletionTest& test = data.tests()[t];
    double squares = 0;
    for (const std::size_t joint : {2u, 3u, 4u}) {
      const double* const last = test.truth.data() + 49 * 15 + 3 * joint;
      const double* const then = test.truth.data() + (50 + 13) * 15 + 3 * joint;
      const auto a = prediction_euler(motion::Vec3{last[0], last[1], last[2]});
      const auto b = prediction_euler(motion::Vec3{then[0], then[1], then[2]});
      for (std::size_t i = 0; i < 3; ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    }
    sum += std::sqrt(squares) / 8;
  }
  CHECK(rows[1][4] == doctest::Approx(sum).epsilon(1e-4));
}

TEST_CASE("files that the protocol cannot use are refused") {
  const ExpmapFolder folder;
  testing::write_small_cmu(folder.path());
  const auto refusal = [&] {
    return message_of([&] { CompletionData data(motion::read_expmap_collection(folder.path())); });
  };
  CHECK(refusal() == "no error");
  folder.write("test/walking/walking_1.txt", testing::swings(150, 1));  // 75 frames of every second row
  CHECK(says(refusal(), "walking_1.txt has 150 frames, expected at least 151"));
  for (const char* file : {"train/walking/walking_1.txt", "train/walking/walking_2.txt"})
    folder.write(file, "0,0,0,0,0,0,1,1,1,0,0,0,0,0,0\n");
  CHECK(says(refusal(), "nothing moves"));
}

TEST_CASE("zero velocity on the CMU text, to three decimals") {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const auto shared =
      (set ? std::filesystem::path(set) : std::filesystem::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared") /
      "data" / "cmu-expmap";
  if (!std::filesystem::is_directory(shared)) {
    MESSAGE("skipped: no folder " << shared.string());
    return;
  }
  const std::map<std::string, std::vector<double>> expected{
      {"walking", {.407, .602, .832, .951, 1.085, 1.338}},
      {"running", {.563, .995, 1.381, 1.459, 1.573, 1.543}},
      {"soccer", {.274, .477, .922, 1.096, 1.362, 1.839}},
      {"basketball", {.488, .821, 1.404, 1.640, 2.048, 2.831}},
      {"washwindow", {.340, .567, .896, 1.093, 1.301, 1.468}},
      {"jumping", {.363, .616, 1.484, 1.683, 1.988, 2.027}}};
  const CompletionData data(motion::read_expmap_collection(shared));
  const auto rows = zero_velocity_errors(data);
  REQUIRE(data.actions().size() == expected.size());
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t m = 0; m < 6; ++m)
      CHECK_MESSAGE(std::abs(rows[a][m] - expected.at(data.actions()[a])[m]) < 0.0005 + 1e-9,
                    data.actions()[a], " ", m, ": ", rows[a][m]);
  CHECK(std::lround(data.true_milliseconds(0)) == 33);
  CHECK(std::lround(data.true_milliseconds(5)) == 417);
}

}  // namespace completion_protocol_test
