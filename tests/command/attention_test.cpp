// Models of classes through the command: training, generating, augmenting, and what is refused.
#include <doctest/doctest.h>

#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/train/csv_log.hpp"

namespace attention_test {

using motiongan::motion::read_bvh;

namespace {

const std::string small =
    " --frames 8 --rate 10 --hidden 8 --batch 4 --critic-steps 1 --classes walk,run,jump --split-seed 3 ";

std::string checkpoint(const std::string& folder) { return bytes_of(folder + "/checkpoint.safetensors"); }

void refused(const std::string& arguments, const std::string& why) {
  const Said said = call(arguments);
  CHECK(said.status == 1);
  CHECK_MESSAGE(said.has(why), said.text);
  CHECK(said.has("motiongan: "));
}

std::size_t lines_of(const fs::path& file) {
  const std::string text = bytes_of(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("training on classes: every loss is told, and a resumed run ends bit-equal") {
  const TestFolder folder;
  const Said whole = call("train attention --procedural 51 --save whole --iterations 4" + small);
  CHECK_MESSAGE(whole.status == 0, whole.text);
  CHECK(whole.has("computing 51 clips of built-in motion"));
  CHECK(whole.has("jump 2+1, run 2+1, walk 2+1"));
  CHECK(whole.has("left out, of other classes"));
  CHECK(whole.has("finished after 4 of 4 iterations; saved in whole"));
  for (const char* part :
       {"  W ", "  gp ", "  adv ", "  skel ", "  blend ", "  class ", "  clf ", "  acc ", "  gamma "})
    CHECK_MESSAGE(whole.has(part), part);
  for (const char* file : {"generator", "critic", "classifier", "checkpoint"})
    CHECK(fs::exists(fs::path("whole") / (std::string(file) + ".safetensors")));
  REQUIRE(call("train attention --procedural 51 --save parts --iterations 2" + small).status == 0);
  CHECK(checkpoint("parts") != checkpoint("whole"));
  const Said rest = call("train attention --resume --save parts --iterations 4");
  CHECK_MESSAGE(rest.status == 0, rest.text);
  CHECK(rest.has("resuming after iteration 2"));
  CHECK(checkpoint("parts") == checkpoint("whole"));
  CHECK(motiongan::read_csv_log("parts/log.csv").column("gamma").size() == 4);
  CHECK(call("train attention --resume --save parts").has("has all its 4 iterations already"));
  refused("train attention --resume --save parts --iterations 5 --rollouts 3",
          "started with rollouts = 2, now it is 3");
  refused("train attention --procedural 51 --save parts" + small, "already holds a run");
  refused("train attention --procedural 51 --save lstm --model lstm --rollouts 3 --classes walk",
          "--rollouts does not apply to");
  refused("train attention --procedural 51 --folders", "--procedural has labels of its own");
  refused("train attention --save none", "there is nothing to train on");
  refused("train attention --procedural 17 --classes wlak --save no", "no clip has the class 'wlak'");

  SUBCASE("info tells what model and run hold") {
    const Said model = call("info whole/generator.safetensors");
    CHECK_MESSAGE(model.status == 0, model.text);
    CHECK(model.has("attention_generator"));
    CHECK(model.has("8 frames from the 8 before them, at 10 per second (0.8 s)"));
    CHECK(model.has("jump, run, walk"));
    const Said run = call("info whole");
    CHECK_MESSAGE(run.status == 0, run.text);
    CHECK(run.has("classifier "));
    CHECK(run.has("batch 4"));
    CHECK(run.has("blend "));
  }
  SUBCASE("priors are drawn from the held-out clips; the same sample is the same file") {
    const Said said = call(
        "generate whole --class walk:1s,run:7 --count 3 --out a --html a.html --png a.png "
        "--attention-map maps/m.png");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("wrote 3 files: 8 given frames, then 17 generated frames (1.7 s)"));
    CHECK(said.has("which frames of the first second attend to which"));
    CHECK(read_bvh("a/walk-run_002.bvh").frames == 25);
    CHECK(bytes_of("a.png").substr(1, 3) == "PNG");
    CHECK(bytes_of("maps/m.png").substr(1, 3) == "PNG");
    CHECK(bytes_of("a.html").find("walk:1s,run:7") != std::string::npos);
    const std::string test_id = [] {
      const std::string split = bytes_of("whole/split.tsv");
      const std::size_t at = split.find("test\twalk");
      return split.substr(at + 5, split.find('\t', at + 5) - at - 5);
    }();
    CHECK_MESSAGE(said.has(test_id + " from "), said.text);
    REQUIRE(call("generate whole --class walk:1s,run:7 --first-sample 2 --out b").status == 0);
    CHECK(bytes_of("b/walk-run_002.bvh") == bytes_of("a/walk-run_002.bvh"));
    REQUIRE(call("generate whole --class walk:1s,run:7 --first-sample 2 --weights bf16 --out r").status == 0);
    CHECK(bytes_of("r/walk-run_002.bvh") != bytes_of("a/walk-run_002.bvh"));
    REQUIRE(call("generate whole --class walk:1s,run:7 --first-sample 2 --clean feet --out k").status == 0);
    CHECK(bytes_of("k/walk-run_002.bvh") != bytes_of("a/walk-run_002.bvh"));
    CHECK(call("generate whole --class walk --format csv --clean feet").has("use --format bvh"));
    REQUIRE(call("generate whole --class walk --seconds 2 --no-prior --format csv --out c").status == 0);
    CHECK(motiongan::motion::read_position_file("c/walk_000.csv", {}, 10).frames == 20);
    CHECK(call("generate whole --class walk --count 70 --seconds 1 --format npy --out d").has("and 50 more"));
    CHECK(fs::exists("d/walk_069.npy"));
  }
  SUBCASE("from clips of one's own, in any of the formats") {
    REQUIRE(call("synth clips --clips 3 --seconds 4").status == 0);
    const Said said = call(
        "generate whole --class jump --frames 16 --from clips/walk_000.bvh --from clips/run_001.bvh "
        "--at 0.5 --at 2 --out e --rate 20");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("run_001 from 2 s on"));
    CHECK(read_bvh("e/jump_003.bvh").frames == 47);
    REQUIRE(call("generate whole --class jump --seconds 1 --from clips/walk_000.bvh --format csv --out f")
                .status == 0);
    CHECK(call("generate whole --class run --seconds 1 --from f/jump_000.csv --out g")
              .has("jump_000 from 0 s on"));
    refused("generate whole --class walk --from clips/walk_000.bvh --at 3.9", "8 frames (0.80 s) are needed");
    refused("generate whole --class walk --from clips/walk_000.bvh --count 2", "this model has no noise");
    const std::string own = bytes_of("clips/walk_000.bvh");
    refused("generate whole --class walk --from clips/walk_000.bvh --out clips",
            "clips/walk_000.bvh is an input and would be replaced");
    CHECK(bytes_of("clips/walk_000.bvh") == own);
    refused("generate whole --class walk --from clips/captions.tsv", "is this a BVH file?");
    write_file("other.bvh",
               "HIERARCHY\nROOT Pelvis\n{\n OFFSET 0 0 0\n CHANNELS 3 Zrotation Xrotation Yrotation\n End "
               "Site\n {\n  "
               "OFFSET 0 1 0\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0\n0 0 0\n");
    refused("generate whole --class walk --from other.bvh", "other");
  }
  SUBCASE("what generate refuses") {
    refused("generate whole", "no class is given");
    refused("generate whole --class wlak", "did you mean 'walk'?");
    refused("generate whole --class walk:3s,run:x", "found the length 'x'");
    refused("generate whole --text walk", "it takes no --text; use --class");
    refused("generate whole --class walk --at 1", "--at needs --from");
    fs::create_directory("bare");
    fs::copy_file("whole/generator.safetensors", "bare/generator.safetensors");
    refused("generate bare --class walk", "give the second to continue with --from");
    fs::copy_file("whole/split.tsv", "bare/split.tsv");
    refused("generate bare --class walk", "or the clips to draw one from with --data");
  }
  SUBCASE("a synthetic clip for each training clip; the study compares") {
    const Said said =
        call("augment whole --out twice --study --seeds 2 --iterations 3 --batch 4 --hidden 8 --csv s.csv");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("wrote twice: 6 clips and labels.tsv"));
    CHECK(said.has("real + synthetic"));
    CHECK(said.has("mean +- spread"));
    CHECK(lines_of("s.csv") == 3);
    CHECK(lines_of("twice/labels.tsv") == 7);
    CHECK(fs::exists("twice/walk_000_synthetic.bvh"));
    // What it wrote is a data set by itself.
    const Said again = call("train attention twice --save again --iterations 1" + small);
    CHECK_MESSAGE(again.status == 0, again.text);
    CHECK(again.has("from twice/labels.tsv"));
    refused("augment again --out twice", "--out twice is an input; choose another folder");
    CHECK(lines_of("twice/labels.tsv") == 7);
    fs::create_directory("mine");
    write_file("mine/labels.tsv", "walk_000\twalk\n");
    refused("augment whole --out mine", "mine/labels.tsv exists, was not written by this command");
    refused("augment whole", "give --out DIR");
    refused("augment nowhere --out x", "nowhere");
  }
}

TEST_CASE("the LSTM baseline, labels from a file, and noise") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  std::string labels;
  for (const auto& entry : fs::directory_iterator("clips"))
    if (entry.path().extension() == ".bvh")
      labels += entry.path().stem().string() +
                ((entry.path().stem().string().back() - '0') % 2 == 0 ? "\tone\n" : "\ttwo\n");
  write_file("labels.tsv", labels);
  const std::string train =
      "train attention clips --labels labels.tsv --frames 8 --rate 10 --hidden 8 --batch 4 ";
  const Said lstm = call(train + "--model lstm --save lstm --iterations 3");
  CHECK_MESSAGE(lstm.status == 0, lstm.text);
  CHECK(lstm.has("  error "));
  CHECK(call("generate lstm --class one --seconds 2 --out a").has("wrote 1 file"));
  CHECK(call("info lstm/generator.safetensors").has("lstm_baseline"));
  refused("generate lstm --class one --attention-map m.png", "this model has no attention");
  REQUIRE(call("train attention --resume --save lstm --iterations 4").status == 0);

  const Said noise =
      call(train +
           "--noise 3 --no-root --no-attention --weight-clip 0.01 --critic-classes --critic-steps 1 "
           "--skeleton-weight 0 --blend-weight 0 --class-weight 0 --save noise --iterations 2");
  CHECK_MESSAGE(noise.status == 0, noise.text);
  REQUIRE(call("generate noise --class two --from clips/walk_000.bvh --count 2 --seconds 1 --out n").status ==
          0);
  CHECK(bytes_of("n/two_000.bvh") != bytes_of("n/two_001.bvh"));

  REQUIRE(call("train dvgan clips --save texts --iterations 1" + tiny).status == 0);
  refused("generate texts --class walk", "it has no classes, and takes no --class");
  refused("augment texts --out x", "holds a model called");
  refused("train attention clips", "there are no labels");
  refused("train attention clips --labels absent.tsv", "absent.tsv");
}

}  // namespace attention_test
