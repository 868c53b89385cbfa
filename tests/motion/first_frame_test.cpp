// Poses prepended to a motion: found by what they are, and dropped.
#include "motiongan/motion/first_frame.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "../support/bodies.hpp"
#include "motiongan/motion/motion.hpp"

namespace first_frame_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// Two joints; each frame gives x, y, the root's z rotation, and the arm's z and x rotations.
Motion with(const std::vector<std::vector<double>>& frames) {
  Clip clip;
  clip.skeleton.joints = {
      {"Hips", -1, {0, 1, 0}, {Channel::x_position, Channel::y_position, Channel::z_rotation}, {}},
      {"Arm", 0, {1, 0, 0}, {Channel::z_rotation, Channel::x_rotation}, {}}};
  clip.frame_time = 0.01;
  clip.frames = frames.size();
  for (const auto& f : frames) clip.channels.insert(clip.channels.end(), f.begin(), f.end());
  return to_motion(clip);
}

}  // namespace

TEST_CASE("a rest pose before a jump is found and dropped") {
  const std::vector<double> zero{1.5, 2.5, 0, 0, 0}, posed{1, 2, -21.5, 0, 0};
  const std::vector<double> a{1, 2, 30.25, 0, 4.5}, b{1, 2, 30.5, 0.25, 4.5}, c{1, 2, 31, 0.25, 4.5};
  CHECK(t_pose_frames(with({zero, a, b, c})) == 1);
  CHECK(t_pose_frames(with({posed, a, b, c})) == 1);        // angles need not be whole degrees
  CHECK(t_pose_frames(with({posed, zero, a, b, c})) == 2);  // as the CMU clip 07_12 has it
  CHECK(t_pose_frames(with({zero, zero, a, b, c})) == 2);
  CHECK(t_pose_frames(with({a, b, c})) == 0);
  CHECK(t_pose_frames(with({zero, zero, zero})) == 0);  // a clip at rest is no pose before a motion
  CHECK(t_pose_frames(with({zero})) == 0);
  CHECK(t_pose_frames(with({})) == 0);
  CHECK(t_pose_frames(with({zero, zero, zero, zero, zero, a, b})) == 0);             // rests, then moves
  CHECK(t_pose_frames(with({zero, {1, 2, 0.25, 0, 0.5}, {1, 2, 0.5, 0, 1}})) == 0);  // starts smoothly
  CHECK(t_pose_frames(with({zero, {1, 2, 5.5, 0, 0}, {1, 2, 11, 0, 0}})) == 0);
  CHECK(t_pose_frames(with({{1, 2, 70, 2, 3}, {1, 2, 10, 0, 0}, {1, 2, 10.5, 0, 0}})) == 0);  // not at rest

  Motion dropped = with({posed, a, b});
  CHECK(drop_first_frames(dropped, FirstFrame::keep) == 0);
  CHECK(drop_first_frames(dropped, FirstFrame::automatic) == 1);
  CHECK(dropped.frames == 2);
  CHECK(dropped.rotations == with({a, b}).rotations);
  CHECK(dropped.positions == with({a, b}).positions);
  CHECK(drop_first_frames(dropped, FirstFrame::automatic) == 0);
  CHECK(drop_first_frames(dropped, FirstFrame::drop) == 1);
  CHECK(dropped.rotations == with({b}).rotations);
  CHECK(drop_first_frames(dropped, FirstFrame::drop) == 1);
  CHECK(drop_first_frames(dropped, FirstFrame::drop) == 0);
}

TEST_CASE("a sample of frames tells the same as all of them") {
  for (const std::size_t frames : {std::size_t{300}, std::size_t{1000}, std::size_t{1001}}) {
    Motion motion = standing_body(frames);
    prepend_arms(motion, 90);
    const std::vector<std::size_t> sample = sampled_frames(motion.frames);
    REQUIRE(sample.size() < 300);
    Motion thin = motion;
    thin.frames = sample.size();
    thin.rotations.clear(), thin.positions.clear();
    for (const std::size_t f : sample)
      for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
        thin.rotations.push_back(motion.rotation(f, j));
        thin.positions.push_back(motion.position(f, j));
      }
    CHECK(t_pose_frames(motion) == 1);
    CHECK(t_pose_frames(thin, 2) == 1);
    CHECK(first_frame_detail::usual_step(thin, 1, 2) ==
          first_frame_detail::usual_step(motion, 1, first_frame_detail::sample_hop(motion.frames)));
  }
  CHECK(sampled_frames(200).empty());
}

TEST_CASE("a T-pose or A-pose is found whatever the rest pose is") {
  for (const double raised : {90.0, 45.0}) {
    CAPTURE(raised);
    Motion motion = standing_body(60);
    CHECK(t_pose_frames(motion) == 0);
    prepend_arms(motion, raised);
    const Motion turned = with_turned_axes(motion);
    CHECK(first_frame_detail::from_rest(turned, 0) > 30);
    CHECK(t_pose_frames(turned) == 1);
    // The same pose at the start of a motion that leaves it slowly is part of the motion.
    Motion slow = standing_body(60);
    for (std::size_t f = 0; f < slow.frames; ++f) set_arms(slow, f, raised - 0.5 * static_cast<double>(f));
    CHECK(t_pose_frames(with_turned_axes(slow)) == 0);
  }
  // Hanging arms are how people stand: no pose of a converter.
  Motion hanging = standing_body(60);
  prepend_arms(hanging, 5);
  for (std::size_t f = 1; f < hanging.frames; ++f) set_arms(hanging, f, 60);
  CHECK(t_pose_frames(with_turned_axes(hanging)) == 0);
}

}  // namespace first_frame_test
