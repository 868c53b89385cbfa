// Clips in other conventions, end to end: what info says, a training of two iterations, and generated motion
// of the clips' own size.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "../support/bodies.hpp"
#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/read_motion.hpp"

namespace any_file_test {

using namespace motiongan::motion;

namespace {

const std::string data = " --frames 8 --rate 10 --hidden 8 --batch 2 --critic-steps 1 --iterations 2 ";

/// The box of all joints, relative to the first joint, over all frames of a folder's files; [low, high].
std::pair<Vec3, Vec3> box_of(const fs::path& folder) {
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (const fs::path& file : find_motion_files(folder)) {
    const Motion motion = read_motion(file).motion;
    const std::vector<Vec3> p = joint_positions(motion);
    const std::size_t joints = motion.skeleton.size(), root = static_cast<std::size_t>(moving_root(motion));
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double d = p[i][a] - p[i / joints * joints + root][a];
        low[a] = std::min(low[a], d), high[a] = std::max(high[a], d);
      }
  }
  return {low, high};
}

/// Trains on `clips` for two iterations and generates; the bodies made have the size of the clips'.
void check_trained(const std::string& options, double height) {
  const Said trained = call("train dvgan clips --save run" + data + options);
  REQUIRE_MESSAGE(trained.status == 0, trained.text);
  const Said made = call("generate run --text walk --count 2 --out made");
  REQUIRE_MESSAGE(made.status == 0, made.text);
  CHECK(made.has("space: y up"));
  const auto [low, high] = box_of("made");
  const auto [real_low, real_high] = box_of("clips");
  const double size = std::max(real_high[1] - real_low[1], 1e-9);
  CHECK(size == doctest::Approx(height).epsilon(0.25));
  // Limbs of an untrained model point anywhere, but bones keep their length: nothing collapses, nothing is
  // further away than the body is tall.
  CHECK(high[1] - low[1] > 0.3 * size);
  for (std::size_t a = 0; a < 3; ++a) {
    CHECK(low[a] > -1.5 * size);
    CHECK(high[a] < 1.5 * size);
  }
}

void write_clips(const Motion& motion) {
  fs::create_directories("clips");
  for (const char* name : {"walk_1", "walk_2", "walk_3"})
    write_bvh(fs::path("clips") / (std::string(name) + ".bvh"), motion);
}

}  // namespace

TEST_CASE("a pelvis that travels beside inverse-kinematics bones") {
  const TestFolder folder;
  const Motion body = standing_body(60);
  Motion m;
  m.rate = body.rate, m.frames = body.frames;
  m.skeleton.joints.push_back({"root", -1, {}, body.skeleton.joints[0].channels, {}});
  for (Joint joint : body.skeleton.joints) {
    ++joint.parent;
    m.skeleton.joints.push_back(joint);
  }
  m.skeleton.joints.push_back({"ik_foot_root", 0, {}, body.skeleton.joints[1].channels, {}});
  const std::size_t n = body.skeleton.size();
  for (std::size_t f = 0; f < m.frames; ++f)
    for (std::size_t j = 0; j < n + 2; ++j) {
      m.rotations.push_back(j > 0 && j <= n ? body.rotation(f, j - 1) : Quat{});
      m.positions.push_back(j > 0 && j <= n ? body.position(f, j - 1) : Vec3{});
    }
  write_clips(m);
  const Said info = call("info clips/walk_1.bvh");
  CHECK_MESSAGE(info.has("Hips moves 118 units, from (0, 95, 0) to (0, 95, 118)"), info.text);
  CHECK(info.has("170 units high at rest, legs 95.18; 1.7 m at 0.01 m per unit, which is a guess"));
  check_trained("", 170);
  // The motion made travels.
  const Motion made = read_motion("made/walk_000.bvh").motion;
  CHECK(moving_root(made) == 1);
}

