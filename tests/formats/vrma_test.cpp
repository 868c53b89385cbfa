// VRM animations: the humanoid map, and where its bones are.
#include <doctest/doctest.h>

#include <motiongan/formats/vrma.hpp>
#include <set>

#include "../support/folders.hpp"
#include "../support/glb_reader.hpp"
#include "../support/messages.hpp"
#include "../support/other_bodies.hpp"

namespace vrma_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

TEST_CASE("every body becomes an animation of VRM's humanoid, its limbs as they were") {
  const Motion walk = procedural_motion(0, {.seconds = 1}).motion;
  const Retargeter to_mixamo(walk, [] {
    Motion body;
    body.skeleton = mixamo();
    return body;
  }());
  for (const Motion& motion : {walk, to_mixamo(walk), along_x(walk)}) {
    const Glb glb(vrma_file("walk", motion));
    CHECK(glb.json["extensionsUsed"][0] == "VRMC_vrm_animation");
    const auto& extension = glb.json["extensions"]["VRMC_vrm_animation"];
    CHECK(extension["specVersion"] == "1.0");
    const auto& bones = extension["humanoid"]["humanBones"];
    for (const char* name :  // those that the specification requires
         {"hips", "spine", "head", "leftUpperArm", "leftLowerArm", "leftHand", "rightUpperArm",
          "rightLowerArm", "rightHand", "leftUpperLeg", "leftLowerLeg", "leftFoot", "rightUpperLeg",
          "rightLowerLeg", "rightFoot"})
      CHECK_MESSAGE(bones.contains(name), name);
    std::set<std::size_t> nodes;
    for (const auto& [name, bone] : bones.items()) {
      CHECK(glb.json["nodes"][bone["node"].get<std::size_t>()]["name"] == name);
      nodes.insert(bone["node"].get<std::size_t>());
    }
    CHECK(nodes.size() == bones.size());
    CHECK(glb.json["animations"].size() == 1);
    for (const auto& channel : glb.json["animations"][0]["channels"])  // only the hips may move
      CHECK((channel["target"]["path"] == "rotation" || channel["target"]["node"] == bones["hips"]["node"]));
    const std::vector<Vec3> source = joint_positions(walk);
    const BodyParts body = find_body(walk.skeleton);
    for (const std::size_t f : {0u, 10u, 20u}) {
      const std::vector<Vec3> places = glb.places(0, f);
      const auto bone = [&](const char* from, const char* to) {
        const Vec3 v = subtract(places[bones[to]["node"].get<std::size_t>()],
                                places[bones[from]["node"].get<std::size_t>()]);
        return scale(v, 1 / length(v));
      };
      const auto was = [&](BodyPart from, BodyPart to) {
        const std::size_t at = f * walk.skeleton.size();
        const Vec3 v = subtract(source[at + joint_of(body, to)], source[at + joint_of(body, from)]);
        return scale(v, 1 / length(v));
      };
      CHECK(length(subtract(bone("leftUpperArm", "leftLowerArm"),
                            was(BodyPart::left_arm, BodyPart::left_forearm))) < 1e-5);
      CHECK(length(subtract(bone("rightLowerLeg", "rightFoot"),
                            was(BodyPart::right_shin, BodyPart::right_foot))) < 1e-5);
    }
  }
}

TEST_CASE("files are written; what is no body is refused") {
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path);
  Motion walk = procedural_motion(0, {.seconds = 1}).motion;
  write_vrma(scratch.path / "walk.vrma", "walk", walk);
  CHECK(std::filesystem::file_size(scratch.path / "walk.vrma") > 1000);
  for (Joint& joint : walk.skeleton.joints) {
    joint.name = "x" + joint.name.substr(0, 1);
    joint.offset = {length(joint.offset), 0, 0};
  }
  CHECK(
      says(message_of([&] { vrma_file("walk", walk); }), "neither joint names nor the rest pose say which"));
  walk.frames = 0;
  CHECK(says(message_of([&] { vrma_file("walk", walk); }), "has no frames"));
}

}  // namespace vrma_test
