// Channels to rotations and back, resampling, and slicing.
#include "motiongan/motion/motion.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace motion_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

Skeleton two_joints(std::vector<Channel> root, std::vector<Channel> child) {
  Skeleton s;
  s.joints = {{"Hips", -1, {0, 1, 0}, std::move(root), {}}, {"Arm", 0, {1, 0, 0}, std::move(child), {}}};
  return s;
}

/// Hips turn about z by `per_frame` radians a frame and move along x by 1 a frame.
Motion turning(std::size_t frames, double rate, double per_frame) {
  Motion m;
  m.skeleton = two_joints({Channel::x_position, Channel::y_position, Channel::z_position, Channel::z_rotation,
                           Channel::x_rotation, Channel::y_rotation},
                          {});
  m.rate = rate;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f);
    m.rotations.push_back(quat_from_expmap({0, 0, per_frame * t}));
    m.rotations.push_back({});
    m.positions.push_back({t, 2, 3});
    m.positions.push_back({1, 0, 0});
  }
  return m;
}

}  // namespace

TEST_CASE("channels in the joint's own order; positions replace components of the offset") {
  Clip clip;
  clip.skeleton =
      two_joints({Channel::y_rotation, Channel::z_position, Channel::x_rotation}, {Channel::y_position});
  clip.frame_time = 0.5;
  clip.frames = 1;
  clip.channels = {90, 7, 90, 4};
  const Motion m = to_motion(clip);
  CHECK(m.rate == 2);
  CHECK(m.position(0, 0) == Vec3{0, 1, 7});
  CHECK(m.position(0, 1) == Vec3{1, 4, 0});
  // R = Ry(90) Rx(90): y goes to z by Rx, and z to x by Ry.
  CHECK(length(subtract(rotate(m.rotation(0, 0), {0, 1, 0}), {1, 0, 0})) < 1e-15);
  CHECK(m.rotation(0, 1) == Quat{});
  const Clip back = to_clip(m, "back");
  CHECK(back.id == "back");
  CHECK(back.frame_time == 0.5);
  for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(back.channels[i] - clip.channels[i]) < 1e-12);
  clip.channels.pop_back();
  CHECK_THROWS_WITH_AS(to_motion(clip), doctest::Contains("3 values, expected 1 frames x 4 channels"), Error);
}

TEST_CASE("angles are written as continuous curves through full turns") {
  const Clip clip = to_clip(turning(100, 30, 0.2), "turn");  // three turns
  for (std::size_t f = 0; f < 100; ++f)
    CHECK(clip.channels[f * 6 + 3] == doctest::Approx(degrees(0.2 * double(f))));
}

TEST_CASE("frame times as printed in files") {
  CHECK(rate_from_frame_time(.0083333) == 120);
  CHECK(rate_from_frame_time(0.0333333) == 30);
  CHECK(rate_from_frame_time(0.033333) == 30);
  CHECK(rate_from_frame_time(0.01667) == 60);
  CHECK(rate_from_frame_time(0.04) == 25);
  CHECK(rate_from_frame_time(0.08) == 12.5);
  CHECK(rate_from_frame_time(0.25) == 4);
  CHECK(rate_from_frame_time(2) == 0.5);
  CHECK(std::abs(rate_from_frame_time(1001.0 / 30000) - 29.97) < 1e-3);
  CHECK_THROWS_AS(rate_from_frame_time(0), Error);
}

TEST_CASE("a rounded or cut frame time gives the standard rate that it stands for") {
  const auto read_as = [](double frame_time, double rate) {
    CAPTURE(frame_time);
    CHECK(rate_from_frame_time(frame_time) == rate);
    CHECK(!rate_note(frame_time).empty());
  };
  read_as(0.0333, 30);
  read_as(0.033, 30);
  read_as(0.0417, 24);
  read_as(0.042, 24);
  read_as(0.0416, 24);  // cut, not rounded
  read_as(0.0083, 120);
  read_as(0.0167, 60);
  read_as(0.0166, 60);
  read_as(0.0208, 48);
  read_as(0.0139, 72);
  read_as(0.0111, 90);
  read_as(0.00694, 144);
  read_as(0.00417, 240);
  read_as(0.0334, 30000.0 / 1001);
  read_as(0.033367, 30000.0 / 1001);
  read_as(0.0333667, 30000.0 / 1001);
  read_as(0.03336, 30000.0 / 1001);
  read_as(0.04171, 24000.0 / 1001);
  read_as(0.01668, 60000.0 / 1001);
  read_as(0.008342, 120000.0 / 1001);
  CHECK(rate_note(0.0333) == "frame time 0.0333 s is read as 30 frames per second (1/30 s to 4 decimals)");
  CHECK(rate_note(0.033366667) ==
        "frame time 0.033366667 s is read as 29.97 frames per second (1001/30000 s to 9 decimals)");

  const auto its_own = [](double frame_time, double rate) {
    CAPTURE(frame_time);
    CHECK(rate_from_frame_time(frame_time) == rate);
    CHECK(rate_note(frame_time).empty());
  };
  its_own(0.008, 125);
  its_own(0.04, 25);
  its_own(0.0333333, 30);
  its_own(0.0042, 238);  // the integer within 0.05% comes first
  its_own(0.0083333, 120);
  its_own(0.03, 1 / 0.03);    // one digit
  its_own(0.017, 1 / 0.017);  // 60 differs by 2%
  its_own(0.035, 1 / 0.035);
  its_own(0.08, 12.5);
  its_own(30, 1.0 / 30);
  its_own(1001.0 / 30000, 1 / (1001.0 / 30000));  // not rounded
  its_own(1e-300, 1 / 1e-300);
  CHECK(rate_note(0).empty());
  CHECK(rate_note(std::nan("")).empty());
}

