// New motion through the command, and looking at it.
#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>

#include "../support/other_bodies.hpp"
#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/metrics/jerk.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/clean_stream.hpp"
#include "motiongan/motion/motion.hpp"

namespace generate_test {

using namespace motiongan::motion;

namespace {

/// The most memory that a run of the command had at a time, in KiB.
long peak_memory(const std::string& arguments) {
  const std::string line = std::string("exec '") + MOTIONGAN_COMMAND + "' " + arguments + " >/dev/null 2>&1";
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  int status = -1;
  rusage used{};
  CHECK(wait4(child, &status, 0, &used) == child);
  CHECK(status == 0);
  return used.ru_maxrss;
}

}  // namespace

TEST_CASE("generate, view, info and compare, from a model of three iterations") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 3" + tiny).status == 0);

  SUBCASE("files are named by text and sample, read back, and depend on the seed alone") {
    const Said said = call("generate run --text 'Walk, slowly!' --text jump --count 2 --out a");
    CHECK(said.status == 0);
    CHECK(said.has("wrote 4 BVH files of 16 frames at 4 per second"));
    const Clip clip = read_bvh("a/walk-slowly_000.bvh");
    CHECK(clip.frames == 16);
    CHECK(clip.frame_time == doctest::Approx(0.25));
    CHECK(clip.skeleton == read_bvh("clips/walk_000.bvh").skeleton);
    REQUIRE(call("generate run --text 'Walk, slowly!' --first-sample 1 --out b").status == 0);
    CHECK(bytes_of("b/walk-slowly_001.bvh") == bytes_of("a/walk-slowly_001.bvh"));
    CHECK(bytes_of("a/walk-slowly_000.bvh") != bytes_of("a/walk-slowly_001.bvh"));
    REQUIRE(call("generate run/generator.safetensors --text jump --seed 2 --out b").status == 0);
    CHECK(bytes_of("b/jump_000.bvh") != bytes_of("a/jump_000.bvh"));
    CHECK(bytes_of("a/jump_000.bvh") != bytes_of("a/walk-slowly_000.bvh"));
  }
  SUBCASE("--rate, prompts, page and picture; unknown words are named") {
    write_file("prompts.txt", "walk\n\n  run \r\nwalk.\nfrobnicate wildly\n");
    const Said said =
        call("generate run --prompts prompts.txt --rate 60 --out c/d --html e/f.html --png f.png");
    CHECK(said.status == 0);
    CHECK_MESSAGE(said.has("\"frobnicate wildly\": the model never saw \"frobnicate\", \"wildly\""),
                  said.text);
    const Clip clip = read_bvh("c/d/walk_000.bvh");
    CHECK(clip.frame_time == doctest::Approx(1.0 / 60));
    CHECK(clip.frames == 15 * 15 + 1);
    CHECK(fs::exists("c/d/walk-2_000.bvh"));  // the second text of that name
    CHECK(fs::exists("c/d/run_000.bvh"));
    CHECK(bytes_of("e/f.html").find("frobnicate wildly") != std::string::npos);
    CHECK(bytes_of("f.png").substr(1, 3) == "PNG");
  }
  SUBCASE("what cannot be generated is refused") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said said = call("generate " + arguments);
      CHECK(said.status == 1);
      CHECK_MESSAGE(said.has(why), said.text);
    };
    refused("run", "no text is given");
    refused("run --text '?!'", "--text \"?!\" has no words");
    refused("clips --text walk", "clips holds no generator.safetensors");
    refused("missing.safetensors --text walk", "missing.safetensors: no such file");
    refused("run --text walk --out clips/walk_000.bvh/x", "cannot create the folder");
    refused("run/critic.safetensors --text walk", "not a motiongan model");
    write_file("mute.txt", "walk\n--\n");
    refused("run --prompts mute.txt", "mute.txt:2: \"--\" has no words");
    write_file("cut.safetensors", bytes_of("run/generator.safetensors").substr(0, 20000));
    refused("cut.safetensors --text walk", "cut.safetensors: ");
    fs::create_directory("dead.bvh");
    fs::create_directory("walk_000.bvh");
    refused("run --text walk", "walk_000.bvh");
    CHECK(call("generate").status > 1);  // usage
    CHECK(call("generate run --text walk --count 0").has("above 0, not 0"));
    CHECK(call("generate run --text walk --seed -1").has("at least 0, not -1"));
  }
  SUBCASE("info tells what everything is") {
    const Said model = call("info run/generator.safetensors");
    CHECK(model.status == 0);
    CHECK(model.has("16 frames at 4 per second (4 s)"));
    CHECK(model.has("hidden 16"));
    CHECK(model.has("and <unk> for all others"));
    const Said run = call("info run");
    CHECK(run.status == 0);
    CHECK(run.has("batch 4"));
    const Said clip = call("info clips/run_001.bvh");
    CHECK(clip.has("150 at 30 per second (5 s)"));
    CHECK(clip.has("no T-pose"));
    const Said clips = call("info clips");
    CHECK(clips.has("6 clips: 22 joints (69 channels)"));
    CHECK(clips.has("captions by number of frames"));
    CHECK(clips.has("--frames 32 --rate 8        4 s      6"));
    const Said log = call("info run/log.csv --png log.png");
    CHECK(log.has("a log of 3 rows"));
    CHECK(bytes_of("log.png").substr(1, 3) == "PNG");
    CHECK(call("info run/critic.safetensors").has("level_weight"));
    CHECK(call("info absent").status == 1);
  }
  SUBCASE("view and compare") {
    const Said said = call("view clips/walk_000.bvh clips/run_001.bvh --rate 15 --png v.png --html v.html");
    CHECK(said.status == 0);
    CHECK(said.has("75 frames at 15 per second"));
    CHECK(bytes_of("v.html").find("walk_000") != std::string::npos);
    CHECK(bytes_of("v.png").substr(1, 3) == "PNG");
    CHECK(call("view clips/walk_000.bvh").has("wrote view.html: 1 motion"));
    CHECK(call("view clips/captions.tsv").status == 1);
    REQUIRE(call("generate run --text walk --count 3 --out made").status == 0);
    const Said table = call("compare --generated made --real clips --csv table.csv");
    CHECK(table.status == 0);
    CHECK(table.has("at 4 frames per second"));
    CHECK(table.has("median spread ratio"));
    CHECK(bytes_of("table.csv").starts_with("joint,"));
    const Said same = call("compare --generated clips --real clips");
    CHECK(same.has("median spread ratio                   1.000"));
    CHECK(call("compare --generated made clips --real clips").has("choose one with --rate"));
  }
}

