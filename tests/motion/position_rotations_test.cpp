// Rotations from positions: rotations known by hand, round trips through forward kinematics and BVH, and
// what positions leave undetermined.
#include "motiongan/motion/position_rotations.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "../support/messages.hpp"
#include "motiongan/formats/bone_list.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/untwist.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace position_rotations_test {

using namespace motiongan;
using namespace motiongan::motion;
using motiongan::testing::message_of;
using motiongan::testing::says;
namespace fs = std::filesystem;

namespace {

PositionClip clip_of(const Motion& m) {
  PositionClip clip;
  clip.skeleton = m.skeleton;
  clip.rate = m.rate;
  clip.frames = m.frames;
  clip.positions = joint_positions(m);
  return clip;
}

double mean_bone(const Skeleton& s) {
  double sum = 0, n = 0;
  for (const double l : bone_lengths(s)) {
    sum += l;
    n += l > 0;
  }
  return sum / n;
}

/// The largest distance between corresponding joints, in mean bone lengths.
double worst(const PositionClip& a, const Motion& b) {
  const std::vector<Vec3> positions = joint_positions(b);
  REQUIRE(positions.size() == a.positions.size());
  double out = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    out = std::max(out, length(subtract(positions[i], a.positions[i])));
  return out / mean_bone(a.skeleton);
}

Skeleton skeleton_of(const char* bones, const std::vector<Vec3>& offsets) {
  Skeleton s = parse_bone_list(bones, "bones");
  for (std::size_t j = 0; j < s.size(); ++j) s.joints[j].offset = offsets.at(j);
  return s;
}

PositionClip clip_of(const Skeleton& s, const std::vector<Vec3>& positions) {
  PositionClip clip;
  clip.skeleton = s;
  clip.rate = 30;
  clip.frames = positions.size() / s.size();
  clip.positions = positions;
  return clip;
}

/// Pseudo-random numbers in -1..1, always the same.
struct Noise {
  std::uint32_t state = 12345;
  double operator()() {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / (1 << 23) - 1;
  }
};

}  // namespace

TEST_CASE("a single bone takes the shortest rotation") {
  const Skeleton s = skeleton_of("A\t-\nB\tA\nC\tB\n", {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}});
  // B is seen along y, C along z: 90 degrees about z, then, in the turned frame, 90 degrees about -y.
  const Motion m = motion_from_positions(clip_of(s, {{5, 6, 7}, {5, 8, 7}, {5, 8, 8}}));
  const double h = std::sqrt(0.5);
  CHECK(angle_between(m.rotation(0, 0), {h, 0, 0, h}) < 1e-12);
  CHECK(angle_between(m.rotation(0, 1), {h, 0, -h, 0}) < 1e-12);
  CHECK(m.rotation(0, 2) == Quat{});
  CHECK(m.position(0, 0) == Vec3{5, 6, 7});
  CHECK(m.position(0, 1) == Vec3{2, 0, 0});
}