TEST_CASE("resampling: lengths, end points and interpolation") {
  const Motion slow = turning(5, 4, 0.3);  // one second
  const Motion fast = resample(slow, 60);
  CHECK(fast.frames == 61);
  CHECK(fast.rate == 60);
  for (std::size_t f = 0; f < fast.frames; ++f) {
    const double at = static_cast<double>(f) / 15;
    CHECK(std::abs(fast.position(f, 0)[0] - at) < 1e-12);
    CHECK(angle_between(fast.rotation(f, 0), quat_from_expmap({0, 0, 0.3 * at})) < 1e-12);
  }
  CHECK(fast.position(60, 0) == slow.position(4, 0));
  CHECK(fast.rotation(45, 0) == slow.rotation(3, 0));
  const Motion back = resample(fast, 4);
  CHECK(back.frames == 5);
  CHECK(back.rotations == slow.rotations);
  CHECK(back.positions == slow.positions);

  CHECK(resample(turning(481, 120, 0.01), 12.5).frames == 51);  // 4 s
  CHECK(resample(turning(480, 120, 0.01), 12.5).frames == 50);  // one source frame less
  CHECK(resample(turning(100, 30, 0.01), 112.5).frames == 372);
  CHECK(resample(turning(1, 30, 0.01), 60).frames == 1);
  CHECK(resample(turning(2, 30, 0.01), 7).frames == 1);
  CHECK(resample(turning(0, 30, 0.01), 7).frames == 0);
  CHECK(resample(slow, 4).rotations == slow.rotations);
  for (std::size_t n = 2; n < 40; ++n)
    for (const double rate : {3.7, 24.0, 25.0, 29.97, 50.0, 60.0, 144.0}) {
      const Motion m = resample(turning(n, 30, 0.1), rate);
      const double last = static_cast<double>(m.frames - 1) / rate, end = static_cast<double>(n - 1) / 30;
      CHECK(last <= end + 1e-9);
      CHECK(last + 1 / rate > end - 1e-9);
    }
  CHECK_THROWS_WITH_AS(resample(slow, 0), doctest::Contains("0 frames per second"), Error);
  CHECK_THROWS_AS(resample(slow, -5), Error);
  CHECK_THROWS_AS(resample(slow, std::nan("")), Error);
  CHECK_THROWS_AS(resample(slow, 1e300), Error);
  // Only what becomes longer can be too long.
  const std::size_t joints = slow.skeleton.size();
  CHECK_THROWS_WITH_AS(
      resample(turning(1000, 1e-6, 0.1), 30, "walk.bvh"),
      doctest::Contains("walk.bvh: resampling 1000 frames from 1e-06 to 30 per second (1e+09 s) "
                        "would make 3e+10 frames"),
      Error);
  CHECK(resampled_frames(100'000'000, 30, 15, joints, "long") == 50'000'000);
  CHECK_THROWS_AS(resampled_frames(50'000'000, 30, 31, 2, "long"), Error);
}

TEST_CASE("slices") {
  const Motion m = turning(10, 30, 0.1);
  const Motion part = slice(m, 3, 4);
  CHECK(part.frames == 4);
  CHECK(part.position(0, 0)[0] == 3);
  CHECK(part.position(3, 0)[0] == 6);
  CHECK(slice(m, 10, 0).frames == 0);
  CHECK(slice(m, 0, 10).rotations == m.rotations);
  CHECK_THROWS_WITH_AS(slice(m, 8, 3), doctest::Contains("frames 8 to 11 of a motion of 10"), Error);
  CHECK_THROWS_AS(slice(m, 11, 0), Error);
  CHECK_THROWS_AS(slice(m, 2, static_cast<std::size_t>(-1)), Error);
}

}  // namespace motion_test
