// Cleaning up a motion: filtering, standing feet, floating bodies, and the bending of legs.
#include <doctest/doctest.h>

#include <motiongan/metrics/motion_quality.hpp>
#include <motiongan/motion/clean.hpp>
#include <motiongan/motion/motion.hpp>
#include <motiongan/procedural/procedural.hpp>
#include <random>

#include "../support/messages.hpp"

namespace clean_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

/// Clip number `i` of the built-in motion: 0 walks, 9 stands, 11 marches.
Motion built_in(std::size_t i, double rate = 30) {
  return procedural_motion(i, {.seconds = 4, .rate = rate}).motion;
}

Motion trembling(Motion motion, double size) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, size);
  for (std::size_t f = 0; f < motion.frames; ++f)
    for (double& v : motion.position(f, 0)) v += normal(random);
  return motion;
}

double leg_of(const Motion& motion) { return leg_length(motion.skeleton); }

std::vector<Vec3> places_of(const Motion& motion, std::size_t joint) {
  std::vector<Vec3> out;
  for (std::size_t f = 0; f < motion.frames; ++f) out.push_back(world_joint(motion, f, joint).position);
  return out;
}

double lowest_foot(const Motion& motion, std::size_t frame) {
  double lowest = 1e9;
  for (const Leg& leg : find_legs(motion.skeleton))
    lowest = std::min(lowest, world_joint(motion, frame, leg.foot).position[1]);
  return lowest;
}

}  // namespace

TEST_CASE("a leg is found by its bones, and bends so that its foot reaches a place") {
  const Motion still = built_in(9);
  const std::vector<Leg> legs = find_legs(still.skeleton);
  REQUIRE(legs.size() == 2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const Leg& leg : legs) {
    CHECK(still.skeleton.joints[leg.knee].parent == static_cast<int>(leg.thigh));
    CHECK(still.skeleton.joints[leg.ankle].parent == static_cast<int>(leg.knee));
    const double full =
        length(still.skeleton.joints[leg.knee].offset) + length(still.skeleton.joints[leg.ankle].offset);
    for (int i = 0; i < 50; ++i) {
      Motion motion = slice(still, 0, 1);
      const WorldJoint hip = world_joint(motion, 0, leg.thigh), foot = world_joint(motion, 0, leg.foot),
                       ankle = world_joint(motion, 0, leg.ankle);
      const Vec3 target =
          add(ankle.position, scale({uniform(random), uniform(random), uniform(random)}, 0.4 * full));
      const double distance = length(subtract(target, hip.position));
      reach(motion, 0, leg, target);
      const WorldJoint now = world_joint(motion, 0, leg.ankle);
      if (distance > 0.1 * full && distance < most_stretch * full)
        CHECK(length(subtract(now.position, target)) < 1e-9 * full);
      const double before = length(subtract(ankle.position, hip.position));
      CHECK(length(subtract(now.position, hip.position)) <= std::max(before, most_stretch * full) + 1e-9);
      CHECK(angle_between(now.rotation, ankle.rotation) < 1e-6);
      CHECK(world_joint(motion, 0, leg.thigh).position == hip.position);
      CHECK(length(subtract(subtract(world_joint(motion, 0, leg.foot).position, now.position),
                            subtract(foot.position, ankle.position))) < 1e-9 * full);
    }
  }
}

TEST_CASE("the low-pass keeps what is slow or steady, takes away what is fast, and delays nothing") {
  constexpr double rate = 30, cutoff = 3;
  const std::vector<double> kernel = gaussian_kernel(cutoff, rate);
  const auto gain = [&](double hertz) {  // of a cosine with its peak at frame 60
    const auto wave = [&](std::size_t i) {
      return std::cos(2 * pi * hertz * (static_cast<double>(i) - 60) / rate);
    };
    return filtered(kernel, 121, 60, wave);
  };
  CHECK(gain(0) == doctest::Approx(1));
  CHECK(gain(0.3) > 0.99);
  CHECK(gain(cutoff) == doctest::Approx(std::sqrt(0.5)).epsilon(0.01));
  CHECK(gain(12) < 0.01);
  for (const std::size_t at : {0u, 1u, 7u, 20u})  // also at the ends
    CHECK(filtered(kernel, 21, at, [](std::size_t i) { return 3.0 + 2 * static_cast<double>(i); }) ==
          doctest::Approx(3.0 + 2 * static_cast<double>(at)));
  const Motion walk = built_in(0), rough = trembling(walk, 0.02 * leg_of(walk)), smooth = low_pass(rough, 3);
  CHECK(mean_jerk(rough) > 5 * mean_jerk(walk));
  CHECK(mean_jerk(smooth) < 0.2 * mean_jerk(rough));
  CHECK(says(message_of([&] { low_pass(walk, 0); }), "a low-pass of 0 Hz"));
}

