// Going on from a clip through the command.
#include <doctest/doctest.h>

#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

namespace complete_test {

using namespace motiongan::motion;

namespace {

/// Whether two frames stand and are turned alike, up to the digits of a file.
bool same_frame(const Motion& a, std::size_t f, const Motion& b, std::size_t g) {
  for (std::size_t j = 0; j < a.skeleton.size(); ++j)
    if (length(expmap_from_quat(multiply(inverse(a.rotation(f, j)), b.rotation(g, j)))) > 1e-4 ||
        length(subtract(a.position(f, j), b.position(g, j))) > 1e-3)
      return false;
  return true;
}

double step(const Motion& m, std::size_t frame) {
  return length(subtract(m.position(frame, 0), m.position(frame - 1, 0)));
}

}  // namespace

TEST_CASE("complete, from a model of two iterations") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 2" + tiny_rnn).status == 0);
  const Motion clip = to_motion(read_bvh("clips/walk_000.bvh"));  // 150 frames at 30 per second
  const std::string walk = "complete run --prior clips/walk_000.bvh --text 'Walk on' ";

  SUBCASE("files hold the seed and go on from it; the clip stands beside them, with errors") {
    const Said said = call(walk + "--seed-frames 6 --frames 9 --count 3 --out a --html a.html --png a.png");
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("a/walk_000_walk-on_000.bvh to walk_000_walk-on_002.bvh"));
    CHECK(said.has("6 frames of walk_000 from frame 0 on, then 9 generated frames (2.25 s)"));
    CHECK(said.has("\"Walk on\": the model never saw \"on\""));
    CHECK(said.has("true ms         500  1000"));  // at 4 per second the other times have no frame
    CHECK(said.has("zero velocity"));
    CHECK(said.has("best of 3"));
    const Motion made = to_motion(read_bvh("a/walk_000_walk-on_001.bvh")), given = resample(clip, 4);
    CHECK(made.frames == 15);
    CHECK(made.rate == 4);
    for (std::size_t f = 0; f < 6; ++f) CHECK(same_frame(made, f, given, f));
    CHECK_FALSE(same_frame(made, 6, made, 5));
    double largest = 0;
    for (std::size_t f = 7; f < 15; ++f) largest = std::max(largest, step(made, f));
    CHECK(step(made, 6) < 2 * largest + 1e-3);
    CHECK(bytes_of("a.html").find("walk_000, ground truth") != std::string::npos);
    CHECK(bytes_of("a.html").find("\"seed\":6") != std::string::npos);
    CHECK(bytes_of("a.png").substr(1, 3) == "PNG");
    REQUIRE(call(walk + "--seed-frames 6 --frames 9 --first-sample 1 --out b").status == 0);
    CHECK(bytes_of("b/walk_000_walk-on_001.bvh") == bytes_of("a/walk_000_walk-on_001.bvh"));
    CHECK(bytes_of("a/walk_000_walk-on_000.bvh") != bytes_of("a/walk_000_walk-on_001.bvh"));
    REQUIRE(call(walk + "--seed-frames 6 --frames 9 --weights bf16 --out c").status == 0);
    const Motion rounded = to_motion(read_bvh("c/walk_000_walk-on_000.bvh"));
    for (std::size_t f = 0; f < 6; ++f) CHECK(same_frame(rounded, f, given, f));
    CHECK(bytes_of("c/walk_000_walk-on_000.bvh") != bytes_of("a/walk_000_walk-on_000.bvh"));
    REQUIRE(call(walk + "--seed-frames 6 --frames 9 --clean feet,smooth --out d").status == 0);
    const Motion cleaned = to_motion(read_bvh("d/walk_000_walk-on_000.bvh"));
    for (std::size_t f = 0; f < 6; ++f) CHECK(same_frame(cleaned, f, given, f));
    CHECK(bytes_of("d/walk_000_walk-on_000.bvh") != bytes_of("a/walk_000_walk-on_000.bvh"));
  }
  SUBCASE("--from names a frame or seconds; --rate and any number of frames") {
    REQUIRE(call(walk + "--seed-frames 3 --from 45 --frames 200 --rate 60 --out a").status == 0);
    REQUIRE(call(walk + "--seed-frames 3 --from 1.5s --frames 200 --rate 60 --out b").status == 0);
    const std::string name = "/walk_000_walk-on_000.bvh";
    CHECK(bytes_of("a" + name) == bytes_of("b" + name));
    const Motion made = to_motion(read_bvh("a" + name));
    CHECK(made.rate == 60);
    CHECK(made.frames == 202 * 15 + 1);
    CHECK(same_frame(made, 0, clip, 45));
    CHECK(same_frame(made, 30, clip, 60));  // the seed's last one
  }
  SUBCASE("a T-pose before the motion is no part of the seed; a clip may end with the seed") {
    Clip posed = read_bvh("clips/walk_000.bvh");
    posed.channels.insert(posed.channels.begin(), posed.skeleton.channel_count(), 0.0);
    ++posed.frames;
    write_bvh("posed.bvh", posed);
    const Said said =
        call("complete run --prior posed.bvh --text walk --seed-frames 20 --frames 2 --html p.html");
    CHECK(said.has("from frame 1 (after the T-pose at its start) on"));
    CHECK(said.has("no error against the clip: it ends with the seed"));
    CHECK(bytes_of("p.html").find("ground truth") == std::string::npos);
    CHECK(same_frame(to_motion(read_bvh("posed_walk_000.bvh")), 0, clip, 0));
  }
  SUBCASE("what cannot be completed is refused") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said said = call("complete " + arguments);
      CHECK(said.status == 1);
      CHECK_MESSAGE(said.has(why), said.text);
    };
    const std::string prior = " --prior clips/walk_000.bvh ";
    refused("run" + prior + "--text walk", "has 150 frames from frame 0 on, 5 s at 30 per second");
    refused("run" + prior + "--text walk", "or --seed-frames 20 at most");
    refused("run" + prior + "--text '...'", "has no words");
    refused("run" + prior + "--text walk --from 150", "which has 150 frames at 30 per second (5 s)");
    refused("run" + prior + "--text walk --from soon", "--from soon: expected a frame of the prior");
    refused("run --prior absent.bvh --text walk", "absent.bvh");
    Clip other = read_bvh("clips/walk_000.bvh");
    other.skeleton.joints[3].name = "Trunk";
    write_bvh("other.bvh", other);
    refused("run --prior other.bvh --text walk", "the prior other.bvh has a different skeleton");
    refused("run --prior other.bvh --text walk", "is called 'Trunk'");
    CHECK(call("complete run --text walk" + prior + "--frames 0").has("above 0, not 0"));
    CHECK(call("complete run" + prior).status > 1);  // usage: no text
    REQUIRE(call("train dvgan clips --save cnn --iterations 1" + tiny).status == 0);
    refused("cnn" + prior + "--text walk", "--generator rnn");
  }
}

}  // namespace complete_test