TEST_CASE("bones that live in position channels") {
  const TestFolder folder;
  Motion m = standing_body(60);
  for (Joint& joint : m.skeleton.joints) {
    joint.offset = {};
    if (joint.channels.size() < 6)
      joint.channels.insert(joint.channels.begin(),
                            {Channel::x_position, Channel::y_position, Channel::z_position});
  }
  write_clips(m);
  const Said info = call("info clips");
  CHECK_MESSAGE(info.has("walk_1.bvh: the OFFSETs of 14 joints, first 'LeftUpLeg', are not their bones"),
                info.text);
  check_trained("", 160);
}

TEST_CASE("z-up metres") {
  const TestFolder folder;
  write_clips(in_z_up(scaled(standing_body(80), 0.01)));
  const Said info = call("info clips/walk_1.bvh");
  CHECK_MESSAGE(info.has("z, turned to y here"), info.text);
  CHECK(info.has("1.7 m at 1 m per unit"));
  CHECK(call("info clips").has("z\n"));
  check_trained("", 1.6);
  CHECK(call("info run/generator.safetensors").has("y up, in metres (the clips had z up)"));
  CHECK(call("generate run --text walk --out made").has("space: y up, in metres (the clips had z up)"));

  // Measures respect the up axis: the same motion in either convention skates alike.
  fs::create_directories("y");
  for (const char* name : {"walk_1", "walk_2"})
    write_bvh(fs::path("y") / (std::string(name) + ".bvh"), standing_body(80));
  const Said measured = call("evaluate motion --generated y --real clips --json m.json");
  REQUIRE_MESSAGE(measured.status == 0, measured.text);
  const std::string json = bytes_of("m.json");
  const auto number = [&](const std::string& set, const std::string& key) {
    return std::stod(json.substr(json.find(key, json.find("\"" + set + "\"")) + key.size() + 3));
  };
  for (const char* key : {"foot_skate_ratio", "foot_contact_ratio", "jerk"})
    CHECK(number("generated", key) == doctest::Approx(number("real", key)).epsilon(1e-3));
}

TEST_CASE("channels in other orders, and a skeleton that does not belong") {
  const TestFolder folder;
  write_clips(standing_body(60));
  Motion other = standing_body(60);
  for (Joint& joint : other.skeleton.joints) std::reverse(joint.channels.begin(), joint.channels.end());
  write_bvh("clips/other.bvh", other);
  CHECK(call("info clips").has("4 clips: 15 joints (48 channels), 3 with channels in another order"));
  check_trained("", 160);
  other.skeleton.joints.back().name = "Helmet";
  write_bvh("clips/prop.bvh", other);
  const Said info = call("info clips");
  CHECK_MESSAGE(info.has("1 clip: 15 joints (48 channels); prop"), info.text);
  CHECK(info.has("compared with the first: 'Head' is called 'Helmet'"));
  const Said refused = call("train dvgan clips --save b" + data);
  CHECK(refused.status == 1);
  CHECK_MESSAGE(refused.has("--skeleton-of FILE"), refused.text);
  const Said kept = call("train dvgan clips --save b --skeleton-of clips/walk_1.bvh" + data);
  CHECK(kept.status == 0);
  CHECK_MESSAGE(kept.has("; 1 of other skeletons"), kept.text);
}

