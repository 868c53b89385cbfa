// Reading a motion of any format and convention into one form: y up, bones measured, in the unit asked for.
#include "motiongan/formats/read_motion.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "../support/bodies.hpp"
#include "motiongan/formats/bvh.hpp"

namespace read_motion_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_read_motion_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

double furthest(const Motion& a, const Motion& b) {
  const std::vector<Vec3> p = joint_positions(a), q = joint_positions(b);
  REQUIRE(p.size() == q.size());
  double most = 0;
  for (std::size_t i = 0; i < p.size(); ++i) most = std::max(most, length(subtract(p[i], q[i])));
  return most;
}

}  // namespace

TEST_CASE("a z-up BVH is turned to y up, by detection or by option") {
  const Folder folder;
  const Motion body = standing_body(80);
  write_bvh(folder.path / "y.bvh", body);
  write_bvh(folder.path / "z.bvh", in_z_up(body));
  const LoadedMotion y = read_motion(folder.path / "y.bvh"), z = read_motion(folder.path / "z.bvh");
  CHECK(y.up == UpAxis::y);
  CHECK(z.up == UpAxis::z);
  CHECK(furthest(y.motion, body) < 1e-4);
  CHECK(furthest(z.motion, body) < 1e-4);
  CHECK(furthest(read_motion(folder.path / "z.bvh", {.up = UpAxis::z}).motion, body) < 1e-4);
  const Motion lying = read_motion(folder.path / "z.bvh", {.up = UpAxis::y}).motion;
  CHECK(furthest(lying, in_z_up(body)) < 1e-4);  // an option outweighs what is detected
}

TEST_CASE("scale, rate and first frame") {
  const Folder folder;
  Motion body = standing_body(40);
  prepend_arms(body, 90);
  write_bvh(folder.path / "walk.bvh", body);
  const LoadedMotion loaded = read_motion(folder.path / "walk.bvh", {.scale = 0.01, .fps = 60});
  CHECK(loaded.dropped == 1);
  CHECK(loaded.motion.frames == 40);
  CHECK(loaded.motion.rate == 60);
  CHECK(body_height(loaded.motion.skeleton) == doctest::Approx(1.7));
  CHECK(loaded.motion.position(39, 0)[2] == doctest::Approx(0.78));
  CHECK(read_motion(folder.path / "walk.bvh", {.first_frame = FirstFrame::keep}).motion.frames == 41);
  CHECK(read_motion(folder.path / "walk.bvh", {.unit_metres = 0.02, .scale = 0.5}).unit_metres ==
        doctest::Approx(0.04));
}

TEST_CASE("bones in position channels are measured, and said") {
  const Folder folder;
  Motion body = standing_body(40);
  for (Joint& joint : body.skeleton.joints) {
    joint.offset = {};
    if (joint.channels.size() < 6)
      joint.channels.insert(joint.channels.begin(),
                            {Channel::x_position, Channel::y_position, Channel::z_position});
  }
  write_bvh(folder.path / "zero.bvh", body);
  const LoadedMotion loaded = read_motion(folder.path / "zero.bvh");
  CHECK(loaded.bones.measured.size() == 14);
  CHECK(loaded.motion.skeleton.joints[2].offset == Vec3{0, -42, 0});
  REQUIRE(loaded.notes.size() == 1);
  CHECK(loaded.notes[0].find("the OFFSETs of 14 joints, first 'LeftUpLeg', are not their bones") !=
        std::string::npos);
  // Poses without these channels keep the body's shape.
  Motion plain = loaded.motion;
  for (std::size_t f = 0; f < plain.frames; ++f)
    for (std::size_t j = 1; j < plain.skeleton.size(); ++j)
      plain.position(f, j) = plain.skeleton.joints[j].offset;
  CHECK(furthest(plain, standing_body(40)) < 1e-4);
}

TEST_CASE("joint positions are read as a motion, in any order of joints and either up axis") {
  const Folder folder;
  const Motion body = standing_body(80);
  PositionClip clip{"walk", body.skeleton, body.rate, body.frames, joint_positions(body)};
  write_bone_list(folder.path / "bones.tsv", clip.skeleton);
  write_position_csv(folder.path / "walk.csv", clip);
  CHECK(furthest(read_motion(folder.path / "walk.csv").motion, body) < 1e-3);
  for (Vec3& p : clip.positions) p = {p[0], -p[2], p[1]};
  write_position_csv(folder.path / "z.csv", clip);
  const LoadedMotion z = read_motion(folder.path / "z.csv");
  CHECK(z.up == UpAxis::z);
  CHECK(furthest(z.motion, body) < 1e-3);

  // Breadth first, as HumanML3D's arrays are: read depth first, as BVH and models need.
  PositionClip broad{"broad", {}, 30, 2, {}};
  broad.skeleton.joints = {{"root", -1, {}, {}, {}},
                           {"a", 0, {}, {}, {}},
                           {"b", 0, {}, {}, {}},
                           {"a2", 1, {}, {}, {}},
                           {"b2", 2, {}, {}, {}}};
  for (std::size_t i = 0; i < 10; ++i) broad.positions.push_back({static_cast<double>(i), 1, 2});
  fs::create_directories(folder.path / "broad");
  write_bone_list(folder.path / "broad" / "bones.tsv", broad.skeleton);
  write_position_csv(folder.path / "broad" / "c.csv", broad);
  const PositionClip deep = read_positions(folder.path / "broad" / "c.csv", {}, 0).clip;
  std::string names;
  for (const Joint& joint : deep.skeleton.joints) names += joint.name + " ";
  CHECK(names == "root a a2 b b2 ");
  CHECK(deep.skeleton.joints[4].parent == 3);
  for (std::size_t k = 0; k < 5; ++k) {
    const std::size_t from[] = {0, 1, 3, 2, 4};
    CHECK(deep.positions[5 + k][0] == static_cast<double>(5 + from[k]));
  }
}

TEST_CASE("the motion files of a folder") {
  const Folder folder;
  write_bvh(folder.path / "a.BVH", standing_body(3));
  const Motion body = standing_body(3);
  write_position_csv(folder.path / "c.csv", {"c", body.skeleton, 30, 3, joint_positions(body)});
  for (const char* name :
       {"log.csv", "captions.csv", "x.npz", "shape.npz", "male_shape.npz", "._a.bvh", "n.txt"})
    write_text_atomically(folder.path / name, "iteration,loss\n1,2\n");
  std::string found;
  for (const fs::path& file : find_motion_files(folder.path)) found += file.filename().string() + " ";
  CHECK(found == "a.BVH c.csv x.npz ");
  fs::create_directories(folder.path / "none");
  write_text_atomically(folder.path / "none" / "log.csv", "iteration,loss\n1,2\n");
  CHECK_THROWS_WITH_AS(find_motion_files(folder.path / "none"), doctest::Contains("have no motion file"),
                       Error);
}

TEST_CASE("a frame time in another unit is refused by file, unless --fps corrects it") {
  const Folder folder;
  const fs::path file = folder.path / "slow.bvh";
  Motion body = standing_body(80);
  body.rate = 1 / 600000.0;
  write_bvh(file, body);
  for (const auto& read : {+[](const fs::path& path) { read_motion(path); },
                           +[](const fs::path& path) { inspect_motion(path); }}) {
    CHECK_THROWS_WITH_AS(read(file), doctest::Contains("slow.bvh: "), Error);
    CHECK_THROWS_WITH_AS(read(file), doctest::Contains("frame time in another unit? --fps gives the rate"),
                         Error);
  }
  CHECK(read_motion(file, {.fps = 30}).motion.rate == 30);
}

}  // namespace read_motion_test
