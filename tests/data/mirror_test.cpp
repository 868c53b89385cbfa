// Mirrored poses and captions, and data sets with them.
#include "motiongan/data/mirror.hpp"

#include <doctest/doctest.h>

#include <map>
#include <set>

#include "../support/walking_clips.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace mirror_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("every joint of the mirrored motion is at the image of its counterpart") {
  for (const RootRotation form :
       {RootRotation::expmap, RootRotation::heading, RootRotation::velocity, RootRotation::support})
    for (const bool sideways : {false, true}) {  // a body whose sides lie apart along z
      CAPTURE(static_cast<int>(form));
      CAPTURE(sideways);
      Motion m = curved_walk_on_legs(0.4, {0, 1, 0}, 60);
      if (sideways)
        for (Joint& joint : m.skeleton.joints)
          joint.offset = {joint.offset[2], joint.offset[1], joint.offset[0]};
      for (std::size_t f = 0; f < m.frames; ++f)
        for (std::size_t j = 1; j < m.skeleton.size(); ++j) m.position(f, j) = m.skeleton.joints[j].offset;
      const PoseLayout layout(m.skeleton, true, 0, form);
      const PoseMirror mirror(layout);
      const std::vector<double> poses = layout.encode(m);
      CHECK(mirror(mirror(poses)) == poses);
      RootTrack from = layout.track_of(m, 0), to = from;
      const std::size_t across = sideways ? 2 : 0;
      to.yaw = -from.yaw;
      from.started = to.started = false;
      const std::vector<Vec3> was = joint_positions(layout.decode(poses, m.frames, m.rate, &from)),
                              is = joint_positions(layout.decode(mirror(poses), m.frames, m.rate, &to));
      const std::size_t counterpart[] = {0, 1, 4, 5, 2, 3};
      for (std::size_t f = 0; f < m.frames; ++f)
        for (std::size_t j = 0; j < 6; ++j) {
          Vec3 image = was[6 * f + counterpart[j]];
          image[across] = -image[across];
          CHECK(length(subtract(is[6 * f + j], image)) < 1e-9);
        }
    }
}

TEST_CASE("captions: left and right are exchanged, other words stay") {
  CHECK(mirrored_caption("Kick with the left foot, turn RIGHT") == "Kick with the right foot, turn left");
  CHECK(mirrored_caption("left-handed, leftwards; upright") == "right-handed, rightwards; upright");
  CHECK(mirrored_caption("turn clockwise") == "turn counterclockwise");
  CHECK(mirrored_caption("anticlockwise") == "clockwise");
  CHECK(mirrored_caption("marche à gauche").substr(0, 6) == "marche");
  CHECK(mirrored_caption("").empty());
}

TEST_CASE("a skeleton whose sides do not match is refused") {
  Skeleton s = curved_walk_on_legs(0, {}, 1).skeleton;
  s.joints[5].name = "RightToe";
  CHECK_THROWS_WITH_AS(PoseMirror(PoseLayout(s)), doctest::Contains("'LeftFoot' has no counterpart"), Error);
  s.joints[5].name = "RightFoot";
  s.joints[5].offset = {0, -0.2, 0.1};
  CHECK_THROWS_WITH_AS(PoseMirror(PoseLayout(s)), doctest::Contains("'RightFoot' is not the image"), Error);
}

TEST_CASE("a data set with mirrored and stretched training clips") {
  const std::vector<LabelledMotion> motions =
      procedural_motions({.clips = 6, .seconds = 4, .rate = 10, .seed = 3});
  DatasetOptions options{.frames = 8, .rate = 10, .root_rotation = RootRotation::support};
  const Dataset plain = Dataset::from_motions(motions, options);
  options.mirror = true;
  options.stretch = 0.1;
  const Dataset more = Dataset::from_motions(motions, options);
  CHECK(more.train.size() == 6 * plain.train.size());
  CHECK(more.test.size() == plain.test.size());
  std::map<std::string, const DatasetClip*> by_id;
  for (const DatasetClip& clip : more.train) by_id.emplace(clip.id, &clip);
  const PoseMirror mirror(more.format.layout);
  for (const DatasetClip& clip : plain.train) {
    const DatasetClip& image = *by_id.at(clip.id + " mirrored");
    CHECK(image.derived);
    CHECK(!by_id.at(clip.id)->derived);
    CHECK(image.captions.front() == mirrored_caption(clip.captions.front()));
    const auto poses_of = [&](const DatasetClip& of) {
      return more.format.normalizer.denormalize(std::span<const float>(of.poses));
    };
    const std::vector<double> mirrored = poses_of(image), expected = mirror(poses_of(*by_id.at(clip.id)));
    for (std::size_t i = 0; i < expected.size(); ++i) CHECK(std::abs(mirrored[i] - expected[i]) < 1e-3);
    const DatasetClip &slow = *by_id.at(clip.id + " slower"), &fast = *by_id.at(clip.id + " faster");
    CHECK(slow.frames == doctest::Approx(static_cast<double>(clip.frames) / 0.9).epsilon(0.05));
    CHECK(fast.frames == doctest::Approx(static_cast<double>(clip.frames) / 1.1).epsilon(0.05));
    CHECK(by_id.count(clip.id + " faster mirrored") == 1);
  }
  for (const double stretch : {-0.1, 0.6}) {
    options.stretch = stretch;
    CHECK_THROWS_WITH_AS(Dataset::from_motions(motions, options), doctest::Contains("stretch"), Error);
  }
}

}  // namespace mirror_test
