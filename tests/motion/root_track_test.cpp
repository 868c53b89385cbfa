// Poses with steps and turns: round trips, decoding in pieces, windows, and placement at the prior.
#include "motiongan/motion/root_track.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "../support/walking_clips.hpp"
#include "motiongan/data/dataset.hpp"

namespace root_track_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

constexpr RootRotation velocity = RootRotation::velocity;

/// Largest difference between two motions of one root joint 0: positions, and angles in radians.
struct Difference {
  double position = 0, angle = 0;
};
Difference difference(const Motion& a, const Motion& b) {
  REQUIRE(a.positions.size() == b.positions.size());
  Difference d;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    d.position = std::max(d.position, length(subtract(a.positions[i], b.positions[i])));
    d.angle = std::max(d.angle, angle_between(a.rotations[i], b.rotations[i]));
  }
  return d;
}

Motion every(const Motion& motion, std::size_t start, std::size_t stride, std::size_t count) {
  Motion out = slice(motion, start, 0);
  out.rate = motion.rate / static_cast<double>(stride);
  for (std::size_t i = 0; i < count; ++i, ++out.frames) {
    const Motion one = slice(motion, start + i * stride, 1);
    out.rotations.insert(out.rotations.end(), one.rotations.begin(), one.rotations.end());
    out.positions.insert(out.positions.end(), one.positions.begin(), one.positions.end());
  }
  return out;
}

std::vector<LabelledMotion> curves() {
  return {{"a", curved_walk_on_legs(0, {}, 60), {"walk"}},
          {"b", curved_walk_on_legs(2.5, {5, 0, -3}, 50), {"walk"}},
          {"c", curved_walk_on_legs(-1, {100, 2, 7}, 45), {"walk"}}};
}

}  // namespace

TEST_CASE("steps and turns: names and values") {
  const Motion m = curved_walk(0.4, {3, 1, -2}, 100);
  const PoseLayout layout(m.skeleton, true, 0, velocity);
  CHECK(layout.name(0) == "Hips.x");
  CHECK(layout.name(1) == "Hips.turn");
  CHECK(layout.name(6) == "Hips.step.x");
  CHECK(layout.name(7) == "Hips.position.y");
  CHECK(layout.name(8) == "Hips.step.z");
  const std::vector<double> poses = layout.encode(m);
  for (std::size_t f = 0; f < m.frames; ++f) {
    const double* pose = &poses[f * layout.dof()];
    CHECK(pose[1] == doctest::Approx(0.09).epsilon(1e-12));
    // The walk steps 0.1 along the heading of the frame it leaves: straight ahead, which is +z.
    CHECK(std::abs(pose[6]) < 1e-12);
    CHECK(pose[8] == doctest::Approx(0.1).epsilon(1e-12));
    CHECK(pose[7] == m.position(f, 0)[1]);
  }
  const std::vector<double> one = layout.encode(slice(m, 0, 1));
  CHECK((one[1] == 0 && one[6] == 0 && one[8] == 0));
  CHECK(one[7] == 1);
  CHECK_THROWS_WITH_AS(layout.encode(m, 0), doctest::Contains("step of 0 frames"), Error);
}

TEST_CASE("a long walk survives encoding and decoding, from where it started") {
  const Motion m = curved_walk(0.4, {3, 1, -2}, 3000);  // 43 turns
  const PoseLayout layout(m.skeleton, true, 0, velocity);
  const std::vector<double> poses = layout.encode(m);
  RootTrack start = layout.track_of(m, 0);
  CHECK((start.started && start.x == 3 && start.z == -2));
  start.started = false;
  const Difference there = difference(layout.decode(poses, m.frames, m.rate, &start), m);
  CHECK(there.position < 1e-9);
  CHECK(there.angle < 1e-7);
  // The track is now at the last frame; a continuation from a given motion's track starts there.
  const RootTrack last = layout.track_of(m, m.frames - 1);
  CHECK(std::abs(start.x - last.x) < 1e-9);
  CHECK(std::abs(start.z - last.z) < 1e-9);
  CHECK(std::abs(std::remainder(start.yaw - last.yaw, 2 * pi)) < 1e-9);
  RootTrack middle = layout.track_of(m, 499);
  const std::span<const double> rest = std::span(poses).subspan(500 * layout.dof());
  const Difference onward = difference(layout.decode(rest, 2500, 10, &middle), slice(m, 500, 2500));
  CHECK(onward.position < 1e-9);
  CHECK(onward.angle < 1e-7);
  CHECK_THROWS_WITH_AS(layout.track_of(m, 3000), doctest::Contains("frame 3000 of a motion of 3000"), Error);

  // Without root position, only turns.
  const PoseLayout turning(m.skeleton, false, 0, velocity);
  CHECK(turning.dof() == 6);
  RootTrack facing{0, 0, 0.4, false};
  const Motion spun = turning.decode(turning.encode(m), m.frames, m.rate, &facing);
  for (std::size_t f = 0; f < m.frames; ++f)
    CHECK(angle_between(spun.rotation(f, 0), m.rotation(f, 0)) < 1e-7);
  CHECK(spun.position(2999, 0) == Vec3{});
}

