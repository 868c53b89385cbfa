// GLB files as clips and as characters that clips are put on.
#include "motiongan/formats/glb_reader.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <motiongan/formats/bvh.hpp>
#include <motiongan/formats/glb_character.hpp>
#include <motiongan/formats/read_motion.hpp>
#include <motiongan/motion/retarget.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/folders.hpp"
#include "../support/glb_reader.hpp"
#include "../support/messages.hpp"

namespace glb_reader_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;
using Json = nlohmann::json;

namespace {

Motion walk() { return procedural_motion(0, {.seconds = 1, .rate = 30}).motion; }

std::filesystem::path put(const Scratch& scratch, const char* name, const std::string& bytes) {
  std::ofstream(scratch.path / name, std::ios::binary) << bytes;
  return scratch.path / name;
}

double furthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, length(subtract(a[i], b[i])));
  return out;
}

/// An arm as 3D programs leave it: its joints are in centimetres along their own axes below a node that turns
/// and shrinks them, one has a matrix, and a mesh hangs from it. Animation 0 is sampled, 1 has a spline,
/// steps and rotations in 16 bits.
struct Arm {
  glb_detail::Document document;
  static constexpr double h = 0.7071067811865476;

  Arm() {
    document["nodes"] = {
        {{"name", "Armature"},
         {"scale", {0.01, 0.01, 0.01}},
         {"rotation", {h, 0, 0, h}},
         {"children", {1, 4}}},
        {{"name", "upper arm"}, {"translation", {0, 100, 0}}, {"rotation", {0, 0, h, h}}, {"children", {2}}},
        {{"name", "forearm"},
         {"matrix", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 30, 0, 0, 1}},
         {"children", {3, 5}}},
        {{"name", "hand"}, {"translation", {0, 20, 0}}},
        {{"name", "body"}, {"mesh", 0}, {"skin", 0}},
        {{"name", "hand end"}, {"translation", {0, 0, 10}}}};
    document["meshes"] = {{{"name", "sleeve"}}};
    document["skins"] = {{{"joints", {1, 2, 3}}}};
    const std::size_t times = document.add(std::vector<float>{0, 0.1F, 0.2F, 0.3F}, "SCALAR", 1, true);
    std::vector<float> turns;
    for (int k = 0; k < 4; ++k)
      for (const double v : {0.0, std::sin(0.1 * k), 0.0, std::cos(0.1 * k)})
        turns.push_back(static_cast<float>(v));
    document.push("animations",
                  {{"name", "bend/low"},
                   {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}},
                   {"samplers", {{{"input", times}, {"output", document.add(turns, "VEC4", 4)}}}}});
    const std::size_t two = document.add(std::vector<float>{1, 2}, "SCALAR", 1, true);
    // From 0 to 10 along x with a tangent of 20 at the start and none at the end.
    const std::size_t spline = document.add(
        std::vector<float>{0, 0, 0, 0, 0, 0, 20, 0, 0, /**/ 0, 0, 0, 10, 0, 0, 0, 0, 0}, "VEC3", 3);
    const std::size_t shorts =
        document.add(std::vector<std::uint16_t>{0, 0, 0, 32767, 32767, 0, 0, 0}, "VEC4", 4);
    document["accessors"][shorts]["componentType"] = 5122, document["accessors"][shorts]["normalized"] = true;
    document.push("animations", {{"name", "reach"},
                                 {"channels",
                                  {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}},
                                   {{"sampler", 1}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                                   {{"sampler", 1}, {"target", {{"node", 0}, {"path", "scale"}}}}}},
                                 {"samplers",
                                  {{{"input", two}, {"output", spline}, {"interpolation", "CUBICSPLINE"}},
                                   {{"input", two}, {"output", shorts}, {"interpolation", "STEP"}}}}});
  }

  NodeScene scene() { return scene_of(parse_glb(document.file(), "arm.glb"), "arm.glb"); }
};

}  // namespace

TEST_CASE("what is written as GLB is read as the same motion") {
  const Scratch scratch;
  const std::filesystem::path file = put(scratch, "walk.glb", "");
  write_glb(file, std::vector<NamedMotion>{{"walk", walk()}}, {.unit_metres = 0.01});
  const LoadedMotion loaded = read_motion(file, {.first_frame = FirstFrame::keep});
  CHECK(loaded.unit_metres == 1);
  CHECK(loaded.up == UpAxis::y);
  CHECK(loaded.motion.rate == 30);
  CHECK(loaded.motion.frames == walk().frames);
  for (std::size_t j = 0; j < walk().skeleton.size(); ++j) {
    CHECK(loaded.motion.skeleton.joints[j].name == walk().skeleton.joints[j].name);
    CHECK(loaded.motion.skeleton.joints[j].parent == walk().skeleton.joints[j].parent);
  }
  CHECK(furthest(joint_positions(scaled(walk(), 0.01)), joint_positions(loaded.motion)) < 1e-5);
  CHECK(read_motion(file, {.fps = 60, .first_frame = FirstFrame::keep}).motion.frames ==
        2 * walk().frames - 1);
}

