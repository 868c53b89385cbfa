// Characters that advance one second at a time, are added and removed, and change their class on request.
#include <chrono>
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;
  const auto data = motion::ActionDataset::from_motions(
      motion::procedural_motions({.clips = 68, .seconds = 4, .rate = 20}),
      {.frames = 10, .rate = 10, .pattern = "{label}_*", .classes = {"walk", "run", "jump"}});
  ActionGan model(ctx, data.format, {.hidden = 16, .noise_dim = 4});
  train(model, data, {.iterations = 5, .critic_steps = 2, .batch = 8});

  // Each continues a second of a clip; sample 7 has the same noise whichever characters are around it.
  std::vector<ActionPrior> priors;
  for (const motion::ActionClip& clip : data.train) priors.push_back(data.prior(clip));
  ActionStream stream(model);
  std::vector<ActionStream::Id> ids;
  for (std::uint32_t i = 0; i < 20; ++i) {
    ids.push_back(stream.add({.prior = &priors[i % priors.size()], .label = i % 3, .sample = i}));
    stream.track(ids.back()).x = 200.0 * i;  // side by side, 2 m apart
  }

  const auto begin = std::chrono::steady_clock::now();
  for (std::uint32_t second = 0; second < 10; ++second) {
    if (second == 3) stream.set_class(ids[0], "jump");
    if (second % 4 == 3) {  // one is removed, another added
      stream.remove(ids.back());
      ids.back() = stream.add({.prior = &priors[0], .label = 1, .sample = 100 + second});
    }
    stream.step();
    const motion::PositionClip first = stream.clip(ids[0]);  // a second, placed in the world
    if (second % 3 == 0)
      std::printf("second %2u: %zu characters; the first one does '%s' at %6.1f %6.1f\n", second,
                  stream.size(), stream.class_of(ids[0]).c_str(), first.positions[0][0],
                  first.positions[0][2]);
  }
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  std::printf("%.0f seconds of motion of 20 characters per second\n", 10 / passed.count());
}