TEST_CASE("an RNN model makes any number of frames") {
  const TestFolder folder;
  // Without a leak, for the motion of an untrained model with one is too small to be cleaned up.
  REQUIRE(call("train dvgan --procedural 6 --save run --iterations 2 --leak 0" + tiny_rnn).status == 0);

  SUBCASE("the files are those of the library; a table tells of drift") {
    const Said said = call("generate run --text walk --count 2 --frames 3000 --out a --drift d/drift.csv");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("wrote 2 BVH files of 3000 frames at 4 per second (12 min 30 s each)"));
    CHECK(said.has("drift of 2 motions"));
    CHECK(said.has("675 to 749"));
    const std::string table = bytes_of("d/drift.csv");
    CHECK(std::count(table.begin(), table.end(), '\n') == 751);
    const motiongan::Context context;
    const auto model = motiongan::Dvgan::load(context, "run/generator.safetensors");
    const auto motions = model.generate("walk", {.count = 2, .frames = 3000});
    write_bvh("b.bvh", motions[1]);
    CHECK(bytes_of("a/walk_001.bvh") == bytes_of("b.bvh"));
    REQUIRE(call("generate run --text walk --frames 3000 --rate 10 --out c").status == 0);
    write_bvh("c.bvh", resample(motions[0], 10));
    CHECK(bytes_of("c/walk_000.bvh") == bytes_of("c.bvh"));
    CHECK_FALSE(call("generate run --text walk").has("drift"));  // a window of 8 frames
  }
  SUBCASE("16-bit weights give nearly the same motion, that of the library") {
    const Said said = call("generate run --text walk --frames 20 --weights bf16 --out a");
    CHECK_MESSAGE(said.status == 0, said.text);
    REQUIRE(call("generate run --text walk --frames 20 --weights f32 --out b").status == 0);
    const motiongan::Context context;
    auto model = motiongan::Dvgan::load(context, "run/generator.safetensors");
    model.bfloat16();
    write_bvh("c.bvh", model.generate("walk", {.frames = 20})[0]);
    CHECK(bytes_of("a/walk_000.bvh") == bytes_of("c.bvh"));
    const Motion rounded = to_motion(read_bvh("a/walk_000.bvh")),
                 exact = to_motion(read_bvh("b/walk_000.bvh"));
    double most = 0;
    for (std::size_t f = 0; f < 20; ++f)
      for (std::size_t j = 0; j < exact.skeleton.size(); ++j)
        most = std::max(
            most, length(expmap_from_quat(multiply(inverse(exact.rotation(f, j)), rounded.rotation(f, j)))));
    CHECK(most > 1e-6);
    CHECK(most < 0.1);
    REQUIRE(call("generate run --text walk --frames 20 --weights raw --out r").status == 0);
    const auto last =
        motiongan::Dvgan::load(context, "run/checkpoint.safetensors", motiongan::WeightSource::raw);
    write_bvh("r.bvh", last.generate("walk", {.frames = 20})[0]);
    CHECK(bytes_of("r/walk_000.bvh") == bytes_of("r.bvh"));
    CHECK(bytes_of("r/walk_000.bvh") != bytes_of("b/walk_000.bvh"));
    const Said no_raw = call("generate run/generator.safetensors --text walk --weights raw");
    CHECK_MESSAGE(no_raw.has("run/generator.safetensors is no checkpoint"), no_raw.text);
    CHECK(call("generate run --text walk --weights raw,mean").has("exclude each other"));
    const Said wrong = call("generate run --text walk --weights f16");
    CHECK(wrong.status != 0);
    CHECK_MESSAGE(wrong.has("--weights"), wrong.text);
    CHECK_MESSAGE(wrong.has("bf16"), wrong.text);
  }
  SUBCASE("--clean: feet stand, nothing trembles; clean does the same to files") {
    const Said said = call("generate run --text walk --frames 60 --clean feet,smooth --out a --html a.html");
    CHECK_MESSAGE(said.status == 0, said.text);
    REQUIRE(call("generate run --text walk --frames 60 --out b").status == 0);
    const Motion cleaned = to_motion(read_bvh("a/walk_000.bvh")),
                 made = to_motion(read_bvh("b/walk_000.bvh"));
    CHECK(cleaned.frames == made.frames);
    CHECK(bytes_of("a/walk_000.bvh") != bytes_of("b/walk_000.bvh"));
    REQUIRE(call("generate run --text walk --frames 60 --clean smooth --cutoff 0.5 --out s").status == 0);
    CHECK(motiongan::mean_jerk(to_motion(read_bvh("s/walk_000.bvh"))) < 0.9 * motiongan::mean_jerk(made));
    const Said by_itself = call("clean b --out c --html c.html");
    CHECK_MESSAGE(by_itself.status == 0, by_itself.text);
    CHECK(by_itself.has("wrote 1 clip to c"));
    CHECK(by_itself.has("foot skating"));
    CHECK(motiongan::mean_jerk(to_motion(read_bvh("c/walk_000.bvh"))) ==
          doctest::Approx(motiongan::mean_jerk(clean(made))).epsilon(1e-3));
    CleanStream stream;  // generate cleans up while it writes
    Motion streamed = stream.push(made);
    streamed = join(std::move(streamed), stream.finish());
    CHECK(motiongan::mean_jerk(cleaned) == doctest::Approx(motiongan::mean_jerk(streamed)).epsilon(1e-3));
    CHECK(bytes_of("c.html").find("walk_000, cleaned") != std::string::npos);
    const Said plain = call("clean b --untwist --out u");
    CHECK_MESSAGE(plain.status == 0, plain.text);
    CHECK(bytes_of("u/walk_000.bvh") != bytes_of("b/walk_000.bvh"));
    CHECK(motiongan::mean_jerk(to_motion(read_bvh("u/walk_000.bvh"))) ==
          doctest::Approx(motiongan::mean_jerk(made)).epsilon(1e-3));
    CHECK(call("clean b --out b").status == 1);
    CHECK(call("clean b/walk_000.bvh --out b").has("is an input"));
    CHECK(call("generate run --text walk --clean hands").status != 0);
  }
  SUBCASE("--format glb and --skeleton: an animated body, another skeleton") {
    const Said said = call("generate run --text walk --frames 60 --format glb --out g");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("wrote 1 GLB file"));
    CHECK(bytes_of("g/walk_000.glb").starts_with("glTF"));
    REQUIRE(call("generate run --text walk --frames 60 --format vrma --out g").status == 0);
    CHECK(bytes_of("g/walk_000.vrma").find("VRMC_vrm_animation") != std::string::npos);
    CHECK(call("generate run --text walk --format npy --out g").has("use bvh, glb, fbx or vrma"));
    motiongan::motion::write_bvh("vrm.bvh", motiongan::testing::at_rest(motiongan::testing::vrm()));
    const Said moved = call("generate run --text walk --frames 60 --skeleton vrm.bvh --out v --clean feet");
    CHECK_MESSAGE(moved.status == 0, moved.text);
    CHECK(moved.has("left upper arm"));
    const Motion made = to_motion(read_bvh("v/walk_000.bvh"));
    CHECK(made.skeleton.find("leftUpperArm") >= 0);
    CHECK(made.frames == 60);
    // Written in pieces, but as high above the floor as the whole motion put there afterwards.
    REQUIRE(call("generate run --text walk --frames 60 --skeleton vrm.bvh --out v").status == 0);
    REQUIRE(call("generate run --text walk --frames 60 --out whole").status == 0);
    REQUIRE(call("retarget whole --to vrm.bvh --out again").status == 0);
    const Motion streamed = to_motion(read_bvh("v/walk_000.bvh")),
                 whole = to_motion(read_bvh("again/walk_000.bvh"));
    CHECK(std::abs(motiongan::motion::floor_under(streamed) - motiongan::motion::floor_under(whole)) < 1e-5);
    CHECK(call("generate run --text walk --map m.tsv").has("need --skeleton"));
    CHECK(call("generate run --text walk --skeleton none.bvh").has("none.bvh does not exist"));
    CHECK(call("view v g --glb seen.glb").has("3 animations"));
    CHECK(bytes_of("seen.glb").find("walk_000") != std::string::npos);
  }
  SUBCASE("memory does not grow with the length") {
    const long some = peak_memory("generate run --text walk --frames 1000");
    CHECK(some > 1000);
    CHECK(peak_memory("generate run --text walk --frames 16000") < some + 4096);  // as a motion: 20 MB
    CHECK(read_bvh("walk_000.bvh").frames == 16000);
  }
  SUBCASE("a page shows the first frames") {
    const Said said = call("generate run --text walk --frames 1000 --rate 20 --html long.html");
    CHECK(said.has("of 4996 frames at 20 per second"));
    CHECK(said.has("only the first 3000 frames of each motion are shown"));
    CHECK(bytes_of("long.html").find("\"frames\":3000") != std::string::npos);
  }
  SUBCASE("Ctrl-C leaves no file that is not whole") {
    const Said said =
        shell(in_background +
              "generate run --text walk --frames 100000000 --out s & pid=$!; for i in $(seq "
              "600); do [ $(cat s/walk_000.bvh.*.tmp 2>/dev/null | wc -c) -gt 100000 ] && break; "
              "sleep 0.05; done; kill -INT $pid; wait $pid");
    CHECK_MESSAGE(said.status == 130, said.text);
    CHECK(said.has("stopped; 0 files are complete"));
    CHECK(fs::is_empty("s"));
  }
  SUBCASE("a CNN model makes a window") {
    REQUIRE(call("train dvgan --procedural 6 --save cnn --iterations 1" + tiny).status == 0);
    CHECK(call("generate cnn --text walk --frames 16 --drift cnn.csv").has("wrote cnn.csv"));
    const Said said = call("generate cnn --text walk --frames 17");
    CHECK(said.status == 1);
    CHECK_MESSAGE(said.has("--generator rnn"), said.text);
  }
}

}  // namespace generate_test
