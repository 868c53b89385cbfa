// MotionFormat through JSON and back, and errors.
#include "motiongan/data/motion_format.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "../support/messages.hpp"
#include "motiongan/data/motion_format_json.hpp"

namespace motion_format_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

MotionFormat small_format() {
  Skeleton skeleton;
  skeleton.joints = {{"World", -1, {0, 0.1, 1.0 / 3}, {}, {}},
                     {"Hips",
                      0,
                      {0, 90, 0},
                      {Channel::x_position, Channel::y_position, Channel::z_position, Channel::z_rotation,
                       Channel::x_rotation, Channel::y_rotation},
                      {}},
                     {"left arm", 1, {1, 2, 3}, {Channel::z_rotation}, Vec3{0, 5, 0}}};
  MotionFormat format;
  format.layout = PoseLayout(skeleton, true, 1);
  std::vector<double> mean(12), std(12, 0.0);
  for (std::size_t d = 0; d < 12; ++d) {
    mean[d] = 1.0 / (3.0 + static_cast<double>(d));
    if (d % 2 == 1) std[d] = std::sqrt(static_cast<double>(d));
  }
  mean[9] = 0;
  format.normalizer = Normalizer(mean, std);
  format.vocabulary = Vocabulary({"<unk>", "jump", "walk"});
  format.rate = 12.5;
  format.frames = 64;
  format.relative_dims = {4};  // full dimension 9, the root's x
  return format;
}

}  // namespace

TEST_CASE("a format round-trips through JSON text") {
  const MotionFormat a = small_format();
  const MotionFormat b = io::motion_format_from_json(nlohmann::json::parse(io::to_json(a).dump()));
  CHECK(a.skeleton() == b.skeleton());
  CHECK(a.layout.root() == b.layout.root());
  CHECK(a.layout.root_position() == b.layout.root_position());
  CHECK(a.normalizer.mean() == b.normalizer.mean());
  CHECK(a.normalizer.std() == b.normalizer.std());
  CHECK(a.normalizer.kept() == b.normalizer.kept());
  CHECK(a.vocabulary.words() == b.vocabulary.words());
  CHECK(a.rate == b.rate);
  CHECK(a.frames == b.frames);
  CHECK(a.relative_dims == b.relative_dims);
  const std::vector<bool> mask = b.relative_mask();
  CHECK(mask == std::vector<bool>{false, false, false, false, true, false});
}

TEST_CASE("root representations and the training range survive JSON; older files have no range") {
  for (const RootRotation form :
       {RootRotation::expmap, RootRotation::heading, RootRotation::velocity, RootRotation::support}) {
    MotionFormat a = small_format();
    a.layout = PoseLayout(a.skeleton(), true, 1, form);
    nlohmann::json json = io::to_json(a);
    CHECK(!json.contains("low"));
    CHECK(io::motion_format_from_json(json).low.empty());
    a.low = {-1.0 / 3, -2, -3, -4, -5, -6};
    a.high = {1.0 / 7, 2, 3, 4, 5, 6};
    const MotionFormat b = io::motion_format_from_json(nlohmann::json::parse(io::to_json(a).dump()));
    CHECK(b.layout.root_rotation() == form);
    CHECK(b.low == a.low);
    CHECK(b.high == a.high);
  }
  MotionFormat ranged = small_format();
  ranged.low.assign(6, -1);
  ranged.high.assign(6, 1);
  const nlohmann::json good = io::to_json(ranged);
  const auto refused = [&](const char* key, const nlohmann::json& value) {
    nlohmann::json bad = good;
    if (value.is_null())
      bad.erase(key);
    else
      bad[key] = value;
    return testing::message_of([&] { io::motion_format_from_json(bad); });
  };
  CHECK(testing::says(refused("high", nullptr), "no 'high'"));
  CHECK(testing::says(refused("low", nullptr), "no 'low'"));
  CHECK(testing::says(refused("low", nlohmann::json::array()), "'low' is empty"));
  CHECK(testing::says(refused("high", {1, 2}), "has 6 and 2 values, expected 6 each"));
  CHECK(testing::says(refused("low", std::vector<double>(6, 1.5)), "dimension 0 is from 1.5 to 1"));
  CHECK(testing::says(refused("low", "x"), "'low' is string, expected numbers"));
}

