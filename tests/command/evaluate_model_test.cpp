// Measuring generated motion through the command: files beside files, and a model beside its test clips.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "command.hpp"

namespace evaluate_model_test {

namespace {

nlohmann::json json_of(const fs::path& file) { return nlohmann::json::parse(bytes_of(file)); }

const std::string tiny_ranker = " --frames 16 --hidden 16 --batch 8 --iterations 3 --split-seed 3 ";

}  // namespace

TEST_CASE("evaluate motion: files beside files") {
  const TestFolder folder;
  REQUIRE(call("synth real --clips 4 --seconds 4 --seed 1").status == 0);
  REQUIRE(call("synth made --clips 4 --seconds 3 --seed 2").status == 0);

  SUBCASE("files of equal names are pairs") {
    const Said said =
        call("evaluate motion --generated made --real real --unit-metres 0.01 --json out/m.json");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("foot skating, % of steps"));
    CHECK(said.has("jerk, m/s^3"));
    const auto m = json_of("out/m.json");
    CHECK(m.at("npss").at("pairs").get<int>() >= 1);
    CHECK(m.at("npss").at("value").get<double>() > 0);
    CHECK(m.at("generated").at("clips") == 4);
    CHECK(m.at("generated").at("bone_length_error_percent").get<double>() < 1e-3);
    CHECK(m.at("real").at("foot_skate_ratio").get<double>() < 0.5);
    CHECK(m.at("real").at("foot_contact_ratio").get<double>() > 0.5);
  }
  SUBCASE("a set beside itself: the same, and NPSS 0; without a unit a leg is a metre") {
    const Said said = call("evaluate motion --generated real --real real --rate 20 --json m.json");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("at 20 frames per second"));
    CHECK(said.has("jerk, legs/s^3"));
    const auto m = json_of("m.json");
    CHECK(m.at("npss").at("value") == 0);
    CHECK(m.at("npss").at("pairs") == 4);
    CHECK(m.at("generated") == m.at("real"));
  }
  SUBCASE("what cannot be measured is refused") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said said = call("evaluate motion " + arguments);
      CHECK(said.status != 0);
      CHECK_MESSAGE(said.has(why), said.text);
    };
    refused("--generated made --real real --feet Left,Right", "there is no joint 'Left' to use as a foot");
    refused("--generated made --real nowhere", "nowhere");
    refused("--generated made --real real --rate 0.2", "holds no clip of four frames at 0.2 per second");
    refused("--generated made --real real --unit-metres 0", "above 0, not 0");
    refused("--generated made", "--real is required");
  }
}

TEST_CASE("evaluate model: a generator compared with the clips that its run held out for testing") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 12 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 2" + tiny).status == 0);
  REQUIRE(call("train ranker clips --save ranker" + tiny_ranker).status == 0);

  SUBCASE("tables and file; the same seed gives the same figures") {
    const std::string line = "evaluate model run --ranker ranker --samples 3 --unit-metres 0.01 ";
    const Said said = call(line + "--json a.json");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("4 held out for testing"));  // the run's own split
    CHECK(said.has("3 generated and 3 real motions of each"));
    for (const char* row :
         {"random", "this model", "real motion", "paper, CMU: cnn, cnn critic dense + shift", "FID *",
          "diversity *", "multimodality *", "foot skating", "not comparable"})
      CHECK_MESSAGE(said.has(row), row);
    CHECK_FALSE(said.has("paper, CMU: rnn"));
    CHECK_FALSE(said.has("test clips:"));  // none of them was trained on
    const auto a = json_of("a.json");
    const int k = a.at("K");
    CHECK(k >= 1);
    CHECK(a.at("model").at("motions") == 3 * k);
    CHECK(a.at("model").at("recall").at("R@10") >= a.at("model").at("recall").at("R@1"));
    CHECK(a.at("random").at("R@1").get<double>() == doctest::Approx(100.0 / k));
    CHECK(a.at("model").at("distance_from_real").at("fid").get<double>() > 0);
    CHECK(a.at("model").at("distance_from_real").at("dimensions") == 16);
    CHECK_FALSE(a.at("model").contains("drift"));
    REQUIRE(call(line + "--json b.json").status == 0);
    CHECK(json_of("b.json") == a);
    REQUIRE(call(line + "--seed 5 --json c.json").status == 0);
    CHECK(json_of("c.json").at("model") != a.at("model"));
    CHECK(json_of("c.json").at("real").at("recall") == a.at("real").at("recall"));
  }
  SUBCASE("another split has clips that model and ranker know") {
    const Said said =
        call("evaluate model run/generator.safetensors --ranker ranker --samples 2 --split-seed 8");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("the model was trained on"));
    CHECK(said.has("the ranker was trained on"));
  }
  SUBCASE("what cannot be measured is refused") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said said = call("evaluate model " + arguments);
      CHECK(said.status != 0);
      CHECK_MESSAGE(said.has(why), said.text);
    };
    refused("run", "--ranker is required");
    refused("run --ranker run", "holds no ranker.safetensors");
    refused("ranker --ranker ranker", "holds no generator.safetensors");
    refused("run --ranker run/generator.safetensors",
            "expected one of cnn_ranker, rnn_ranker; motiongan train ranker makes one");
    refused("run --ranker ranker --samples 1", "--samples");
    fs::create_directory("bare");
    fs::copy_file("run/generator.safetensors", "bare/model.safetensors");
    refused("bare/model.safetensors --ranker ranker", "does not say what it was trained on");
    const Said said = call("evaluate model bare/model.safetensors clips --ranker ranker --samples 2");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("no split.tsv next to the model"));
  }
}

TEST_CASE("evaluate model: the drift of an RNN generator") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 12 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 1" + tiny_rnn).status == 0);
  REQUIRE(call("train ranker clips --save ranker --frames 8 --hidden 16 --batch 8 --iterations 2 "
               "--split-seed 3")
              .status == 0);
  const Said said = call("evaluate model run --ranker ranker --samples 2 --drift-seconds 5 --json a.json");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("drift over 5 s"));
  CHECK(said.has("paper, CMU: rnn, cnn critic dense"));
  CHECK(json_of("a.json").at("model").at("drift").at("seconds").get<double>() == doctest::Approx(5));
}

}  // namespace evaluate_model_test
