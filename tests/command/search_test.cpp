// Searching a collection through the command.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

namespace search_test {

using namespace motiongan::motion;

TEST_CASE("search, with a model of two iterations") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 6").status == 0);
  // Steps and turns into the first frame of a hypothesis are lost in a BVH file; headings are not.
  REQUIRE(call("train dvgan clips --save run --iterations 2 --root-rotation heading" + tiny).status == 0);
  const std::string search = "search --model run --text walk --collection clips ";

  SUBCASE("a table, JSON, a page and the hypotheses; the second time nothing is read") {
    const Said said = call(search + "--json r.json --html p.html --out made --top 4");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("6 files read, 0 kept, 0 removed"));
    CHECK(said.has("\"walk\": 16 hypotheses of run (seed 1) against 12 windows of 6 clips"));
    CHECK(said.has("second, distance, shift"));
    CHECK(said.has("wrote p.html: 12 motions side by side"));
    const auto json = nlohmann::json::parse(bytes_of("r.json"));
    CHECK(json.at("windows") == 12);
    REQUIRE(json.at("results").size() == 4);
    const auto& first = json.at("results")[0];
    CHECK(said.has("\n1  " + first.at("clip").get<std::string>()));
    CHECK(first.at("distance") == first.at("nearest")[0].at("distance"));
    CHECK(first.at("nearest")[0].at("distance") <= first.at("nearest")[1].at("distance"));
    CHECK(first.at("distance") <= json.at("results")[1].at("distance"));
    CHECK(first.at("end_seconds").get<double>() - first.at("begin_seconds").get<double>() ==
          doctest::Approx(4));
    CHECK(first.at("captions").size() > 0);  // captions.tsv lies in the folder
    CHECK(bytes_of("p.html").find("1. hypothesis #") != std::string::npos);
    CHECK(fs::exists("made/walk_015.bvh"));

    const Said again = call(search + "--json - --top 4");
    CHECK_FALSE(again.has("files read"));
    CHECK(nlohmann::json::parse(again.text.substr(again.text.find("{\n"))) == json);
  }
  SUBCASE("a clip that is a hypothesis is found; windows are listed one by one") {
    REQUIRE(call("generate run --text walk --seed 9 --count 2 --out clips/made").status == 0);
    const Said said = call(search + "--seed 9 --hypotheses 2 --top 1");
    CHECK_MESSAGE(said.has("against 14 windows of 8 clips"), said.text);
    CHECK_MESSAGE((said.has("\n1  made/walk_000") || said.has("\n1  made/walk_001")), said.text);
    CHECK(said.has("0.000"));
    const Said windows = call(search + "--windows --hop 2 --top 1000 --json -");
    const auto json = nlohmann::json::parse(windows.text.substr(windows.text.find("{\n")));
    CHECK(json.at("hop") == 2);
    CHECK(json.at("ranked") == "windows");
    CHECK(json.at("results").size() == json.at("windows"));
  }
  SUBCASE("--index keeps it elsewhere; a damaged one is made anew") {
    CHECK(call(search + "--index there/my.index").has("there/my.index: 6 files read"));
    CHECK_FALSE(fs::exists("clips/.motiongan-search"));
    const std::string whole = bytes_of("there/my.index");
    write_file("there/my.index", whole.substr(0, whole.size() - 100));
    const Said said = call(search + "--index there/my.index");
    CHECK(said.status == 0);
    CHECK(said.has("the index cannot be used"));
    CHECK(bytes_of("there/my.index") == whole);
    const Said refused = call(search + "--index run/log.csv");
    CHECK(refused.status == 1);
    CHECK(refused.has("is not a search index and will not be replaced"));
  }
  SUBCASE("what cannot be searched is refused") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said said = call("search " + arguments);
      CHECK(said.status == 1);
      CHECK_MESSAGE(said.has(why), said.text);
    };
    refused("--model run --text walk --collection clips --skeleton unreal.bvh", "give --out DIR");
    refused("--model run --text walk --collection clips --out clips", "clips/walk_000.bvh is an input");
    fs::create_directories("none");
    refused("--model run --text walk --collection none", "have no .bvh, .amc");
    refused("--model run --text walk --collection absent", "absent does not exist");
    refused("--model run --text '...' --collection clips", "has no words");
    Clip other = read_bvh("clips/walk_000.bvh");
    other.skeleton.joints[3].name = "Trunk";
    write_bvh("none/other.bvh", other);
    refused("--model run --text walk --collection none", "is called 'Trunk'");
    CHECK(call("search --model run --text walk").status > 1);  // usage: no collection
    CHECK(call(search + "--hypotheses 0").has("above 0, not 0"));
    CHECK(call(search + "--hop 0").has("above 0, not 0"));
    const Said unknown = call("search --model run --text 'swim walk' --collection clips --top 1");
    CHECK(unknown.has("the model never saw \"swim\""));
  }
}

}  // namespace search_test
