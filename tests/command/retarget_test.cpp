// motiongan retarget: clips on another skeleton, its map of joints, and what is refused.
#include <doctest/doctest.h>

#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/glb_character.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"

#include "../support/other_bodies.hpp"

namespace retarget_test {

using namespace motiongan::motion;
using namespace motiongan::testing;

TEST_CASE("clips are put on another skeleton; the map can be written, edited and given") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 3 --seconds 2").status == 0);
  write_bvh("unreal.bvh", at_rest(unreal()));
  const Said said =
      call("retarget clips --to unreal.bvh --out made --save-map map.tsv --html page.html --clean feet");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("left upper arm   LeftArm                upperarm_l"));
  CHECK(said.has("lengths times 0.99"));
  CHECK(said.has("wrote 3 clips to made"));
  CHECK(fs::exists("page.html"));
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator("made")) {
    const Clip clip = read_bvh(entry.path());
    CHECK(clip.skeleton.find("upperarm_twist_01_l") >= 0);
    CHECK(clip.frames > 30);
    ++files;
  }
  CHECK(files == 3);
  REQUIRE(call("retarget clips --to unreal.bvh --out ends --end-sites").status == 0);
  const Skeleton ends = read_bvh(fs::directory_iterator("ends")->path()).skeleton;
  CHECK(ends.joints[static_cast<std::size_t>(ends.find("head"))].end_site.has_value());
  // A map that leaves the head out.
  std::string map = bytes_of("map.tsv");
  const auto at = map.find("head\thead\tHead\n");
  REQUIRE(at != std::string::npos);
  std::ofstream("edited.tsv") << map.erase(at, std::string("head\thead\tHead\n").size());
  const Said other = call("retarget clips --to unreal.bvh --out other --map edited.tsv");
  CHECK_MESSAGE(other.status == 0, other.text);
  CHECK(other.has("head             -                      -"));

  const auto refused = [](const std::string& arguments, const std::string& why) {
    const Said no = call("retarget " + arguments);
    CHECK(no.status == 1);
    CHECK_MESSAGE(no.has(why), no.text);
  };
  refused("clips --to none.bvh --out x", "none.bvh does not exist");
  refused("clips --to unreal.bvh --out clips", "is an input");
  refused("clips --to unreal.bvh --out x --map none.tsv", "none.tsv");
  write_bvh("nameless.bvh", at_rest(without_names(unreal())));
  CHECK(call("retarget clips --to nameless.bvh --out nameless")
            .has("left upper arm   LeftArm                Bone"));
  Skeleton lying = without_names(unreal());
  for (Joint& joint : lying.joints) joint.offset = {length(joint.offset), 0, 0};
  write_bvh("lying.bvh", at_rest(lying));
  refused("clips --to lying.bvh --out x", "give a map of the joints");
  CHECK(!fs::exists("x"));
}

TEST_CASE("GLB files are skeletons to put clips on, and clips to be put on others") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 2 --seconds 2").status == 0);
  write_glb("moves.glb",
            std::vector<NamedMotion>{{"stand", at_rest(mixamo())}, {"stand still", at_rest(mixamo())}});
  const Said said = call("retarget clips --to moves.glb --format glb --out made");
  CHECK_MESSAGE(said.status == 0, said.text);
  CHECK(said.has("mixamorig:LeftArm"));
  std::vector<fs::path> made(fs::directory_iterator("made"), {});
  std::sort(made.begin(), made.end());
  REQUIRE(made.size() == 2);
  const GlbCharacter character(made.front());
  CHECK(character.motion().frames > 30);
  CHECK(character.motion().skeleton.find("mixamorig:LeftArm") >= 0);
  // The character's body is in the file, as it was.
  CHECK(bytes_of(made.front()).find("skeleton body") != std::string::npos);
  // The same motion as BVH.
  REQUIRE(call("retarget clips --to moves.glb --out bvh").status == 0);
  const Motion same = to_motion(read_bvh("bvh" / made.front().filename().replace_extension(".bvh")));
  const std::vector<Vec3> a = joint_positions(same), b = joint_positions(character.motion());
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); i += 13) CHECK(length(subtract(a[i], b[i])) < 1e-4);
  // As clips: all animations, or one of them.
  const Said back = call("retarget made moves.glb --to bvh/" +
                         made.front().filename().replace_extension(".bvh").string() + " --out back");
  CHECK_MESSAGE(back.has("wrote 4 clips"), back.text);
  CHECK(fs::exists("back/moves_stand still.bvh"));
  CHECK(call("info 'moves.glb#stand'").has("moves.glb#stand: an animated skeleton"));
  CHECK(call("info 'moves.glb#run'").has("no animation 'run'"));
  CHECK(call("view moves.glb --glb moves.glb").has("moves.glb is an input"));
}

TEST_CASE("FBX files are written and read as the same motion") {
  const TestFolder folder;
  REQUIRE(call("synth clips --clips 1 --seconds 2").status == 0);
  write_bvh("unreal.bvh", at_rest(unreal()));
  const Said said = call("retarget clips --to unreal.bvh --format fbx --out fbx");
  if (said.has("built without Assimp")) {
    MESSAGE("skipped: the command is built without Assimp");
    CHECK(said.status == 1);
    CHECK(call("info x.fbx").status == 1);
    return;
  }
  CHECK_MESSAGE(said.status == 0, said.text);
  const Said back = call("retarget fbx --to fbx --format bvh --out x");
  CHECK(back.status == 1);
  REQUIRE(call("retarget clips --to unreal.bvh --out bvh").status == 0);
  const fs::path name = fs::directory_iterator("fbx")->path().filename();
  const Said again = call("retarget fbx --to fbx/" + name.string() + " --out again");
  CHECK_MESSAGE(again.status == 0, again.text);
  const fs::path bvh = fs::path(name).replace_extension(".bvh");
  const Motion was = to_motion(read_bvh("bvh" / bvh)), is = to_motion(read_bvh("again" / bvh));
  CHECK(is.frames == was.frames);
  CHECK(is.rate == doctest::Approx(was.rate));
  REQUIRE(is.skeleton.size() == was.skeleton.size());
  const std::vector<Vec3> a = joint_positions(was), b = joint_positions(is);
  const double scale = bone_lengths(is.skeleton)[2] / bone_lengths(was.skeleton)[2];
  double worst = 0;
  for (std::size_t f = 0; f < was.frames; ++f)
    for (std::size_t j = 0; j < was.skeleton.size(); ++j) {
      const int other = is.skeleton.find(was.skeleton.joints[j].name);
      REQUIRE(other >= 0);
      const std::size_t joints = was.skeleton.size();
      worst = std::max(worst, length(subtract(motiongan::motion::scale(a[f * joints + j], scale),
                                              b[f * joints + static_cast<std::size_t>(other)])));
    }
  CHECK(worst < 0.02);  // centimetres
  std::ofstream("bad.fbx") << "no FBX";
  CHECK(call("info bad.fbx").has("bad.fbx cannot be read as FBX"));
}

}  // namespace retarget_test