TEST_CASE("normalised zeros are the mean pose, including dropped dimensions") {
  const MotionFormat format = small_format();
  const std::vector<float> zeros(2 * format.dof(), 0.0f);
  const Motion motion = format.to_motion(zeros);
  CHECK(motion.frames == 2);
  CHECK(motion.rate == 12.5);
  const Vec3 r = expmap_from_quat(motion.rotation(1, 2));
  for (std::size_t i = 0; i < 3; ++i) CHECK(std::abs(r[i] - format.normalizer.mean()[6 + i]) < 1e-12);
  CHECK(motion.position(1, 1)[0] == 0);
  CHECK(motion.position(1, 1)[1] == doctest::Approx(format.normalizer.mean()[10]));
  CHECK(motion.position(1, 2) == Vec3{1, 2, 3});
  CHECK_THROWS_WITH_AS(format.to_motion(std::vector<float>(7)), doctest::Contains("multiple of 6"), Error);
}

TEST_CASE("errors in the JSON name the member") {
  const nlohmann::json good = io::to_json(small_format());
  struct Case {
    const char* key;
    nlohmann::json value;
    const char* message;
  };
  const std::vector<Case> cases{
      {"skeleton", 3, "'skeleton' is number, expected HIERARCHY text"},
      {"skeleton", "HIERARCHY\nROOT a\n{\n  OFFSET 1 2\n}", "skeleton of the model:5:1"},
      {"root", "Nose", "root 'Nose' is not a joint"},
      {"root_rotation", "euler", "\"euler\", expected one of expmap, heading, velocity"},
      {"root_position", 1, "'root_position' is number, expected true or false"},
      {"root_position", false, "normalizer of 12 dimensions does not fit a pose of 9"},
      {"rate", 0, "rate of 0"},
      {"rate", "fast", "'rate' is string"},
      {"rate", nullptr, "'rate' is null"},
      {"frames", -4, "'frames' is number, expected a whole number"},
      {"frames", 0, "windows of 0 frames"},
      {"frames", std::uint64_t{1} << 40, "windows of 1099511627776 frames, expected 1 to 65536"},
      {"mean", nlohmann::json::array({1, 2}), "2 means and 12 standard deviations"},
      {"std", nlohmann::json::array({"a"}), "'std' is array, expected numbers"},
      {"std", std::vector<double>(12, 0.0), "nothing moves"},
      {"std", std::vector<double>(12, -1.0), "no negative deviation"},
      {"relative_dims", {99}, "relative dimension 99"},
      {"relative_dims", {4, 4}, "relative dimension 4 is out of order"},
      {"vocabulary", nlohmann::json::array(), "expected '<unk>'"},
      {"vocabulary", {"<unk>", "walk", "walk"}, "'walk', appears twice"},
      {"vocabulary", {"<unk>", "Two words"}, "expected lower-case letters and digits"}};
  for (const Case& c : cases) {
    nlohmann::json bad = good;
    bad[c.key] = c.value;
    CAPTURE(c.message);
    CHECK_THROWS_WITH_AS(io::motion_format_from_json(bad), doctest::Contains(c.message), Error);
  }
  for (const auto& item : good.items()) {
    nlohmann::json bad = good;
    bad.erase(item.key());
    CAPTURE(item.key());
    CHECK_THROWS_WITH_AS(io::motion_format_from_json(bad), doctest::Contains(item.key().c_str()), Error);
  }
  CHECK_THROWS_WITH_AS(io::motion_format_from_json(nlohmann::json::array()), doctest::Contains("JSON object"),
                       Error);
}

}  // namespace motion_format_test
