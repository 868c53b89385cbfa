// Reads a BVH file, changes the motion and writes it again. Give a file, or watch it make one.
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main(int argc, char** argv) {
  std::string file = argc > 1 ? argv[1] : "walk.bvh";
  if (argc <= 1) motion::write_bvh(file, motion::procedural_motion(0, {.seconds = 4}).motion);

  // A Clip is the file as it stands: channels in the file's order, degrees.
  const motion::Clip clip = motion::read_bvh(file);
  std::printf("%s: %zu frames of %zu channels, %zu joints\n", file.c_str(), clip.frames,
              clip.skeleton.channel_count(), clip.skeleton.size());

  // A Motion is free of that: a rotation and a position for every joint and frame.
  motion::Motion motion = motion::to_motion(clip);
  const motion::GlobalPose pose = motion::forward_kinematics(motion);
  const auto head = static_cast<std::size_t>(std::max(motion.skeleton.find("Head"), 0));
  std::printf("the head is at a height of %.1f at first\n", pose.positions[head][1]);

  // Half a turn about the vertical axis, at 15 frames per second.
  const motion::Quat half_turn{0, 0, 1, 0};
  for (std::size_t f = 0; f < motion.frames; ++f) {
    motion.rotation(f, 0) = motion::multiply(half_turn, motion.rotation(f, 0));
    motion.position(f, 0) = motion::rotate(half_turn, motion.position(f, 0));
  }
  motion = motion::resample(motion, 15);
  motion::write_bvh("turned.bvh", motion);
  std::printf("turned.bvh: %zu frames at %g per second\n", motion.frames, motion.rate);
}