TEST_CASE("the support's height and steps are encoded, and decoded back") {
  const Motion m = curved_walk_on_legs(0.4, {3, 1, -2}, 300);
  const PoseLayout layout(m.skeleton, true, 0, RootRotation::support);
  const std::size_t at = layout.position_dim();
  CHECK(layout.name(at) == "Hips.support.x");
  CHECK(layout.name(at + 1) == "Hips.support.y");
  const std::vector<double> poses = layout.encode(m);
  const std::vector<Vec3> world = joint_positions(m);
  const std::size_t joints = m.skeleton.size();
  std::size_t clear = 0;
  for (std::size_t f = 1; f < m.frames; ++f) {
    const double* const place = &poses[f * layout.dof() + at];
    const auto mean_height = [&](std::size_t j) {
      return (world[f * joints + j][1] + world[(f - 1) * joints + j][1]) / 2;
    };
    // Where one foot is clearly lower than the other it bears nearly all.
    if (std::abs(mean_height(3) - mean_height(5)) < 6 * layout.softness()) continue;
    ++clear;
    const std::size_t foot = mean_height(3) < mean_height(5) ? 3 : 5;
    const Vec3 step = subtract(world[f * joints + foot], world[(f - 1) * joints + foot]);
    CHECK(std::abs(std::hypot(place[0], place[2]) - std::hypot(step[0], step[2])) < 0.005);
    double low = 1e9;
    for (std::size_t j = 0; j < joints; ++j) low = std::min(low, world[f * joints + j][1]);
    CHECK(place[1] >= low);
    CHECK(place[1] - low < layout.softness());
  }
  CHECK(clear > 20);
  for (const PoseLayout& form : {layout, layout.with_floor(0.05)}) {
    const std::vector<double> encoded = form.encode(m);
    RootTrack start = form.track_of(m, 0);
    start.started = false;
    const Difference there = difference(form.decode(encoded, m.frames, m.rate, &start), m);
    CHECK(there.position < 1e-9);
    CHECK(there.angle < 1e-7);
    RootTrack middle = form.track_of(m, 99);
    const std::span<const double> rest = std::span(encoded).subspan(100 * form.dof());
    CHECK(difference(form.decode(rest, 200, 10, &middle), slice(m, 100, 200)).position < 1e-9);
    RootTrack followed = form.track_of(m, 0);
    for (std::size_t f = 1; f < m.frames; ++f)
      form.follow(std::span(encoded).subspan(f * form.dof(), form.dof()), followed);
    CHECK(std::abs(followed.x - m.position(m.frames - 1, 0)[0]) < 1e-9);
  }
}

