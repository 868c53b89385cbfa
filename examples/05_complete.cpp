// Continues the first seconds of a clip, guided by a text. For your own data: load a model of
// `motiongan train dvgan --generator rnn` with Dvgan::load(ctx, "save/rnn/generator.safetensors"), and a clip
// with motion::read_motion("clip.bvh").motion.
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

  // Two seconds of walking; the rate and the place in the room do not matter.
  const motion::Motion clip = motion::procedural_motion(0, {.seconds = 4, .rate = 30}).motion;
  const motion::Motion given = motion::slice(clip, 0, 61);

  // Three continuations from its last frame.
  MotionStream stream(model);
  std::vector<CharacterOptions> ways;
  for (std::uint32_t i = 0; i < 3; ++i) ways.push_back({.text = "walk", .sample = i, .prior = &given});
  const std::vector<CharacterId> ids = stream.add(ways);
  stream.step(24);

  // The given part, resampled to the model's rate with its last frame kept; then the generated part.
  const motion::Motion seed = motion::resample_to_end(given, stream.rate());
  const motion::Motion truth = motion::resample(clip, stream.rate());
  std::vector<view::ViewedMotion> shown{{"the clip", truth, seed.frames}};
  for (const CharacterId id : ids) {
    shown.push_back({"generated", motion::join(seed, stream.motion(id)), seed.frames});
    const motion::Vec3 before = seed.position(seed.frames - 1, 0), after = stream.motion(id).position(0, 0);
    std::printf("the given part ends at %.1f %.1f, the generated part starts at %.1f %.1f\n", before[0],
                before[2], after[0], after[2]);
  }
  motion::write_bvh("completed.bvh", shown[1].motion);
  view::write_player("completed.html", shown, {.title = "one beginning, three continuations"});
  std::printf("completed.bvh: %zu frames given, %zu generated; completed.html shows all continuations\n",
              seed.frames, shown[1].motion.frames - seed.frames);
}
