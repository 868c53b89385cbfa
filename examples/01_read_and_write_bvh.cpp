// Reads a BVH file, changes the motion and writes it again. Without an argument it first writes a file to
// read.
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main(int argc, char** argv) {
  std::string file = argc > 1 ? argv[1] : "walk.bvh";
  if (argc <= 1) motion::write_bvh(file, motion::procedural_motion(0, {.seconds = 4}).motion);

  // A Clip is the raw content of the file: channels in the file's order, in degrees.
  const motion::Clip clip = motion::read_bvh(file);
  std::printf("%s: %zu frames of %zu channels, %zu joints\n", file.c_str(), clip.frames,
              clip.skeleton.channel_count(), clip.skeleton.size());

  // A Motion does not depend on channel orders: a rotation and a position for every joint and frame.
  motion::Motion motion = motion::to_motion(clip);
  const motion::GlobalPose pose = motion::forward_kinematics(motion);
  const auto head = static_cast<std::size_t>(std::max(motion.skeleton.find("Head"), 0));
  std::printf("the head starts at a height of %.1f\n", pose.positions[head][1]);

  // Rotate it by half a turn about the vertical axis, and resample it to 15 frames per second.
  const motion::Quat half_turn{0, 0, 1, 0};
  for (std::size_t f = 0; f < motion.frames; ++f) {
    motion.rotation(f, 0) = motion::multiply(half_turn, motion.rotation(f, 0));
    motion.position(f, 0) = motion::rotate(half_turn, motion.position(f, 0));
  }
  motion = motion::resample(motion, 15);
  motion::write_bvh("turned.bvh", motion);
  std::printf("turned.bvh: %zu frames at %g frames per second\n", motion.frames, motion.rate);
}