TEST_CASE("at half a turn the previous rotation decides, and no value is NaN") {
  for (const double tiny : {0.0, 1e-9, -1e-7, 1e-5}) {
    const Vec3 seen = scale({-1, tiny, 0}, 1 / std::hypot(1.0, tiny));
    const Quat about_y{0, 0, 1, 0};
    const Quat q = shortest_rotation({1, 0, 0}, seen, about_y);
    CHECK(length(subtract(rotate(q, {1, 0, 0}), seen)) < 1e-10);
    if (std::abs(tiny) < 1e-6) CHECK(angle_between(q, about_y) < 1e-5);
  }
  const Skeleton s = skeleton_of("A\t-\nB\tA\nC\tA\nD\tC\n", {{0, 0, 0}, {2, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  // Frame 0 turns about y by nearly half a turn; in frame 1 it is half a turn; in frame 2 B coincides with A.
  const Motion m = motion_from_positions(clip_of(s, {{0, 0, 0},
                                                     {-2, 0, 1e-3},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {-2, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0},
                                                     {0, 0, 0}}));
  CHECK(angle_between(m.rotation(0, 0), m.rotation(1, 0)) < 1e-3);
  CHECK(angle_between(m.rotation(1, 0), m.rotation(2, 0)) == doctest::Approx(0));
  for (const Quat& q : m.rotations) CHECK(dot(q, q) == doctest::Approx(1));
}

TEST_CASE("a bone that is never near its rest direction rotates without jumps") {
  // The bone rests along x and swings around -x, where the shortest rotation from x has no steady axis.
  const Skeleton s = skeleton_of("A\t-\nB\tA\n", {{0, 0, 0}, {2, 0, 0}});
  std::vector<Vec3> positions;
  for (int f = 0; f < 60; ++f) {
    const double y = 0.3 * std::sin(0.4 * f), z = 0.05 * std::cos(0.3 * f);
    positions.push_back({0, 0, 0});
    positions.push_back(scale({-1, y, z}, 2 / std::hypot(1.0, y, z)));
  }
  const PositionClip clip = clip_of(s, positions);
  const Motion m = motion_from_positions(clip);
  CHECK(worst(clip, m) < 1e-9);
  double turn = 0;
  for (std::size_t f = 1; f < m.frames; ++f)
    turn = std::max(turn, angle_between(m.rotation(f - 1, 0), m.rotation(f, 0)));
  CHECK(turn < 0.2);  // the bone itself rotates by up to 0.12 per frame

  // With that pose as reference, the pose itself is reproduced, including twist.
  const std::vector<Quat> reference{quat_from_expmap({0.4, 2, -1}), {}};
  Motion given;
  given.skeleton = s;
  given.rate = 30;
  given.frames = 1;
  given.rotations = reference;
  given.positions = {{0, 0, 0}, {2, 0, 0}};
  CHECK(angle_between(motion_from_positions(clip_of(given), reference).rotation(0, 0), reference[0]) < 1e-9);
  const Motion twisted = motion_from_positions(clip, reference);
  CHECK(worst(clip, twisted) < 1e-9);
  CHECK(says(message_of([&] { motion_from_positions(clip, std::vector<Quat>(3)); }),
             "has 3 rotations, expected"));
}

TEST_CASE("below a resting root, a joint with position channels keeps its position") {
  Skeleton s = skeleton_of("Handle\t-\nHips\tHandle\nLeft\tHips\nRight\tHips\n",
                           {{0, 0, 0}, {0, 9, 0}, {1, 0, 0}, {-1, 1, 0}});
  for (std::size_t j = 0; j < 2; ++j)
    s.joints[j].channels = {Channel::x_position, Channel::y_position, Channel::z_position,
                            Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
  const PositionClip clip = clip_of(
      s, {{0, 0, 0}, {0, 10, 0}, {1, 10, 0}, {-1, 11, 0}, {1, 0, 2}, {5, 8, 0}, {5, 9, 0}, {4, 7, 0}});
  const Motion m = motion_from_positions(clip);
  CHECK(worst(clip, m) < 1e-9);
  CHECK(m.rotation(1, 0) == Quat{});  // root to hips is no bone
  CHECK(m.position(1, 1) == Vec3{4, 8, -2});
}

TEST_CASE("several bones give the rotation exactly, or the best fit") {
  Noise noise;
  double error = 0, spoiled = 0;
  for (int i = 0; i < 200; ++i) {
    const Quat q = quat_from_expmap({3 * noise(), 3 * noise(), 3 * noise()});
    std::vector<DirectionPair> pairs;
    for (int k = 0; k < 2 + i % 4; ++k) {
      const Vec3 v{noise(), noise(), noise()};
      const Vec3 u = scale(v, 1 / length(v));
      pairs.push_back({u, rotate(q, u), 1 + noise() / 2});
    }
    const Quat found = best_rotation(pairs, {});
    for (const DirectionPair& p : pairs)
      error = std::max(error, length(subtract(rotate(found, p.rest), p.seen)));

    // With perturbed directions, no nearby rotation may fit better.
    const auto misfit = [&](const Quat& r) {
      double sum = 0;
      for (const DirectionPair& p : pairs) {
        const Vec3 d = subtract(rotate(r, p.rest), p.seen);
        sum += p.weight * dot(d, d);
      }
      return sum;
    };
    for (DirectionPair& p : pairs) {
      const Vec3 v = add(p.seen, {0.3 * noise(), 0.3 * noise(), 0.3 * noise()});
      p.seen = scale(v, 1 / length(v));
    }
    const Quat best = best_rotation(pairs, {});
    for (int k = 0; k < 6; ++k) {
      Vec3 turn{};
      turn[static_cast<std::size_t>(k) % 3] = k < 3 ? 1e-3 : -1e-3;
      spoiled = std::max(spoiled, misfit(best) - misfit(multiply(quat_from_expmap(turn), best)));
    }
  }
  CHECK(error < 1e-8);
  CHECK(spoiled < 1e-9);
  // All collinear: the twist is that of the previous frame.
  const Quat before = quat_from_expmap({0.8, 0, 0});
  const std::vector<DirectionPair> line{{{1, 0, 0}, {1, 0, 0}, 1}, {{-1, 0, 0}, {-1, 0, 0}, 2}};
  CHECK(angle_between(best_rotation(line, before), before) < 1e-4);
}

TEST_CASE("forward kinematics of the rotations reproduces the positions") {
  ProceduralOptions options;
  options.clips = procedural_actions().size();
  options.seconds = 3;
  for (const LabelledMotion& l : procedural_motions(options)) {
    CAPTURE(l.id);
    const PositionClip clip = clip_of(l.motion);
    const Motion m = motion_from_positions(clip);
    CHECK(worst(clip, m) < 1e-6);
    CHECK(m.skeleton == clip.skeleton);  // including channels
    // The hips and the chest have several bones, so their rotations are exact.
    for (std::size_t f = 0; f < m.frames; ++f)
      REQUIRE(angle_between(m.rotation(f, procedural::hips), l.motion.rotation(f, procedural::hips)) < 1e-6);
    for (std::size_t f = 1; f < m.frames; ++f)
      for (std::size_t j = 0; j < m.skeleton.size(); ++j)
        REQUIRE(dot(m.rotation(f, j), m.rotation(f - 1, j)) >= 0);
  }
}

TEST_CASE("without twists the joints are where they were, and what they do not tell is gone") {
  const Motion made = procedural_motion(0, {.seconds = 1}).motion;
  Motion turned = made;
  for (std::size_t f = 0; f < made.frames; ++f)
    turned.rotation(f, procedural::head) =
        multiply(made.rotation(f, procedural::head), axis_rotation(1, 0.7));
  const Motion plain = untwisted(turned);
  CHECK(worst(clip_of(turned), plain) < 1e-6);
  CHECK(plain.rotations == untwisted(made).rotations);
  CHECK(plain.rotations != turned.rotations);
  const Motion again = untwisted(plain);
  for (std::size_t i = 0; i < plain.rotations.size(); ++i)
    REQUIRE(angle_between(again.rotations[i], plain.rotations[i]) < 1e-5);
}

TEST_CASE("joints of zero offset rotate their bones") {
  // As in the CMU files: the hips have no bone of their own, nor has the chest; both hips and the back do.
  const Skeleton s = skeleton_of(
      "Hips\t-"
      "\nLHip\tHips\nLKnee\tLHip\nRHip\tHips\nRKnee\tRHip\nLowerBack\tHips\nSpine\tLowerBack\nHand\tSpine\n"
      "Finger\tHand\nThumb\tHand\nThumb2\tThumb\n",
      {{0, 0, 0},
       {0, 0, 0},
       {1, -2, 0},
       {0, 0, 0},
       {-1, -2, 0},
       {0, 0, 0},
       {0, 2, 0},
       {0, 3, 0.5},
       {1, 0, 0},
       {0, 0, 0},
       {0, 1, 0}});
  Noise noise;
  Motion m;
  m.skeleton = s;
  m.rate = 30;
  m.frames = 50;
  for (std::size_t i = 0; i < m.frames * s.size(); ++i) {
    m.rotations.push_back(quat_from_expmap({noise(), noise(), noise()}));
    m.positions.push_back(s.joints[i % s.size()].offset);
  }
  const PositionClip clip = clip_of(m);
  const Motion found = motion_from_positions(clip);
  CHECK(worst(clip, found) < 1e-6);
  // Where the joints of zero offset do not turn, the hips are found as they were; so is the hand, whose own
  // bone leaves the twist open, which the thumb then tells.
  for (std::size_t f = 0; f < m.frames; ++f)
    for (const std::size_t j : {1, 3, 5, 9}) m.rotation(f, j) = {};
  const Motion stiff = motion_from_positions(clip_of(m));
  CHECK(worst(clip_of(m), stiff) < 1e-6);
  const std::vector<Quat> a = joint_rotations(stiff), b = joint_rotations(m);
  double hips = 0, hand = 0;
  for (std::size_t f = 0; f < m.frames; ++f) {
    hips = std::max(hips, angle_between(stiff.rotation(f, 0), m.rotation(f, 0)));
    hand = std::max(hand, angle_between(a[f * s.size() + 7], b[f * s.size() + 7]));
  }
  CHECK(hips < 1e-6);
  CHECK(hand < 1e-6);
}

TEST_CASE("wrong bone lengths: the directions are kept, the lengths are the skeleton's") {
  const LabelledMotion l = procedural_motion(0, {.seconds = 2});
  PositionClip clip = clip_of(l.motion);
  const std::size_t joints = clip.skeleton.size();
  std::vector<Vec3> stretched = clip.positions;
  for (std::size_t i = 0; i < stretched.size(); ++i) {
    const int parent = clip.skeleton.joints[i % joints].parent;
    if (parent < 0) continue;
    const std::size_t p = i - i % joints + static_cast<std::size_t>(parent);
    const double by = 1 + 0.3 * std::sin(static_cast<double>(i));
    stretched[i] = add(stretched[p], scale(subtract(clip.positions[i], clip.positions[p]), by));
  }
  PositionClip wrong = clip;
  wrong.positions = stretched;
  const Motion m = motion_from_positions(wrong);
  CHECK(worst(clip, m) < 1e-6);  // the motion before stretching
  CHECK(bone_lengths(m.skeleton) == bone_lengths(clip.skeleton));
}

TEST_CASE("a skeleton from a bone list can be written as BVH") {
  const LabelledMotion l = procedural_motion(3, {.seconds = 1});
  PositionClip clip = clip_of(l.motion);
  for (Joint& j : clip.skeleton.joints) {  // as from a position file
    j.channels.clear();
    j.end_site.reset();
  }
  clip.skeleton = with_offsets_of(clip.skeleton, clip.positions);
  const Motion m = motion_from_positions(clip);
  CHECK(m.skeleton.joints[0].channels.size() == 6);
  CHECK(m.skeleton.joints[4].channels ==
        std::vector<Channel>{Channel::z_rotation, Channel::x_rotation, Channel::y_rotation});
  CHECK(angle_between(m.rotation(0, 0), {}) < 1e-6);  // the rest pose is the first frame
  const fs::path file = fs::temp_directory_path() / "motiongan_position_rotations.bvh";
  write_bvh(file, m);
  CHECK(worst(clip, to_motion(read_bvh(file))) < 1e-5);
  fs::remove(file);

  Skeleton hinge = procedural_skeleton();
  hinge.joints[0].channels = {Channel::y_position};
  hinge.joints[1].channels = {Channel::x_rotation};
  hinge.joints[4].channels.clear();
  const Skeleton free = with_bvh_channels(hinge);
  CHECK(free.joints[0].channels.size() == 6);
  CHECK(free.joints[1].channels.size() == 3);
  CHECK(free.joints[2].channels == hinge.joints[2].channels);
  CHECK(free.joints[4].channels.empty());  // toes have no bone to rotate
}

TEST_CASE("joints in any order are sorted for BVH") {
  const PositionClip clip = clip_of(
      skeleton_of("A\t-\nB\tA\nC\tA\nD\tB\nE\tC\n", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}}),
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}, {1, 1, 0}});
  const PositionClip sorted = depth_first(clip);
  std::string names;
  for (const Joint& j : sorted.skeleton.joints) names += j.name;
  CHECK(names == "ABDCE");
  CHECK(sorted.skeleton.joints[4].parent == 3);
  CHECK(sorted.positions[2] == Vec3{1, 0, 1});
  CHECK(sorted.positions[4] == Vec3{1, 1, 0});
  const Motion m = motion_from_positions(clip);
  CHECK(worst(sorted, m) < 1e-9);
  CHECK(says(format_hierarchy(m.skeleton), "JOINT E"));
  CHECK(depth_first(sorted).skeleton == sorted.skeleton);
}