TEST_CASE("an error of a leg's rotation moves the body, not the feet that stand") {
  const Motion m = curved_walk_on_legs(0, {}, 80);
  const PoseLayout layout(m.skeleton, true, 0, RootRotation::support);
  std::vector<double> poses = layout.encode(m);
  for (std::size_t f = 0; f < m.frames; ++f) {
    double* const pose = &poses[f * layout.dof()];
    pose[3 * 2] += 0.1 * std::sin(5.0 * static_cast<double>(f));  // the left leg trembles
    for (std::size_t d = 0; d < 3; ++d) pose[layout.position_dim() + d] = 0;
  }
  const Motion made = layout.decode(poses, m.frames, m.rate);
  const std::vector<Vec3> world = joint_positions(made);
  const std::size_t joints = m.skeleton.size();
  double moved = 0;
  for (std::size_t f = 1; f < m.frames; ++f) {
    std::vector<double> heights, now;
    Vec3 step{};
    for (std::size_t j = 0; j < joints; ++j) {
      const Vec3 &a = world[(f - 1) * joints + j], &b = world[f * joints + j];
      heights.push_back((a[1] - made.position(f - 1, 0)[1] + b[1] - made.position(f, 0)[1]) / 2);
      now.push_back(b[1]);
    }
    const std::vector<double> weights = support_weights(heights, layout.softness()),
                              bearing = support_weights(now, layout.softness());
    double height = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      step = add(step, scale(subtract(world[f * joints + j], world[(f - 1) * joints + j]), weights[j]));
      height += bearing[j] * now[j];
    }
    CHECK(std::abs(height) < 1e-12);
    CHECK(std::hypot(step[0], step[2]) < 1e-12);
    moved = std::max(moved, length(subtract(made.position(f, 0), made.position(f - 1, 0))));
  }
  CHECK(moved > 0.05);
}

TEST_CASE("a motion decoded in pieces is the one decoded at once, bit for bit") {
  const Motion m = curved_walk_on_legs(0.4, {3, 1, -2}, 500);
  for (const RootRotation form : {velocity, RootRotation::support, RootRotation::heading}) {
    const PoseLayout layout(m.skeleton, true, 0, form);
    const std::vector<double> poses = layout.encode(m);
    const Motion whole = layout.decode(poses, m.frames, m.rate);
    for (const std::size_t piece : {1, 7, 64}) {
      RootTrack track;
      Motion joined = slice(whole, 0, 0);
      for (std::size_t f = 0; f < m.frames; f += piece) {
        const std::size_t count = std::min(piece, m.frames - f);
        const Motion part = layout.decode(std::span(poses).subspan(f * layout.dof(), count * layout.dof()),
                                          count, 10, &track);
        joined.rotations.insert(joined.rotations.end(), part.rotations.begin(), part.rotations.end());
        joined.positions.insert(joined.positions.end(), part.positions.begin(), part.positions.end());
      }
      CHECK(joined.rotations == whole.rotations);
      CHECK(joined.positions == whole.positions);
      CHECK(track.started ==
            (form != RootRotation::heading));  // the other representation leaves it unchanged
    }
  }
}

TEST_CASE("differences over a stride: every stride-th pose is the pose of every stride-th frame") {
  const Motion m = curved_walk(1, {3, 1, -2}, 90);
  const PoseLayout layout(m.skeleton, true, 0, velocity);
  const std::vector<double> poses = layout.encode(m, 5);
  for (const std::size_t start : {0, 3, 17}) {
    const std::vector<double> alone = layout.encode(every(m, start, 5, 12));
    for (std::size_t i = start < 5 ? 1 : 0; i < 12; ++i)  // the very first has no predecessor
      for (std::size_t d = 0; d < layout.dof(); ++d) {
        if (i == 0 && (d == 1 || d == 6 || d == 8)) continue;  // a single frame has none either
        CHECK(std::abs(poses[(start + 5 * i) * layout.dof() + d] - alone[i * layout.dof() + d]) < 1e-12);
      }
  }
  for (std::size_t f = 0; f < 5; ++f)
    for (const std::size_t d : {1, 6, 8}) CHECK(poses[f * layout.dof() + d] == poses[5 * layout.dof() + d]);
  const std::vector<double> brief = layout.encode(slice(m, 0, 5), 5);
  for (std::size_t f = 0; f < 5; ++f)
    for (const std::size_t d : {1, 6, 8}) CHECK(brief[f * layout.dof() + d] == 0);
}

