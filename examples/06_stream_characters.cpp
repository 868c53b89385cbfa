// A hundred characters, one frame at a time, as in a game loop: they are added and removed, and change what
// they do when given another text.
#include <chrono>
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;
  auto data = motion::Dataset::from_motions(
      motion::procedural_motions({.clips = 34}),
      {.frames = 16, .rate = 8.0, .root_rotation = motion::RootRotation::velocity});
  Dvgan model(ctx, data.format, {.generator = GeneratorKind::rnn, .hidden = 16});
  train(model, data, {.iterations = 5, .critic_steps = 2, .batch = 8});

  // In ten rows of ten. Each has its own noise: sample 7 moves the same whichever characters are around it.
  MotionStream stream(model);
  std::vector<CharacterOptions> crowd;
  for (std::uint32_t i = 0; i < 100; ++i)
    crowd.push_back({.text = i % 2 == 0 ? "walk" : "wave with the left hand",
                     .sample = i,
                     .at = {.x = 200.0 * (i % 10), .z = 200.0 * (i / 10)}});
  std::vector<CharacterId> ids = stream.add(crowd);

  const auto begin = std::chrono::steady_clock::now();
  for (std::uint32_t frame = 0; frame < 80; ++frame) {  // ten seconds
    if (frame == 20) stream.set_text(ids[0], "jump");
    if (frame % 10 == 9) {  // one is removed, another added
      stream.remove(ids.back());
      ids.back() = stream.add({.text = "run in a circle", .sample = 100 + frame});
    }
    stream.step();
    const motion::Motion first = stream.motion(ids[0]);  // one frame, placed in the world
    if (frame % 20 == 0)
      std::printf("frame %2u: %zu characters, the first one at %6.1f %6.1f\n", frame, stream.size(),
                  first.position(0, 0)[0], first.position(0, 0)[2]);
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  std::printf("%.0f frames of 100 characters per second\n", 80 / passed.count());
}
