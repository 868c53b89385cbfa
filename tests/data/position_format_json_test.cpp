// A PositionFormat through JSON and back.
#include "motiongan/data/position_format_json.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "motiongan/procedural/procedural.hpp"

namespace position_format_json_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

PositionFormat some_format(bool track) {
  const Motion motion = procedural_motion(2).motion;
  PositionFormat format;
  format.layout = PositionLayout(motion.skeleton, track);
  format.normalizer = Normalizer::fit(format.layout.encode(joint_positions(motion)), format.layout.dof());
  format.rate = 29.97;
  format.frames = 17;
  format.classes = {"jump", "walk"};
  return format;
}

}  // namespace

TEST_CASE("a position format round-trips exactly") {
  for (const bool track : {true, false}) {
    const PositionFormat format = some_format(track);
    const std::string text = io::to_json(format).dump();
    const PositionFormat back = io::position_format_from_json(nlohmann::json::parse(text));
    CHECK(back.skeleton() == format.skeleton());
    CHECK(back.layout.root_track() == track);
    CHECK(back.normalizer.mean() == format.normalizer.mean());
    CHECK(back.normalizer.std() == format.normalizer.std());
    CHECK(back.rate == format.rate);
    CHECK(back.frames == format.frames);
    CHECK(back.classes == format.classes);
    CHECK(io::to_json(back).dump() == text);
  }
}

TEST_CASE("errors name the member") {
  const nlohmann::json good = io::to_json(some_format(true));
  for (const auto& [key, value] : good.items()) {
    nlohmann::json missing = good, wrong = good;
    missing.erase(key);
    wrong[key] = nlohmann::json::object();
    const std::string quoted = "'" + key + "'";
    CHECK_THROWS_WITH_AS((void)io::position_format_from_json(missing), doctest::Contains(quoted.c_str()),
                         Error);
    CHECK_THROWS_WITH_AS((void)io::position_format_from_json(wrong), doctest::Contains(quoted.c_str()),
                         Error);
  }
  nlohmann::json bad = good;
  bad["classes"] = {"walk", 3};
  CHECK_THROWS_WITH_AS((void)io::position_format_from_json(bad), doctest::Contains("'classes'"), Error);
  bad["classes"] = {"walk", "walk"};
  CHECK_THROWS_WITH_AS((void)io::position_format_from_json(bad), doctest::Contains("two classes"), Error);
  bad = good;
  bad["mean"].push_back(1.0);
  CHECK_THROWS_AS((void)io::position_format_from_json(bad), Error);
  bad = good;
  bad["root_track"] = false;  // the normalizer then has four dimensions too many
  CHECK_THROWS_WITH_AS((void)io::position_format_from_json(bad), doctest::Contains("normalizer"), Error);
  CHECK_THROWS_AS((void)io::position_format_from_json(nlohmann::json::array()), Error);
}

}  // namespace position_format_json_test
