// PositionFormat: classes, bones, and the map from normalised poses to bone vectors.
#include "motiongan/data/position_format.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "motiongan/procedural/procedural.hpp"

namespace position_format_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// The format of a procedural walk, with a joint of zero length added below the head.
PositionFormat walking_format(std::vector<Vec3>& positions) {
  Motion motion = procedural_motion(0).motion;
  Joint tip;
  tip.name = "Crown";
  tip.parent = motion.skeleton.find("Head");
  const std::size_t at = static_cast<std::size_t>(tip.parent) + 1;
  const std::vector<Vec3> old = joint_positions(motion);
  const std::size_t joints = motion.skeleton.size();
  positions.clear();
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (std::size_t j = 0; j <= joints; ++j) positions.push_back(old[f * joints + (j < at ? j : j - 1)]);
  Skeleton s = motion.skeleton;
  for (Joint& j : s.joints)
    if (j.parent >= static_cast<int>(at)) ++j.parent;
  s.joints.insert(s.joints.begin() + static_cast<std::ptrdiff_t>(at), tip);
  PositionFormat format;
  format.layout = PositionLayout(s, true);
  format.normalizer = Normalizer::fit(format.layout.encode(positions), format.layout.dof());
  format.classes = {"dance", "run", "walk"};
  return format;
}

}  // namespace

TEST_CASE("positions round-trip through normalised poses") {
  std::vector<Vec3> positions;
  const PositionFormat format = walking_format(positions);
  format.check();
  CHECK(format.dof() == format.layout.dof() - 3);  // the root's own position
  const std::vector<float> poses = format.encode(positions);
  RootTrack track = format.layout.places(positions)[0];
  track.started = false;
  const std::vector<Vec3> decoded = format.decode(poses, &track);
  const std::vector<Vec3> restored = format.restore(poses, format.layout.places(positions));
  REQUIRE(decoded.size() == positions.size());
  double worst = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    worst = std::max(
        {worst, length(subtract(decoded[i], positions[i])), length(subtract(restored[i], positions[i]))});
  CHECK(worst < 1e-3);  // centimetres; the poses are floats
}

TEST_CASE("bones, and their vectors as a linear map of the normalised pose") {
  std::vector<Vec3> positions;
  const PositionFormat format = walking_format(positions);
  const std::vector<Bone> bones = format.bones();
  const std::size_t joints = format.skeleton().size();
  CHECK(bones.size() == joints - 2);  // neither the root nor the joint of zero length
  const auto crown = static_cast<std::size_t>(format.skeleton().find("Crown"));
  double sum = 0;
  for (const Bone& bone : bones) {
    CHECK(bone.joint != crown);
    CHECK(format.skeleton().joints[bone.joint].parent == static_cast<int>(bone.parent));
    sum += length(format.skeleton().joints[bone.joint].offset);
  }
  CHECK(format.mean_bone_length() == doctest::Approx(sum / static_cast<double>(bones.size())));

  const std::vector<double> map = format.bone_map(), shift = format.bone_shift();
  REQUIRE(map.size() == 3 * bones.size() * format.dof());
  REQUIRE(shift.size() == 3 * bones.size());
  const std::vector<double> poses = format.layout.encode(positions);
  const std::vector<double> normalised = format.normalizer.normalize<double>(poses);
  const std::size_t frame = 11;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    Vec3 bone{};
    for (std::size_t a = 0; a < 3; ++a) {
      bone[a] = shift[3 * b + a];
      for (std::size_t k = 0; k < format.dof(); ++k)
        bone[a] += map[(3 * b + a) * format.dof() + k] * normalised[frame * format.dof() + k];
      const double* const pose = &poses[frame * format.layout.dof()];
      // Dimensions below the normalizer's smallest deviation are replaced by their mean.
      CHECK(std::abs(bone[a] - (pose[3 * bones[b].joint + a] - pose[3 * bones[b].parent + a])) < 1e-3);
    }
    const Vec3 world =
        subtract(positions[frame * joints + bones[b].joint], positions[frame * joints + bones[b].parent]);
    CHECK(length(bone) == doctest::Approx(length(world)).epsilon(1e-4));
  }
}

TEST_CASE("the error for an unknown class lists the classes") {
  std::vector<Vec3> positions;
  const PositionFormat format = walking_format(positions);
  CHECK(format.class_index("run") == 1);
  CHECK_THROWS_WITH_AS((void)format.class_index("wlak"),
                       "there is no class 'wlak'; did you mean 'walk'? The classes are: 'dance', 'run', "
                       "'walk'",
                       Error);
  CHECK_THROWS_WITH_AS((void)format.class_index("somersault"),
                       "there is no class 'somersault'. The classes are: 'dance', 'run', 'walk'", Error);
}

TEST_CASE("inconsistent members are errors") {
  std::vector<Vec3> positions;
  const PositionFormat good = walking_format(positions);
  const auto broken = [&](auto change, const char* message) {
    PositionFormat f = good;
    change(f);
    CHECK_THROWS_WITH_AS(f.check(), doctest::Contains(message), Error);
  };
  broken([](PositionFormat& f) { f.classes.clear(); }, "no classes");
  broken([](PositionFormat& f) { f.classes.push_back("run"); }, "two classes are called 'run'");
  broken([](PositionFormat& f) { f.classes[0].clear(); }, "empty");
  broken([](PositionFormat& f) { f.rate = 0; }, "rate");
  broken([](PositionFormat& f) { f.frames = 0; }, "0 frames");
  broken([](PositionFormat& f) { f.frames = std::size_t{1} << 40; },
         "windows of 1099511627776 frames, expected 1 to 65536");
  broken([](PositionFormat& f) { f.classes.resize(70000, "x"); },
         "has 70000 classes, expected at most 65536");
  broken([](PositionFormat& f) { f.layout = PositionLayout(f.skeleton(), false); }, "normalizer");
  broken([](PositionFormat& f) { f.layout = {}; }, "skeleton");
}

}  // namespace position_format_test
