// Rankers and the first paper's comparison through the command.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace ranker_test {

namespace {

const std::string data = " --procedural 34 --frames 8 --rate 4 --split-seed 3 ";

std::size_t lines_of(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("a ranker is trained, resumed and measured") {
  const TestFolder folder;
  const std::string small = "train ranker" + data + "--hidden 16 --batch 8 --learning-rate 0.003 ";
  const Said said = call(small + "--save r --iterations 60");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("distinct descriptions of the training clips"));
  CHECK(said.has("finished after 60 of 60 iterations"));
  for (const char* file : {"ranker.safetensors", "checkpoint.safetensors", "log.csv", "split.tsv"})
    CHECK(fs::exists(fs::path("r") / file));
  CHECK_FALSE(fs::exists("r/generator.safetensors"));

  const Said table = call("evaluate ranker r --json r.json --windows 3");
  CHECK_MESSAGE(table.status == 0, table.text);
  for (const char* part : {"random", "most common first", "this ranker", "paper, CMU: RNN ranker",
                           "not comparable", "mean rank", "3 windows of each"})
    CHECK_MESSAGE(table.has(part), part);
  const auto json = nlohmann::json::parse(bytes_of("r.json"));
  CHECK(json.at("K").get<int>() >= 2);
  CHECK(json.at("windows").get<int>() == 3 * json.at("clips").get<int>());
  CHECK(json.at("recall").at("R@1").get<double>() > json.at("random").at("R@1").get<double>());
  CHECK(json.at("descriptions").size() == json.at("K").get<std::size_t>());

  // Resumed: the same bits as at once, without a word of the data.
  REQUIRE(call(small + "--save p --iterations 20").status == 0);
  const Said rest = call("train ranker --resume --save p --iterations 60");
  CHECK_MESSAGE(rest.status == 0, rest.text);
  CHECK(bytes_of("p/ranker.safetensors") == bytes_of("r/ranker.safetensors"));

  SUBCASE("other files are refused by what they are") {
    CHECK(call("evaluate ranker nothing").status == 1);
    fs::create_directory("empty");
    const Said empty = call("evaluate ranker empty");
    CHECK(empty.status == 1);
    CHECK(empty.has("holds no ranker.safetensors"));
    fs::copy("r/ranker.safetensors", "lone.safetensors");
    const Said lone = call("evaluate ranker lone.safetensors");
    CHECK(lone.status == 1);
    CHECK(lone.has("does not say what it was trained on"));
    CHECK(call("evaluate ranker lone.safetensors --procedural 34").status == 0);
  }
}

TEST_CASE("the comparison trains, measures, goes on and trains nothing twice") {
  const TestFolder folder;
  const std::string small = "ablate dvgan" + data +
                            "--hidden 8 --batch 4 --critic-steps 1 --log-every 1 --samples 2 "
                            "--ranker-hidden 8 --ranker-iterations 5 ";
  const std::string two = small + "--variants cnn-cnn-final,rnn-rnn-shift --seeds 2 ";
  const Said said = call(two + "--save cmp --iterations 2");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("ranker: finished after 5 iterations"));
  CHECK(said.has("rnn-rnn-shift seed-2: finished after 2 iterations"));
  CHECK(said.has(" motions each; 2 iterations\n"));
  CHECK(said.has("not comparable"));
  const std::string runs = bytes_of("cmp/runs.csv"), table = bytes_of("cmp/table.csv"),
                    text = bytes_of("cmp/table.md");
  CHECK(lines_of(runs) == 5);
  CHECK(runs.find("\nrnn-rnn-shift,rnn,rnn,,1,0,2,2,") != std::string::npos);
  CHECK(lines_of(table) == 4);  // two variants and the real row
  CHECK(table.find(",3.62,40.6,50.4,53.1,56.5\n") != std::string::npos);
  CHECK(text.find("| cnn-cnn-final | 2 |") != std::string::npos);
  CHECK(text.find("| real |") != std::string::npos);
  CHECK(text.find("±") != std::string::npos);

  const std::string model = bytes_of("cmp/cnn-cnn-final/seed-1/checkpoint.safetensors");
  const Said again = call(
      "ablate dvgan --variants cnn-cnn-final,rnn-rnn-shift --seeds 2 --samples 2 --save cmp "
      "--iterations 2 --ranker-hidden 8 --ranker-iterations 5");
  CHECK_MESSAGE(again.status == 0, again.text);
  CHECK(again.has("cnn-cnn-final seed-1: already trained"));
  CHECK_FALSE(again.has("training for"));
  CHECK(bytes_of("cmp/cnn-cnn-final/seed-1/checkpoint.safetensors") == model);
  CHECK(bytes_of("cmp/runs.csv") == runs);

  // A training of it is a run as any other.
  CHECK(call("generate cmp/cnn-cnn-final/seed-1 --text walk --out new").status == 0);
  const Said more = call(two + "--save cmp --iterations 3");
  CHECK(more.has("cnn-cnn-final seed-1: training for 3 iterations; 2 iterations ("));
  CHECK(more.has(" motions each; 3 iterations\n"));

  SUBCASE("with a ranker of one's own, and only measuring") {
    const Said only = call(small +
                           "--variants cnn-cnn-final,cnn-rnn --seeds 1 --save cmp --evaluate-only "
                           "--ranker cmp/ranker --iterations 3");
    CHECK_MESSAGE(only.status == 0, only.text);
    CHECK_FALSE(only.has("training for"));
    CHECK(lines_of(bytes_of("cmp/table.csv")) == 3);  // cnn-rnn is not there
  }
}

TEST_CASE("comparisons that cannot be are refused before anything is trained") {
  const TestFolder folder;
  const Said name = call("ablate dvgan" + data + "--save c --variants dense");
  CHECK(name.status == 1);
  CHECK(name.has("no variant called \"dense\""));
  const Said frames = call("ablate dvgan --procedural 34 --frames 9 --rate 4 --save c");
  CHECK(frames.status == 1);
  CHECK(frames.has("power of two"));
  const Said nothing = call("ablate dvgan --save c");
  CHECK(nothing.status == 1);
  CHECK(nothing.has("there is nothing to compare on"));
  CHECK(call("ablate dvgan" + data + "--save c --iterations 0").has("give --minutes or --iterations"));
  CHECK_FALSE(fs::exists("c"));
}

}  // namespace ranker_test
