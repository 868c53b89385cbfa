// GLB files, read back by a reader of the test's own.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <motiongan/formats/glb.hpp>
#include <motiongan/motion/motion.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/folders.hpp"
#include "../support/glb_reader.hpp"
#include "../support/messages.hpp"

namespace glb_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

Motion walk() { return procedural_motion(0, {.seconds = 1, .rate = 30}).motion; }

}  // namespace

TEST_CASE("joints are where they are in the motion, in metres") {
  Motion turned = walk();
  for (Quat& q : turned.rotations) q = {-q.w, -q.x, -q.y, -q.z};  // the same rotations
  const std::vector<NamedMotion> motions{{"walk", walk()}, {"again", turned}};
  for (const double unit : {0.0, 0.01}) {
    const Glb glb(glb_file(motions, {.unit_metres = unit}));
    const double metres = unit > 0 ? unit : typical_leg / body_unit(walk().skeleton);
    REQUIRE(glb.json["animations"].size() == 2);
    CHECK(glb.json["animations"][0]["name"] == "walk");
    const std::size_t joints = walk().skeleton.size();
    CHECK(glb.json["nodes"].size() == joints + 2);  // both share a skeleton, beside the top and the body
    for (const std::size_t a : {0u, 1u})
      for (std::size_t f = 0; f < walk().frames; f += 7) {
        const std::vector<Vec3> is = glb.places(a, f), was = joint_positions(walk());
        for (std::size_t j = 0; j < joints; ++j) {
          CHECK(glb.json["nodes"][j + 1]["name"] == walk().skeleton.joints[j].name);
          CHECK(length(subtract(is[j + 1], scale(was[f * joints + j], metres))) < 1e-5);
        }
      }
  }
}

TEST_CASE("the rules of the format: bounds, unit quaternions, increasing times, short ways") {
  const Glb glb(glb_file(std::vector<NamedMotion>{{"walk", walk()}}));
  for (std::size_t i = 0; i < glb.json["accessors"].size(); ++i) {
    const auto& a = glb.json["accessors"][i];
    if (!a.contains("min")) continue;
    const std::vector<float> v = glb.values<float>(i);
    const std::size_t width = glb.width(i);
    for (std::size_t c = 0; c < width; ++c) {
      float least = std::numeric_limits<float>::max(), most = -least;
      for (std::size_t k = c; k < v.size(); k += width)
        least = std::min(least, v[k]), most = std::max(most, v[k]);
      CHECK(a["min"][c].get<float>() == least);
      CHECK(a["max"][c].get<float>() == most);
    }
  }
  const auto& animation = glb.json["animations"][0];
  for (const auto& channel : animation["channels"]) {
    const auto& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
    REQUIRE(glb.json["accessors"][sampler["input"].get<std::size_t>()].contains("max"));
    const std::vector<float> times = glb.values<float>(sampler["input"]);
    for (std::size_t k = 1; k < times.size(); ++k) CHECK(times[k] > times[k - 1]);
    if (channel["target"]["path"] != "rotation") continue;
    const std::vector<float> q = glb.values<float>(sampler["output"]);
    CHECK(q.size() == 4 * times.size());
    for (std::size_t k = 0; k < q.size(); k += 4) {
      CHECK(std::abs(std::hypot(std::hypot(q[k], q[k + 1]), std::hypot(q[k + 2], q[k + 3])) - 1) < 1e-6);
      if (k > 0) CHECK(q[k] * q[k - 4] + q[k + 1] * q[k - 3] + q[k + 2] * q[k - 2] + q[k + 3] * q[k - 1] > 0);
    }
  }
}

TEST_CASE("the body: closed capsules, skinned to the joints that they lie at") {
  const Glb glb(glb_file(std::vector<NamedMotion>{{"walk", walk()}}));
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  const std::vector<float> places = glb.values<float>(primitive["attributes"]["POSITION"]),
                           normals = glb.values<float>(primitive["attributes"]["NORMAL"]);
  const auto joints = glb.values<std::uint16_t>(primitive["attributes"]["JOINTS_0"]);
  const auto triangles = glb.values<std::uint32_t>(primitive["indices"]);
  const auto& skin = glb.json["skins"][0];
  REQUIRE(skin["joints"].size() == walk().skeleton.size());
  const std::vector<float> matrices = glb.values<float>(skin["inverseBindMatrices"]);
  CHECK(matrices.size() == 16 * walk().skeleton.size());
  double volume = 0;
  const auto at = [&](std::uint32_t v) { return Vec3{places[3 * v], places[3 * v + 1], places[3 * v + 2]}; };
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    REQUIRE(triangles[t] < places.size() / 3);
    volume += dot(at(triangles[t]), cross(at(triangles[t + 1]), at(triangles[t + 2]))) / 6;
  }
  CHECK(volume > 0.005);  // faces point outwards: some litres
  CHECK(volume < 0.1);
  for (std::size_t v = 0; v < normals.size(); v += 3)
    CHECK(std::abs(std::hypot(normals[v], normals[v + 1], normals[v + 2]) - 1) < 1e-6);
  for (std::size_t v = 0; v < joints.size(); v += 4) {
    CHECK(joints[v] < walk().skeleton.size());
    // In the joint's frame a vertex lies no further than a bone away.
    const std::size_t m = 16 * joints[v];
    const Vec3 local =
        add(at(static_cast<std::uint32_t>(v / 4)), {matrices[m + 12], matrices[m + 13], matrices[m + 14]});
    CHECK(length(local) < 0.6);
  }
  const Glb bare(glb_file(std::vector<NamedMotion>{{"walk", walk()}}, {.body = false}));
  CHECK(!bare.json.contains("meshes"));
}

TEST_CASE("other skeletons have nodes of their own; what cannot be written is refused") {
  Motion other = walk();
  other.skeleton.joints[3].offset[1] *= 1.5;
  const Glb glb(glb_file(std::vector<NamedMotion>{{"a", walk()}, {"b", other}}));
  CHECK(glb.json["scenes"][0]["nodes"].size() == 2);
  CHECK(glb.json["skins"].size() == 2);
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path);
  write_glb(scratch.path / "one.glb", std::vector<NamedMotion>{{"a", walk()}});
  CHECK(std::filesystem::file_size(scratch.path / "one.glb") > 1000);
  const auto refused = [](const std::vector<NamedMotion>& motions, const char* why) {
    CHECK(says(message_of([&] { glb_file(motions); }), why));
  };
  refused({}, "no motions");
  refused({{"empty", slice(walk(), 0, 0)}}, "'empty' has no frames");
  Motion broken = walk();
  broken.positions[5][1] = std::nan("");
  refused({{"broken", broken}}, "not a finite number");
}

}  // namespace glb_test
