// Cleaning up a motion in pieces: beside the clean-up of the whole motion.
#include <doctest/doctest.h>

#include <motiongan/metrics/motion_quality.hpp>
#include <motiongan/motion/clean_stream.hpp>
#include <motiongan/procedural/procedural.hpp>
#include <random>

#include "../support/messages.hpp"

namespace clean_stream_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

/// A march that drifts to the side and trembles: no foot stands.
Motion sliding(double seconds, double rate = 25) {
  Motion motion = procedural_motion(11, {.seconds = seconds, .rate = rate}).motion;
  const double leg = leg_length(motion.skeleton);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.01 * leg);
  for (std::size_t f = 0; f < motion.frames; ++f) {
    motion.position(f, 0)[0] += 0.55 * leg * static_cast<double>(f) / motion.rate;
    for (double& v : motion.position(f, 0)) v += normal(random);
  }
  return motion;
}

/// The motion, pushed `piece` frames at a time.
Motion streamed(const Motion& motion, std::size_t piece, const CleanOptions& options = {}) {
  CleanStream stream(options);
  Motion out = slice(motion, 0, 0);
  for (std::size_t f = 0; f < motion.frames; f += piece)
    out = join(std::move(out), stream.push(slice(motion, f, std::min(piece, motion.frames - f))));
  return join(std::move(out), stream.finish());
}

void check_same(const Motion& a, const Motion& b) {
  REQUIRE(a.frames == b.frames);
  CHECK(a.positions == b.positions);
  for (std::size_t i = 0; i < a.rotations.size(); ++i) {
    const Quat &p = a.rotations[i], &q = b.rotations[i];
    REQUIRE((p.w == q.w && p.x == q.x && p.y == q.y && p.z == q.z));
  }
}

}  // namespace

TEST_CASE("what comes out does not depend on the pieces, and comes at most 1.5 seconds late") {
  const Motion motion = sliding(6);
  const Motion by_one = streamed(motion, 1);
  REQUIRE(by_one.frames == motion.frames);
  for (const std::size_t piece : {2u, 7u, 40u, 150u}) check_same(streamed(motion, piece), by_one);
  CleanStream stream;
  std::size_t out = 0;
  for (std::size_t f = 0; f < motion.frames; ++f) {
    out += stream.push(slice(motion, f, 1)).frames;
    CHECK(f + 1 - out <= static_cast<std::size_t>(1.5 * motion.rate));
  }
}

TEST_CASE("a motion no longer than the delay is cleaned up as a whole") {
  const Motion motion = sliding(1.5);
  for (const std::size_t frames : {1u, 2u, 3u, 20u, 36u})
    check_same(streamed(slice(motion, 0, frames), 5), clean(slice(motion, 0, frames)));
}

TEST_CASE("feet stand and nothing trembles, as after the clean-up of the whole motion") {
  const Motion motion = sliding(12), whole = clean(motion), pieces = streamed(motion, 1);
  REQUIRE(foot_skate(motion).ratio() > 0.5);
  CHECK(foot_skate(pieces).ratio() < foot_skate(whole).ratio() + 0.05);
  CHECK(mean_jerk(pieces) < 1.2 * mean_jerk(whole));
  CHECK(mean_jerk(pieces) < 0.2 * mean_jerk(motion));
  // No step from one half second to the next: no joint moves much faster than in the whole motion.
  const auto fastest = [](const Motion& m) {
    const std::vector<Vec3> places = joint_positions(m);
    double most = 0;
    for (std::size_t i = m.skeleton.size(); i < places.size(); ++i)
      most = std::max(most, length(subtract(places[i], places[i - m.skeleton.size()])));
    return most;
  };
  CHECK(fastest(pieces) < 1.2 * fastest(whole));
}

TEST_CASE("given frames stay as they are, however long they are") {
  const Motion motion = sliding(6);
  for (const std::size_t given : {10u, 60u}) {
    const Motion out = streamed(motion, 3, {.given = given});
    for (std::size_t f = 0; f < given; ++f)
      for (std::size_t j = 0; j < motion.skeleton.size(); ++j)
        REQUIRE(out.position(f, j) == motion.position(f, j));
    CHECK(out.position(given + 20, 0) != motion.position(given + 20, 0));
  }
}

TEST_CASE("a stream begins anew after its end, and refuses what does not fit") {
  const Motion motion = sliding(3);
  CleanStream stream;
  CHECK(stream.finish().frames == 0);
  const auto run = [&] {
    Motion out = stream.push(motion);
    return join(std::move(out), stream.finish());
  };
  const Motion first = run();
  check_same(run(), first);
  stream.push(slice(motion, 0, 10));
  CHECK(says(message_of([&] { stream.push(resample(motion, 50)); }), "joints at 50"));
  CHECK(says(message_of([] { CleanStream wrong({.cutoff = -1}); }), "cutoff -1"));
}

}  // namespace clean_stream_test
