// Table 3 through the command: tiny trainings on made-up text, their tables, and going on.
#include <doctest/doctest.h>

#include <algorithm>

#include "../support/expmap_files.hpp"
#include "command.hpp"

namespace evaluate_completion_test {

namespace {

const std::string tiny_models =
    " --hidden 8 --batch 2 --dvgan-hidden 8 --dvgan-batch 2 --dvgan-frames 8 --critic-steps 1 --samples 3 "
    "--log-every 1";

std::string checkpoint(const std::string& folder) { return bytes_of(folder + "/checkpoint.safetensors"); }

void refused(const std::string& arguments, const std::string& why) {
  const Said said = call("evaluate completion " + arguments);
  CHECK(said.status == 1);
  CHECK_MESSAGE(said.has(why), said.text);
}

}  // namespace

TEST_CASE("all models are trained and measured, the published rows beside; a second call trains nothing") {
  const TestFolder folder;
  motiongan::testing::write_small_h36m("h36m");
  const std::string whole = "evaluate completion h36m --save out --iterations 2 --dvgan-iterations 2";
  const Said dry = call(whole + tiny_models + " --dry-run");
  CHECK_MESSAGE(dry.status == 0, dry.text);
  for (const char* name :
       {"lstm\n", "seq2seq\n", "erd\n", "lstm-3lr\n", "dvgan\n", "  critic ", " for 2 iterations"})
    CHECK_MESSAGE(dry.has(name), std::string(name), dry.text);
  CHECK_FALSE(fs::exists("out"));
  CHECK(call(whole + " --batch 100000000").has("this training does not fit"));
  fs::remove_all("out");
  const Said said = call(whole + tiny_models);
  REQUIRE_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("h36m: 15 columns, 14 of which vary"));
  CHECK(said.has("lstm-3lr: finished after 2 iterations"));
  CHECK(said.has("dvgan: finished after 2 iterations"));
  CHECK(said.has("walking (3 training files)"));
  CHECK(said.has("Training iterations: lstm 2, seq2seq 2, erd 2, lstm-3lr 2, dvgan 2."));
  CHECK(said.has("mean of 2 actions"));
  CHECK(said.has("SRNN (published)           0.81  0.94  1.16  1.30     -     -"));
  CHECK_FALSE(said.has("true ms"));
  const std::string csv = bytes_of("out/table.csv"), markdown = bytes_of("out/table.md"),
                    json = bytes_of("out/table.json");
  for (const char* model :
       {"zero velocity", "lstm", "seq2seq", "erd", "lstm-3lr", "dvgan; mean of 3", "dvgan; best of 3"})
    for (const char* action : {"walking", "eating", "mean"}) {
      const std::string line = "\n" + std::string(action) + "," + model + ",measured,";
      CHECK_MESSAGE(csv.find(line) != std::string::npos, line);
    }
  CHECK(csv.find("\nwalking,lstm,measured,2,80,80.0,") != std::string::npos);
  CHECK(csv.find("\neating,DVGAN,published,,400,400.0,1.200000\n") != std::string::npos);
  CHECK(markdown.find("| seq2seq (published) |") != std::string::npos);
  CHECK(json.find("\"layout\": \"h36m\"") != std::string::npos);