TEST_CASE("a data set with steps: windows, statistics, and conversion back to motion") {
  const std::vector<LabelledMotion> motions = curves();
  const Dataset data =
      Dataset::from_motions(motions, {.frames = 8, .rate = 5, .root_rotation = velocity, .train_share = 1});
  CHECK(data.stride == 2);
  CHECK(data.format.relative_dims.empty());
  CHECK(!data.format.turning());
  const std::vector<double>&mean = data.format.normalizer.mean(), &std = data.format.normalizer.std();
  CHECK(mean[1] == doctest::Approx(0.18));  // two frames of 0.09
  const std::size_t place = data.format.layout.position_dim();
  CHECK(mean[place + 2] > 0.19);
  CHECK(std[place] == std[place + 2]);
  const std::size_t dof = data.format.dof();
  std::vector<float> window(8 * dof);
  for (const DatasetClip& clip : data.train) {
    const Motion& source = motions[static_cast<std::size_t>(clip.id[0] - 'a')].motion;
    for (const std::size_t start : {0, 3, 20}) {
      data.window(clip, start, window);
      RootTrack track = data.format.layout.track_of(source, start);
      track.started = false;
      const Difference d = difference(data.format.to_motion(window, &track), every(source, start, 2, 8));
      CHECK(d.position < 1e-5);
      CHECK(d.angle < 1e-5);
    }
  }
}

TEST_CASE("the training range contains every training window, tightly") {
  for (const RootRotation form :
       {RootRotation::expmap, RootRotation::heading, velocity, RootRotation::support}) {
    const Dataset data =
        Dataset::from_motions(curves(), {.frames = 8, .rate = 5, .root_rotation = form, .train_share = 0.67});
    const MotionFormat& format = data.format;
    const std::size_t dof = format.dof();
    REQUIRE(format.low.size() == dof);
    std::vector<double> low(dof, 1e9), high(dof, -1e9);
    std::vector<float> window(8 * dof);
    for (const DatasetClip& clip : data.train)
      for (std::size_t s = 0; s < data.starts(clip); ++s) {
        data.window(clip, s, window);
        for (std::size_t i = 0; i < window.size(); ++i) {
          low[i % dof] = std::min(low[i % dof], double(window[i]));
          high[i % dof] = std::max(high[i % dof], double(window[i]));
        }
      }
    CHECK(format.low == low);
    CHECK(format.high == high);
  }
}

TEST_CASE("a prior is encoded as a window and placed back") {
  const std::vector<LabelledMotion> motions = curves();
  for (const RootRotation form :
       {RootRotation::expmap, RootRotation::heading, velocity, RootRotation::support}) {
    const Dataset data =
        Dataset::from_motions(motions, {.frames = 8, .rate = 10, .root_rotation = form, .train_share = 1});
    const MotionFormat& format = data.format;
    // As in the data set, except for the step that leads to its first frame. (An exponential map is
    // unwrapped from the start of a motion, so it is comparable only at the start of a clip.)
    const std::size_t start = form == RootRotation::expmap ? 0 : 11;
    const Motion prior = slice(motions[1].motion, start, 8);
    const std::vector<float> poses = format.encode_window(prior);
    std::vector<float> window(8 * format.dof());
    data.window(data.train[1], start, window);
    REQUIRE(poses.size() == window.size());
    for (std::size_t i = form >= velocity ? format.dof() : 0; i < poses.size(); ++i)
      CHECK(poses[i] == doctest::Approx(window[i]).epsilon(1e-4));
    // Of any length, anywhere.
    const Motion other = curved_walk_on_legs(-2, {-20, 1, 30}, 30);
    const Motion made = format.to_motion(format.encode_window(other));
    const Motion placed = format.place(made, other);
    const Difference d = difference(placed, other);
    CHECK(d.position < 1e-4);
    CHECK(d.angle < 1e-5);
    CHECK(difference(made, other).position > 1);
    CHECK(format.place(slice(made, 0, 0), other).frames == 0);

    Motion bad = other;
    bad.rate = 12;
    CHECK_THROWS_WITH_AS(format.encode_window(bad), doctest::Contains("12 frames per second, expected 10"),
                         Error);
    bad.skeleton.joints[1].name = "Tail";
    CHECK_THROWS_WITH_AS(format.encode_window(bad), doctest::Contains("'Spine' is called 'Tail'"), Error);
    CHECK_THROWS_AS(format.place(made, slice(other, 0, 0)), Error);
  }
}

}  // namespace root_track_test
