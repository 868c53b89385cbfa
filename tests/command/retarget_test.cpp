// motiongan retarget: clips on another skeleton, its map of joints, and what is refused.
#include <doctest/doctest.h>

#include "command.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"

#include "../support/other_bodies.hpp"

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
  Skeleton nameless = unreal();
  for (std::size_t j = 0; j < nameless.size(); ++j) nameless.joints[j].name = "Bone" + std::to_string(j);
  write_bvh("nameless.bvh", at_rest(nameless));
  refused("clips --to nameless.bvh --out x", "give a map of the joints");
  CHECK(!fs::exists("x"));
}