  const std::string before = checkpoint("out/lstm"), dvgan = checkpoint("out/dvgan");
  SUBCASE("the same again, without a word of the models' options: those of their runs count") {
    const Said again = call(whole + " --samples 3");
    CHECK_MESSAGE(again.status == 0, again.text);
    CHECK(again.has("lstm: already trained"));
    CHECK(again.has("dvgan: already trained"));
    CHECK_FALSE(again.has("training for"));
    CHECK(checkpoint("out/lstm") == before);
    CHECK(bytes_of("out/table.csv") == csv);
    CHECK(bytes_of("out/table.md") == markdown);
  }
  SUBCASE("more iterations go on; fewer actions need no other training") {
    const Said more =
        call("evaluate completion h36m --save out --iterations 3 --models lstm --actions eating");
    CHECK_MESSAGE(more.status == 0, more.text);
    CHECK(more.has("lstm: training for 3 iterations; 2 iterations ("));
    CHECK(more.has("lstm: finished after 3 iterations"));
    CHECK_FALSE(more.has("walking ("));
    REQUIRE(call("evaluate completion h36m --save new --iterations 3 --models lstm" + tiny_models).status ==
            0);
    CHECK(bytes_of("out/lstm/generator.safetensors") == bytes_of("new/lstm/generator.safetensors"));
    CHECK(checkpoint("out/dvgan") == dvgan);
  }
  SUBCASE("other options and other files are not taken for these") {
    refused("h36m --save out --models lstm --hidden 9", "was trained with --hidden 8, now it is 9");
    refused("h36m --save out --models dvgan --completion-share 0", "was trained with --completion-share 0.5");
    refused("h36m --save out --models lstm --train-actions walking", "was trained on other files");
    refused("h36m --save out --models dvgan --train-actions walking --evaluate-only",
            "was trained on other files");
    CHECK(bytes_of("out/table.csv") == csv);
  }
}

TEST_CASE("CMU's names and times, an action that nothing was trained on, and models that are not there") {
  const TestFolder folder;
  motiongan::testing::write_small_cmu("cmu");
  const Said said =
      call("evaluate completion cmu --save out --models zero,seq2seq --iterations 1" + tiny_models);
  REQUIRE_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("washwindow (0 training files)"));
  CHECK(said.has("Not trained on, because there are no training files: washwindow."));
  CHECK(
      said.has("  ms               80   160   320   400   560  1000\n"
               "  true ms          33    67   133   167   233   417\n"));
  CHECK_FALSE(said.has("(published)"));
  const Said less = call("evaluate completion cmu --save out --evaluate-only --models seq2seq,erd");
  CHECK_MESSAGE(less.status == 0, less.text);
  CHECK(less.has("erd: there is no trained model in out/erd; its row is left out"));
  refused("cmu --save out --evaluate-only --models erd", "there is nothing to measure");

  const Said still = call("evaluate completion cmu --models zero --actions walking");
  CHECK(still.status == 0);
  CHECK(still.has("walking (2 training files)"));
  CHECK_FALSE(still.has("mean of"));
  CHECK_FALSE(fs::exists("table.csv"));
}

TEST_CASE("what cannot be evaluated is refused before anything is trained") {
  const TestFolder folder;
  motiongan::testing::write_small_h36m("h36m");
  refused("absent --models zero", "absent is not a folder");
  refused(". --models zero", "has neither the folder S5");
  refused("h36m --models zero --layout cmu", "has no folder test, which the layout cmu requires");
  refused("h36m --models zero,gru",
          "--models gru: expected some of zero, lstm, seq2seq, erd, lstm-3lr, dvgan");
  refused("h36m --models zero,zero", "--models names zero twice");
  refused("h36m --models lstm", "--save DIR is needed for lstm");
  refused("h36m --models zero --actions posing", "actions that have one: eating, walking");
  refused("h36m --models zero,dvgan --save out --dvgan-frames 64 --dvgan-iterations 1",
          "no training file holds 64 frames with a stride of 2; the longest allows 50");
  refused("h36m --models dvgan --save out --dvgan-frames 12 --dvgan-iterations 1", "power of two");
  write_file("h36m/S1/walking_1.txt", "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15\n1,2,x\n");
  refused("h36m --models zero", "h36m/S1/walking_1.txt:2: found 'x', expected a finite number");
  CHECK(call("evaluate completion --models zero").status > 1);  // usage: no folder
  CHECK_FALSE(fs::exists("out/dvgan/checkpoint.safetensors"));
}

}  // namespace evaluate_completion_test
