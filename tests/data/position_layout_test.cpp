// Pose vectors of positions: heading from left and right joints, the root's track removed and restored.
#include "motiongan/data/position_layout.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace position_layout_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// Hips with a left and a right thigh and a spine, each 1 long.
Skeleton small_skeleton() {
  Skeleton s;
  s.joints = {{"Hips", -1, {}, {}, {}},
              {"LeftUpLeg", 0, {1, 0, 0}, {}, {}},
              {"RightUpLeg", 0, {-1, 0, 0}, {}, {}},
              {"Spine", 0, {0, 1, 0}, {}, {}}};
  return s;
}

/// The small skeleton at x, z, turned by `yaw`, hips at `height`.
void append_body(std::vector<Vec3>& out, double x, double height, double z, double yaw) {
  const Quat turn = axis_rotation(1, yaw);
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}})
    out.push_back(add(rotate(turn, p), {x, height, z}));
}

double worst_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, length(subtract(a[i], b[i])));
  return worst;
}

}  // namespace

TEST_CASE("mirrored joints are found by their names") {
  CHECK(are_mirrored("LeftFoot", "RightFoot"));
  CHECK(are_mirrored("mixamorig:LeftArm", "mixamorig:RightArm"));
  CHECK(are_mirrored("UpperLeg_L", "UpperLeg_R"));
  CHECK(are_mirrored("LHipJoint", "RHipJoint"));
  CHECK_FALSE(are_mirrored("RightFoot", "LeftFoot"));
  CHECK_FALSE(are_mirrored("LeftFoot", "RightHand"));
  CHECK_FALSE(are_mirrored("Spine", "Spine"));
}

TEST_CASE("joint pairs across the body") {
  CHECK(across_body(small_skeleton()) == std::vector<JointPair>{{1, 2}});

  SUBCASE("mirrored joints that coincide are replaced by those below them") {
    Skeleton s;
    s.joints = {{"Hips", -1, {}, {}, {}},
                {"LHipJoint", 0, {}, {}, {}},
                {"LeftUpLeg", 1, {1, -1, 0}, {}, {}},
                {"RHipJoint", 0, {}, {}, {}},
                {"RightUpLeg", 3, {-1, -1, 0}, {}, {}}};
    CHECK(across_body(s) == std::vector<JointPair>{{2, 4}});
  }
  SUBCASE("without sides in the names: the widest pair at the first branching") {
    Skeleton s;
    s.joints = {{"a", -1, {}, {}, {}},
                {"b", 0, {0, 5, 0}, {}, {}},
                {"c", 0, {0, 0, 2}, {}, {}},
                {"d", 0, {0, 0, -2}, {}, {}}};
    CHECK(across_body(s) == std::vector<JointPair>{{2, 3}});
  }
  SUBCASE("a chain has no such pair, and its yaw is 0") {
    Skeleton s;
    s.joints = {{"a", -1, {}, {}, {}}, {"b", 0, {0, 5, 0}, {}, {}}};
    CHECK(across_body(s).empty());
    const std::vector<Vec3> positions{{1, 2, 3}, {1, 2, 8}};
    CHECK(PositionLayout(s).places(positions)[0].yaw == 0);
  }
}

TEST_CASE("poses are relative to the root") {
  const PositionLayout layout(small_skeleton(), true);
  CHECK(layout.dof() == 16);
  CHECK(layout.track_dim() == 12);
  CHECK(layout.name(4) == "LeftUpLeg.y");
  CHECK(layout.name(12) == "Hips.step.x");
  CHECK(layout.name(13) == "Hips.step.z");
  CHECK(layout.name(14) == "Hips.height");
  CHECK(layout.name(15) == "Hips.turn");
  CHECK_THROWS_AS((void)layout.name(16), Error);

  // Faces +x (yaw 90 degrees), moves 2 along x, then 1 along z while turning by 0.25.
  std::vector<Vec3> positions;
  append_body(positions, 10, 3, 20, pi / 2);
  append_body(positions, 12, 4, 20, pi / 2);
  append_body(positions, 12, 5, 21, pi / 2 + 0.25);
  const std::vector<double> poses = layout.encode(positions);
  REQUIRE(poses.size() == 3 * 16);
  const std::vector<double> body{0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0};
  const std::vector<std::vector<double>> tracks{{0, 2, 3, 0}, {0, 2, 4, 0}, {-1, 0, 5, 0.25}};
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t d = 0; d < 12; ++d) CHECK(poses[16 * f + d] == doctest::Approx(body[d]).epsilon(1e-12));
    for (std::size_t d = 0; d < 4; ++d)
      CHECK(std::abs(poses[16 * f + 12 + d] - tracks[f][d]) < 1e-12);  // first frame like the second
  }
}