TEST_CASE("invalid clips are rejected") {
  PositionClip clip = clip_of(skeleton_of("A\t-\nB\tA\n", {{0, 0, 0}, {1, 0, 0}}), {{0, 0, 0}, {1, 0, 0}});
  PositionClip bad = clip;
  bad.positions[1][2] = std::numeric_limits<double>::infinity();
  CHECK(says(message_of([&] { motion_from_positions(bad); }), "frame 0, joint 'B': found inf"));
  bad = clip;
  bad.frames = 2;
  CHECK(
      says(message_of([&] { motion_from_positions(bad); }), "has 2 positions, expected 2 frames x 2 joints"));
  bad = clip;
  bad.rate = 0;
  CHECK_THROWS_AS(motion_from_positions(bad), Error);
  bad = clip;
  bad.skeleton.joints[1].parent = 1;
  CHECK_THROWS_AS(motion_from_positions(bad), Error);
  clip.frames = 0;
  clip.positions.clear();
  CHECK(motion_from_positions(clip).frames == 0);
}

TEST_CASE("captured motion is reproduced, if available") {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const fs::path data = (set ? fs::path(set) : fs::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared") / "data";
  if (!fs::is_directory(data)) {
    MESSAGE("skipped: no data folder in " << data.string());
    return;
  }
  for (const char* name : {"cmu/02/02_01.bvh", "cmu/05/05_02.bvh", "bandai-1/dataset-1_walk_happy_001.bvh"}) {
    if (!fs::exists(data / name)) continue;
    CAPTURE(name);
    const Motion whole = to_motion(read_bvh(data / name));
    const Motion m = slice(whole, 0, std::min<std::size_t>(whole.frames, 300));
    const PositionClip clip = clip_of(fold_into_root(m, moving_root(whole)));
    CHECK(worst(clip, motion_from_positions(clip)) < 1e-6);
  }
}

}  // namespace position_rotations_test