TEST_CASE("joints have the world's axes and metres, whatever their nodes have") {
  Arm arm;
  const NodeScene scene = arm.scene();
  const SceneSkeleton found = skeleton_of(scene, "arm.glb");
  REQUIRE(found.skeleton.size() == 4);  // what hangs from a joint, but not the mesh nor the node above
  CHECK(found.nodes == std::vector<std::size_t>{1, 2, 3, 5});
  // By hand: the armature takes (x, y, z) cm to (x, -z, y) / 100 m.
  CHECK(length(subtract(found.skeleton.joints[0].offset, {0, 0, 1})) < 1e-12);
  CHECK(length(subtract(found.skeleton.joints[1].offset, {0, 0, 0.3})) < 1e-12);  // 30 along x, turned to y
  CHECK(length(subtract(found.skeleton.joints[2].offset, {-0.2, 0, 0})) < 1e-12);
  CHECK(length(subtract(found.skeleton.joints[3].offset, {0, 0, 0.1})) <
        1e-12);  // its z is the upper arm's x
  CHECK(found.skeleton.joints[3].parent == 1);

  const Motion bend = motion_of(scene, found, scene.animations[0], 0, "arm.glb");
  CHECK(bend.rate == 10);
  CHECK(bend.frames == 4);
  // At key 0 the forearm has no rotation of its own: a quarter turn back from rest.
  CHECK(std::abs(angle_between(bend.rotation(0, 1), {})) == doctest::Approx(pi / 2));
  CHECK(angle_between(bend.rotation(0, 1), bend.rotation(3, 1)) == doctest::Approx(0.6));
  CHECK(length(subtract(bend.position(2, 0), {0, 0, 1})) < 1e-12);

  const Motion reach = motion_of(scene, found, scene.animations[1], 4, "arm.glb");
  CHECK(reach.frames == 5);
  // A cubic from 0 with slope 20 to 10 with slope 0: at the middle 20 / 8 + 10 / 2 = 7.5 cm.
  CHECK(length(subtract(reach.position(2, 0), {0.075, 0, 0})) < 1e-9);
  CHECK(length(subtract(reach.position(4, 0), {0.1, 0, 0})) < 1e-9);
  CHECK(angle_between(reach.rotation(3, 1), reach.rotation(0, 1)) < 1e-6);  // steps
  CHECK(angle_between(reach.rotation(4, 1), reach.rotation(0, 1)) == doctest::Approx(pi));
}

TEST_CASE("animations of a file are clips") {
  const Scratch scratch;
  const std::filesystem::path file = put(scratch, "arm.glb", Arm().document.file());
  const std::vector<std::filesystem::path> clips = find_motion_files(file.parent_path());
  REQUIRE(clips.size() == 2);
  CHECK(clips[0].filename() == "arm.glb#bend_low");
  CHECK(find_motion_files(file) == clips);
  CHECK(find_motion_files(clips[1]) == std::vector{clips[1]});
  CHECK(clip_ids(clips, file.parent_path()) == std::vector<std::string>{"arm_bend_low", "arm_reach"});
  CHECK(read_motion(clips[1], {.fps = 4, .first_frame = FirstFrame::keep}).motion.frames == 5);
  const LoadedMotion first = read_motion(file, {.first_frame = FirstFrame::keep});
  CHECK(first.motion.frames == 4);
  REQUIRE(!first.notes.empty());
  CHECK(first.notes.front().find("arm.glb#reach names another") != std::string::npos);
  CHECK(says(message_of([&] { read_motion(file.string() + "#wave"); }),
             "no animation 'wave' in the file; it has 'bend_low', 'reach'"));
  CHECK(says(message_of([&] { read_motion(file, {.fps = 1e9}); }),
             "at 1e+09 per second, expected at most 1.25e+07"));
  // A character without animations is no clip.
  Arm still;
  still.document["animations"] = Json::array();
  put(scratch, "still.glb", still.document.file());
  CHECK(find_motion_files(file.parent_path()) == clips);
  CHECK(read_motion(put(scratch, "still.glb", still.document.file())).motion.frames == 0);
  CHECK(says(message_of([&] { read_motion(put(scratch, "a.fbx", "x")); }), "reads no FBX files"));
}

