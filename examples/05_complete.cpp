// Goes on from the first seconds of a clip, as a text says. With your own: Dvgan::load(ctx, "model") of
// `motiongan train dvgan --generator rnn`, and motion::to_motion(motion::read_bvh("clip.bvh")).
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

  // Two seconds of somebody walking, at any rate and anywhere in the room.
  const motion::Motion clip = motion::procedural_motion(0, {.seconds = 4, .rate = 30}).motion;
  const motion::Motion given = motion::slice(clip, 0, 61);

  // Three ways to go on from its last frame.
  MotionStream stream(model);
  std::vector<CharacterOptions> ways;
  for (std::uint32_t i = 0; i < 3; ++i) ways.push_back({.text = "walk", .sample = i, .prior = &given});
  const std::vector<CharacterId> ids = stream.add(ways);
  stream.step(24);

  // What was given, at the model's rate and so that its last frame stays; then what was made.
  const motion::Motion seed = motion::resample_to_end(given, stream.rate());
  const motion::Motion truth = motion::resample(clip, stream.rate());
  std::vector<view::ViewedMotion> shown{{"the clip", truth, seed.frames}};
  for (const CharacterId id : ids) {
    shown.push_back({"made", motion::join(seed, stream.motion(id)), seed.frames});
    const motion::Vec3 before = seed.position(seed.frames - 1, 0), after = stream.motion(id).position(0, 0);
    std::printf("given until %.1f %.1f, goes on at %.1f %.1f\n", before[0], before[2], after[0], after[2]);
  }
  motion::write_bvh("completed.bvh", shown[1].motion);
  view::write_player("completed.html", shown, {.title = "one beginning, three ways to go on"});
  std::printf("completed.bvh: %zu frames given, %zu made; completed.html shows all\n", seed.frames,
              shown[1].motion.frames - seed.frames);
}