TEST_CASE("the yaw is unwrapped over whole turns and kept while undetermined") {
  const PositionLayout layout(small_skeleton());
  std::vector<Vec3> positions;
  for (int f = 0; f < 40; ++f) append_body(positions, 0, 0, 0, 0.3 * f);
  const std::vector<RootTrack> places = layout.places(positions);
  for (int f = 0; f < 40; ++f)
    CHECK(places[static_cast<std::size_t>(f)].yaw == doctest::Approx(0.3 * f).epsilon(1e-12));

  // Lying on the side: left vertically above right.
  std::vector<Vec3> lying;
  append_body(lying, 0, 0, 0, 0.7);
  lying.insert(lying.end(), {{0, 0, 0}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}});
  CHECK(layout.places(lying)[1].yaw == doctest::Approx(0.7));
  // At the start, the first determined yaw applies.
  std::rotate(lying.begin(), lying.begin() + 4, lying.end());
  CHECK(layout.places(lying)[0].yaw == doctest::Approx(0.7));
}

TEST_CASE("positions round-trip over their own places, over a track, and in pieces") {
  for (const std::size_t index : {0u, 3u, 7u, 12u}) {
    const Motion motion = procedural_motion(index).motion;
    const std::vector<Vec3> positions = joint_positions(motion);
    for (const bool track : {true, false}) {
      const PositionLayout layout(motion.skeleton, track);
      const std::vector<RootTrack> places = layout.places(positions);
      const std::vector<double> poses = layout.encode(positions);
      for (std::size_t f = 0; f < motion.frames; ++f)
        for (std::size_t d = 0; d < 3; ++d) REQUIRE(poses[f * layout.dof() + d] == 0);
      CHECK(worst_distance(layout.restore(poses, places), positions) < 1e-9);
    }
    const PositionLayout layout(motion.skeleton, true);
    const std::vector<double> poses = layout.encode(positions);
    RootTrack whole = layout.places(positions)[0];
    whole.started = false;
    const RootTrack start = whole;
    const std::vector<Vec3> decoded = layout.decode(poses, &whole);
    CHECK(worst_distance(decoded, positions) < 1e-9);
    const RootTrack end = layout.track_of(positions, motion.frames - 1);
    CHECK(whole.x == doctest::Approx(end.x));
    CHECK(whole.yaw == doctest::Approx(end.yaw));
    CHECK(whole.height == end.height);

    RootTrack pieces = start;
    const std::size_t cut = motion.frames / 3 * layout.dof();
    std::vector<Vec3> joined = layout.decode(std::span(poses).first(cut), &pieces);
    const std::vector<Vec3> rest = layout.decode(std::span(poses).subspan(cut), &pieces);
    joined.insert(joined.end(), rest.begin(), rest.end());
    CHECK(joined == decoded);

    // A continuation starts where the prior ends.
    RootTrack on = layout.track_of(positions, motion.frames / 3 - 1);
    CHECK(worst_distance(
              layout.decode(std::span(poses).subspan(cut), &on),
              {positions.begin() + static_cast<std::ptrdiff_t>(motion.frames / 3 * motion.skeleton.size()),
               positions.end()}) < 1e-9);
  }
}

TEST_CASE("position and heading do not change the pose") {
  const Motion motion = procedural_motion(0).motion;
  const std::vector<Vec3> positions = joint_positions(motion);
  std::vector<Vec3> moved;
  for (const Vec3& p : positions) moved.push_back(add(rotate(axis_rotation(1, 2.2), p), {100, 0, -40}));
  const PositionLayout layout(motion.skeleton, true);
  const std::vector<double> a = layout.encode(positions), b = layout.encode(moved);
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  CHECK(worst < 1e-9);
}

TEST_CASE("without root track the body stays at the track's position") {
  const PositionLayout layout(small_skeleton(), false);
  CHECK(layout.dof() == 12);
  CHECK_THROWS_AS((void)layout.track_dim(), Error);
  std::vector<Vec3> positions;
  append_body(positions, 10, 3, 20, 0.4);
  append_body(positions, 11, 4, 25, 0.9);
  const std::vector<double> poses = layout.encode(positions);
  RootTrack at{1, 2, 0.4, true, 7};
  const std::vector<Vec3> out = layout.decode(poses, &at);
  std::vector<Vec3> expected;
  append_body(expected, 1, 7, 2, 0.4);
  append_body(expected, 1, 7, 2, 0.4);
  CHECK(worst_distance(out, expected) < 1e-12);
  CHECK(at.x == 1);
  CHECK(at.height == 7);
}

TEST_CASE("invalid positions are errors") {
  const PositionLayout layout(small_skeleton());
  std::vector<Vec3> positions(5);
  CHECK_THROWS_WITH_AS((void)layout.encode(positions), doctest::Contains("found 5 positions"), Error);
  CHECK_THROWS_AS((void)layout.decode(std::vector<double>(17)), Error);
  CHECK_THROWS_AS((void)layout.restore(std::vector<double>(16), {}), Error);
  CHECK_THROWS_AS(PositionLayout(Skeleton{}), Error);
  positions.resize(4);
  positions[3][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS((void)layout.encode(positions), doctest::Contains("'Spine'"), Error);
  CHECK_THROWS_AS((void)layout.track_of(std::vector<Vec3>(4), 1), Error);
  CHECK(layout.encode({}).empty());
}

}  // namespace position_layout_test
