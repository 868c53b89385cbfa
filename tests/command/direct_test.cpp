// motiongan generate with paths, poses, points and loops, and motiongan inbetween.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

#include "command.hpp"
#include "motiongan/direct/errors.hpp"
#include "motiongan/direct/path_file.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

namespace direct_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

constexpr const char* few = " --starts 2 --direct-iterations 10";

Motion read(const std::string& file) { return to_motion(read_bvh(file)); }

/// A hand a little above where it is, a foot that stands, and the head where it is.
std::string asking_for_joints(const Motion& own) {
  const auto place = [&](const char* joint, std::size_t frame, double up) {
    const Vec3 p = world_pose(own, frame, 0).joint(static_cast<std::size_t>(own.skeleton.find(joint)));
    return concat(p[0], ",", p[1] + up, ",", p[2]);
  };
  return concat("generate run --text walk --exact --out j --hand left@1:",
                place("LeftHand", 4, 0.1 * body_unit(own.skeleton)), " --joint head@3:", place("Head", 12, 0),
                " --stand left@1.5-2");
}

}  // namespace

TEST_CASE("generate meets what it is asked for, exactly if asked, and says how well") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  REQUIRE(call("train dvgan clips --save run --iterations 3 --frames 16 --hidden 8 --batch 4").status == 0);
  REQUIRE(call("generate run --text walk --out own").status == 0);
  const Motion own = read("own/walk_000.bvh");
  const double leg = body_unit(own.skeleton);
  const WorldPose start = world_pose(own, 0, 0);

  SUBCASE("a path, timed: --exact brings the root to its points; the page shows it") {
    std::ofstream("path.csv") << "time,x,z\n0," << start.x << ',' << start.z << "\n# half way\n2,"
                              << start.x + 0.5 * leg << ',' << start.z + leg << "\n3.5," << start.x << ','
                              << start.z + 2 * leg << '\n';
    const Said said =
        call("generate run --text walk --path path.csv --exact --count 2 --out p --html p.html" +
             std::string(few));
    CHECK_MESSAGE(said.has("path of 3 points"), said.text);
    const std::vector<PathPoint> points = read_path("path.csv");
    for (const char* file : {"p/walk_000.bvh", "p/walk_001.bvh"}) {
      const Motion made = read(file);
      for (const PathPoint& p : points) {
        const WorldPose at = world_pose(made, frame_at(*p.time, made.rate), 0);
        CHECK(std::hypot(at.x - p.x, at.z - p.z) < 1e-3 * leg);
      }
    }
    CHECK(bytes_of("p.html").find("\"path\":[") != std::string::npos);
    // The same seed gives the same files.
    REQUIRE(call("generate run --text walk --path path.csv --exact --count 2 --out q" + std::string(few))
                .status == said.status);
    CHECK(bytes_of("p/walk_001.bvh") == bytes_of("q/walk_001.bvh"));
  }
  SUBCASE("a pose, a hand, a joint, a standing foot and a loop") {
    const Motion clip = read("own/walk_000.bvh");
    const Said said =
        call("generate run --text walk --keyframe 2:own/walk_000.bvh@1 --loop --exact --out p --html p.html" +
             std::string(few));
    CHECK_MESSAGE(said.status == 0, said.text);
    CHECK(said.has("pose at 2 s"));
    CHECK(said.has("loop"));
    CHECK(bytes_of("p.html").find("\"ghosts\":[[") != std::string::npos);
    const Motion made = read("p/walk_000.bvh");
    CHECK(constraint_errors(made, 0, {PoseConstraint{.time = 2, .pose = slice(clip, 4, 1)}}).front().worst <
          1e-3 * leg);
    CHECK(constraint_errors(made, 0, {LoopConstraint{}}).front().worst < 1e-3 * leg);
    const Said hand = call(asking_for_joints(own) + few);
    CHECK_MESSAGE(hand.status == 0, hand.text);
    CHECK(hand.has("LeftHand at 1 s"));
    CHECK(hand.has("LeftFoot stands at 1.5 s to 2 s"));
    CHECK(hand.has("Head at 3 s"));
  }
  SUBCASE("what is not met is said, and is the exit status") {
    const Said said = call(concat("generate run --text walk --hand left@2:", start.x, ",", 9 * leg, ",",
                                  start.z, " --out p", few));
    CHECK(said.status == 4);
    CHECK(said.has("NOT MET by the motion"));
    CHECK(fs::exists("p/walk_000.bvh"));
  }
  SUBCASE("mistakes name the option, the file and what was expected") {
    const auto refused = [](const std::string& arguments, const std::string& why) {
      const Said no = call("generate run --text walk --out x " + arguments);
      CHECK(no.status != 0);
      CHECK_MESSAGE(no.has(why), no.text);
    };
    refused("--loop --drift d.csv", "--drift does not go with");
    refused("--path none.csv", "none.csv does not exist");
    write_file("one.csv", "1,2\n");
    refused("--path one.csv", "one.csv has 1 point");
    write_file("bad.csv", "x,z\n0,0\n1,far\n");
    refused("--path bad.csv", "bad.csv:3: found 'far' as z, expected a number");
    write_file("named.csv", "x,y\n0,0\n");
    refused("--path named.csv", "names no column z");
    write_file("late.csv", "0,0,0\n1,1,99\n");
    refused("--path late.csv --frames 16", "from 0 to 3.75 s");
    write_file("far.csv", "0,0,0\n1e6,1,1\n");
    refused("--path far.csv", "the fastest of the training motion");
    refused("--keyframe pose.bvh", "expected TIME:FILE");
    refused("--keyframe 1:none.bvh", "none.bvh does not exist");
    refused("--keyframe 1:own/walk_000.bvh@99", "lasts 4 s");
    refused("--keyframe 9:own/walk_000.bvh --frames 16", "outside of the motion");
    refused("--hand both@1:0,0,0", "expected left or right");
    refused("--hand left@1:0,0", "expected x,y,z");
    refused("--hand left@x:0,0,0", "expected seconds");
    refused("--joint Hed@1:0,0,0", "nearest: Head");
    refused("--stand left@1:0,0,0", "expected seconds");
    refused("--stand left@1", "less than a frame");
    refused("--keyframe 1:own/walk_000.bvh --html own/walk_000.bvh", "would be an HTML page");
  }
}