TEST_CASE("motion is written into a character, for its own axes, beside its mesh") {
  const Scratch scratch;
  const std::filesystem::path file = put(scratch, "arm.glb", Arm().document.file());
  const GlbCharacter character(file);
  Motion made = character.motion();
  REQUIRE(made.frames == 4);
  for (std::size_t f = 0; f < made.frames; ++f) {
    made.position(f, 0) = {0.1 * static_cast<double>(f), 0.5, -0.2};
    for (std::size_t j = 0; j < made.skeleton.size(); ++j)
      made.rotation(f, j) = normalize({1, 0.1 * static_cast<double>(f), 0.2 * static_cast<double>(j), -0.3});
  }
  const std::string bytes = character.file(std::vector<NamedMotion>{{"made", made}, {"again", made}});
  const Glb checked(bytes);
  CHECK(checked.json["animations"].size() == 2);
  CHECK(checked.json["meshes"][0]["name"] == "sleeve");
  CHECK(!checked.json["nodes"][2].contains("matrix"));
  const std::filesystem::path out = put(scratch, "made.glb", bytes);
  const GlbCharacter again(out);
  CHECK(furthest(joint_positions(again.motion()), joint_positions(made)) < 1e-6);
  CHECK(furthest(rest_positions(again.motion().skeleton), rest_positions(character.motion().skeleton)) <
        1e-6);
  for (std::size_t i = 0; i < made.rotations.size(); ++i)
    CHECK(angle_between(again.motion().rotations[i], made.rotations[i]) < 1e-6);
  CHECK(says(message_of([&] { character.file({}); }), "no motions"));
  CHECK(says(message_of([&] {
               character.file(std::vector<NamedMotion>{{"walk", walk()}});
             }),
             "joints, expected the 4 of"));
}

TEST_CASE("damaged files are named, and what is wrong with them") {
  const std::string good = Arm().document.file();
  const auto refused = [](const std::string& bytes, const std::string& why) {
    const std::string said =
        message_of([&] { skeleton_of(scene_of(parse_glb(bytes, "arm.glb"), "arm.glb"), "arm.glb"); });
    CHECK_MESSAGE(says(said, why), why, ": ", said);
    CHECK_MESSAGE(says(said, "arm.glb"), said);
  };
  refused("", "begins with \"glTF\"");
  refused("{\"asset\": {}}", "only the binary form (.glb) is read");
  refused(good.substr(0, 6), "ends after 6 bytes");
  refused(good.substr(0, good.size() - 40), "ends beyond the end of the file");
  std::string first = good;
  first[4] = 1;
  refused(first, "glTF version 1, expected 2");
  std::string no_json = good;
  no_json[20] = '!';
  refused(no_json, "JSON cannot be read");
  const auto changed = [&](const std::function<void(glb_detail::Document&)>& change, const std::string& why) {
    Arm arm;
    change(arm.document);
    refused(arm.document.file(), why);
  };
  changed([](auto& d) { d["nodes"][1]["children"] = {9}; }, "has a child that is not there");
  changed([](auto& d) { d["nodes"][3]["children"] = {0}; }, "are below themselves");
  changed([](auto& d) { d["nodes"][1]["translation"] = {1, 2}; }, "'translation' should be 3 numbers");
  changed([](auto& d) { d["nodes"][1]["translation"] = {1, "x", 2}; }, "'translation' should be 3 numbers");
  changed([](auto& d) { d["skins"][0]["joints"] = {77}; }, "has a joint that is not there");
  changed([](auto& d) { d["animations"][0]["samplers"][0]["input"] = 99; },
          "accessors 99 is used, but is not there");
  changed([](auto& d) { d["animations"][0]["samplers"][0]["output"] = 0; },
          "is of type 'SCALAR', expected 4 numbers");
  changed([](auto& d) { d["animations"][0]["channels"][0]["sampler"] = 5; }, "moves node 2 by sampler 5");
  changed([](auto& d) { d["accessors"][0]["count"] = 4000000000u; }, "reaches beyond the end");
  changed([](auto& d) { d["accessors"][0]["count"] = 3; }, "3 keys with 16 numbers, expected 4 each");
  changed([](auto& d) { d["accessors"][0]["componentType"] = 7; }, "component type 7");
  changed([](auto& d) { d["accessors"][0]["sparse"] = {{"count", 1}}; }, "is sparse, which is not read");
  changed([](auto& d) { d["nodes"] = Json::array(); }, "is not there");
  changed([](auto& d) { d["nodes"] = "x"; }, "is used, but is not there");
}

}  // namespace glb_reader_test