TEST_CASE("feet that stand are held where they are, and slide no more") {
  Motion walk = built_in(11, 25);                // marching: feet are high between two stands
  for (std::size_t f = 0; f < walk.frames; ++f)  // sideways, so that no foot can stand
    walk.position(f, 0)[0] += 0.55 * leg_of(walk) * static_cast<double>(f) / walk.rate;
  const FootSkate before = foot_skate(walk);
  REQUIRE(before.ratio() > 0.8);
  const Motion held = clean(walk, {.smooth = false});
  CHECK(foot_skate(held).ratio() < 0.15);
  CHECK(held.frames == walk.frames);
  std::size_t contacts = 0;
  const double metre = leg_of(walk);
  for (const Leg& leg : find_legs(walk.skeleton)) {
    const std::vector<Vec3> was = places_of(walk, leg.foot), is = places_of(held, leg.foot);
    std::vector<double> heights;
    for (const Vec3& p : was) heights.push_back(p[1]);
    for (const FootContact& c : foot_contacts(is, walk.rate, percentile(heights, 0.05), metre)) {
      if (c.last - c.first < 8) continue;
      ++contacts;
      const std::size_t middle = (c.first + c.last) / 2;
      CHECK(length(subtract(is[middle], is[middle + 1])) < 0.01 * metre);
    }
  }
  CHECK(contacts > 3);
  for (std::size_t f = 0; f < walk.frames; ++f)
    for (std::size_t j = 1; j < walk.skeleton.size(); ++j)
      REQUIRE(held.position(f, j) == walk.position(f, j));
}

TEST_CASE("a foot that leaves slowly at first stands only until it leaves") {
  const auto contact = [](double slide) {  // metres per frame, at 12.5 per second
    std::vector<Vec3> places;
    double x = 0;
    for (const double more : {0., 0., 0., 0., 0., 0., 0.06, 0.08, 0.1, 0.25, 0.3})
      places.push_back({x += more + slide, 0.01, 0});
    const std::vector<FootContact> found = foot_contacts(places, 12.5, 0, 1);
    REQUIRE(found.size() == 1);
    CHECK(found[0].first == 0);
    return found[0].last;
  };
  CHECK(contact(0) == 5);
  // One that slides all the time is held for longer: then its speed does not say that it leaves.
  CHECK(contact(0.06) == 6);
}

TEST_CASE("a body that floats comes down; a jump stays a jump; feet do not sink") {
  const Motion stand = built_in(9);
  const double metre = leg_of(stand), floor = lowest_foot(stand, 0);
  const auto raised = [&](double from, double until, double by) {
    Motion motion = stand;
    for (std::size_t f = 0; f < motion.frames; ++f) {
      const double t = static_cast<double>(f) / motion.rate;
      if (t >= from && t < until)
        motion.position(f, 0)[1] += by * metre * std::sin(pi * (t - from) / (until - from));
    }
    return motion;
  };
  const Motion floating = clean(raised(0.5, 3.5, 0.3), {.smooth = false});
  CHECK(lowest_foot(floating, 60) - floor < 0.08 * metre);
  const Motion jump = clean(raised(1.8, 2.2, 0.3), {.smooth = false});
  CHECK(lowest_foot(jump, 60) - floor > 0.25 * metre);
  const Motion sunk = clean(raised(0.5, 3.5, -0.2), {.smooth = false, .floor = floor});
  for (std::size_t f = 0; f < sunk.frames; ++f) REQUIRE(lowest_foot(sunk, f) - floor > -0.05 * metre);
}

TEST_CASE("given frames stay as they are") {
  const Motion rough = trembling(built_in(0), 0.02 * 1.0);
  const Motion cleaned = clean(rough, {.given = 20});
  for (std::size_t f = 0; f < 20; ++f)
    for (std::size_t j = 0; j < rough.skeleton.size(); ++j) {
      REQUIRE(angle_between(cleaned.rotation(f, j), rough.rotation(f, j)) < 1e-7);
      REQUIRE(cleaned.position(f, j) == rough.position(f, j));
    }
  CHECK(cleaned.position(40, 0) != rough.position(40, 0));
}

TEST_CASE("short motions, bodies without legs and senseless options") {
  const Motion walk = built_in(0);
  for (const std::size_t frames : {0u, 1u, 2u, 3u, 4u}) CHECK(clean(slice(walk, 0, frames)).frames == frames);
  Motion stick;
  stick.skeleton.joints.resize(2);
  stick.skeleton.joints[0].name = "Root";
  stick.skeleton.joints[1].name = "Tip";
  stick.skeleton.joints[1].parent = 0;
  stick.skeleton.joints[1].offset = {0, 1, 0};
  stick.rate = 30, stick.frames = 1;
  stick.rotations.resize(2), stick.positions = {{}, {0, 1, 0}};
  CHECK(says(message_of([&] { clean(stick); }), "name the feet"));
  CHECK(clean(stick, {.feet = false}).frames == 1);
  CHECK(says(message_of([&] { clean(stick, {.foot_joints = {"Tip"}}); }),
             "does not hang on a thigh and a shin"));
  CHECK(says(message_of([&] { clean(walk, {.cutoff = -1}); }), "cutoff -1"));
  CHECK(says(message_of([&] { clean(walk, {.touch_speed = 2, .leave_speed = 1}); }), "speeds 2 and 1"));
}

}  // namespace clean_test