TEST_CASE("models of classes are directed: times count from the end of the given second") {
  const TestFolder folder;
  REQUIRE(call("train attention --procedural 51 --save run --iterations 2 --frames 8 --rate 10 --hidden 8 "
               "--batch 4 --noise 4 --classes walk,run")
              .status == 0);
  write_file("path.csv", "x,z,time\n0,0,0\n10,60,1\n10,130,2\n");
  const std::string path = "generate run --class walk --path path.csv --exact --count 2";
  const Said said = call(path + " --out p --html p.html" + few);  // 4: off the path between its points
  CHECK_MESSAGE((said.status == 0 || said.status == 4), said.text);
  CHECK(said.has("8 given frames, then 32 generated frames"));
  CHECK(said.has("path of 3 points"));
  CHECK(bytes_of("p.html").find("\"path\":[") != std::string::npos);
  const Motion made = read("p/walk_001.bvh");
  CHECK(made.frames == 40);
  const double leg = body_unit(made.skeleton);
  const auto root_at = [](const Motion& m, std::size_t frame) { return world_pose(m, frame, 0); };
  const auto far = [&](const WorldPose& p, double x, double z) { return std::hypot(p.x - x, p.z - z) / leg; };
  CHECK(far(root_at(made, 7), 0, 0) < 1e-3);
  CHECK(far(root_at(made, 7 + 20), 10, 130) < 1e-3);
  // Without the given second, times are those of the file but for a frame; reruns are equal.
  REQUIRE(call(path + " --no-prior --out q" + few).status == said.status);
  CHECK(far(root_at(read("q/walk_001.bvh"), 19), 10, 130) < 1e-3);
  REQUIRE(call(path + " --out r" + few).status == said.status);
  CHECK(bytes_of("p/walk_001.bvh") == bytes_of("r/walk_001.bvh"));

  const Said more = call(
      "generate run --class walk:1s,run:1s --keyframe 1.5:p/walk_000.bvh@2 --loop 2 --clean feet --out k" +
      std::string(few));
  CHECK_MESSAGE((more.status == 0 || more.status == 4), more.text);
  CHECK(more.has("pose at 1.5 s"));
  CHECK(more.has("loop"));
  CHECK(fs::exists("k/walk-run_000.bvh"));
  CHECK(call("generate run --class walk --seconds 2 --hand left@1:0,9999,0 --out n --format csv" +
             std::string(few))
            .status == 4);
  CHECK(fs::exists("n/walk_000.csv"));
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said no = call("generate run --class walk --out x " + arguments);
    CHECK(no.status != 0);
    CHECK_MESSAGE(no.has(why), no.text);
  };
  refused("--loop 9 --seconds 2", "outside of the motion, which is from 0 to 2 s");
  refused("--joint Hed@1:0,0,0", "nearest: Head");
}

TEST_CASE("inbetween fills a gap, for models of either kind, and leaves the clips alone") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 6 --seconds 5").status == 0);
  for (const char* kind : {"cnn", "rnn --critic rnn"}) {
    CAPTURE(kind);
    fs::remove_all("run");
    REQUIRE(
        call(concat(
                 "train dvgan clips --save run --iterations 2 --frames 16 --hidden 8 --batch 4 --generator ",
                 kind))
            .status == 0);
    const std::string clips =
        "--from clips/walk_000.bvh --to clips/walk_000.bvh --text walk --out b" + std::string(few);
    const Said said = call("inbetween run --seconds 2 --place free --count 2 --html b.html " + clips);
    CHECK_MESSAGE((said.status == 0 || said.status == 4), said.text);
    CHECK(said.has("7 between (2 s)"));
    const Motion made = read("b/walk_000_walk_000_walk_001.bvh"),
                 clip = resample(read("clips/walk_000.bvh"), 4);
    REQUIRE(made.frames == 2 * clip.frames + 7);
    for (std::size_t f = 0; f < clip.frames; ++f)
      for (std::size_t j = 0; j < clip.skeleton.size(); ++j) {
        CHECK(angle_between(made.rotation(f, j), clip.rotation(f, j)) < 1e-4);
        if (j > 0) CHECK(angle_between(made.rotation(f + clip.frames + 7, j), clip.rotation(f, j)) < 1e-4);
      }
    CHECK(bytes_of("b.html").size() > 1000);
  }
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said no = call("inbetween run --from clips/walk_000.bvh --text walk --out x " + arguments);
    CHECK(no.status != 0);
    CHECK_MESSAGE(no.has(why), no.text);
  };
  refused("", "--to is required");
  refused("--to none.bvh", "none.bvh does not exist");
  refused("--to clips/walk_000.bvh --seconds 0.2", "has no frames between");
  refused("--to clips/walk_000.bvh --place here", "keep");
}

}  // namespace direct_test