TEST_CASE("a prior in another unit is scaled to the model and back") {
  const TestFolder folder;
  write_clips(standing_body(60));
  REQUIRE(call("train dvgan clips --save run" + tiny_rnn + "--iterations 2").status == 0);
  write_bvh("prior.bvh", scaled(standing_body(60), 0.01));
  write_bvh("same.bvh", standing_body(60));
  const std::string how = " --text walk --seed-frames 4 --frames 4 --seed 3";
  const Said metres = call("complete run --prior prior.bvh --out m" + how);
  REQUIRE_MESSAGE(metres.status == 0, metres.text);
  CHECK_MESSAGE(metres.has("the prior prior.bvh is scaled by 100 to the model's size, by leg length"),
                metres.text);
  const Said units = call("complete run --prior same.bvh --out u" + how);
  CHECK_FALSE(units.has("is scaled"));
  const Motion a =
      read_bvh("m/prior_walk_000.bvh").frames > 0 ? to_motion(read_bvh("m/prior_walk_000.bvh")) : Motion{};
  const Motion b = to_motion(read_bvh("u/same_walk_000.bvh"));
  const std::vector<Vec3> p = joint_positions(a), q = joint_positions(b);
  REQUIRE(p.size() == q.size());
  for (std::size_t i = 0; i < p.size(); ++i)
    CHECK(length(subtract(scale(p[i], 100), q[i])) < 0.05);  // files hold six decimals
}

TEST_CASE("bad files among good ones") {
  const TestFolder folder;
  write_clips(standing_body(60));
  write_file("clips/empty.bvh", "");
  write_file("clips/text.bvh", "hello\n");
  write_file("clips/._walk_1.bvh", "Mac");
  const Said info = call("info clips");
  CHECK(info.status == 0);
  CHECK_MESSAGE(info.has("empty.bvh is empty"), info.text);
  CHECK(info.has("text.bvh:1:1: found 'hello'"));
  CHECK(info.has("training goes on without these files with --skip-bad"));
  const Said refused = call("train dvgan clips --save run" + data);
  CHECK(refused.status == 1);
  CHECK_MESSAGE(refused.has("2 of 5 files cannot be read:"), refused.text);
  const Said trained = call("train dvgan clips --save run --skip-bad" + data);
  CHECK(trained.status == 0);
  CHECK_MESSAGE(trained.has("; 2 that cannot be read"), trained.text);
  CHECK(trained.has("skipped: "));
  CHECK(call("view clips --html a.html").status == 1);
  CHECK(call("view clips --skip-bad --html a.html").status == 0);
}

TEST_CASE("info and view take every kind of file") {
  const TestFolder folder;
  const Motion body = standing_body(60);
  const PositionClip clip{"walk", body.skeleton, 30, body.frames, joint_positions(body)};
  write_position_csv("walk.csv", clip);
  write_position_npy("walk.npy", clip);
  const Said bare = call("info walk.csv");
  CHECK_MESSAGE(bare.has("walk.csv: a clip of joint positions"), bare.text);
  CHECK(bare.has("60 at 30 per second (2 s)"));
  CHECK(bare.has("15: Hips LeftUpLeg"));
  CHECK(call("info walk.npy").has("60; the file holds no rate, --fps tells"));
  write_bone_list("bones.tsv", body.skeleton);
  for (const char* file : {"walk.csv", "walk.npy --fps 30"}) {
    const Said info = call(std::string("info ") + file);
    CHECK_MESSAGE(info.has("Hips moves 118 units"), info.text);
    CHECK(call(std::string("view --html p.html ") + file).has("60 frames at 30 per second, 2 s"));
  }
  const Said no_rate = call("view walk.npy");
  CHECK(no_rate.status == 1);
  CHECK_MESSAGE(no_rate.has("--fps"), no_rate.text);
  fs::copy_file("walk.csv", "WALK.CSV");
  CHECK(call("info WALK.CSV").has("Hips moves 118 units"));
  write_file("log.csv", "iteration,loss\n1,2\n2,1\n");
  CHECK(call("info log.csv").has("a log of 2 rows"));

  // Rate and length of a file whose frame time is a rate.
  write_bvh("walk.bvh", body);
  std::string text = bytes_of("walk.bvh");
  const std::size_t at = text.find("Frame Time: ");
  text.replace(at, text.find('\n', at) - at, "Frame Time: 30");
  write_file("rate.bvh", text);
  CHECK(call("info rate.bvh").has("--fps 30"));
  CHECK(call("info rate.bvh --fps 30").has("60 at 30 per second (2 s)"));
}

}  // namespace any_file_test
