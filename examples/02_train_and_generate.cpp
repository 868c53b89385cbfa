// Trains a small DVGAN on built-in motion and generates with it. For your own clips only `data` changes:
//
//     auto data = motion::Dataset::from_bvh("clips/", {.captions = "captions.tsv"});
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;  // the best device available
  auto data =
      motion::Dataset::from_motions(motion::procedural_motions({.clips = 34}), {.frames = 16, .rate = 8.0});
  Dvgan model(ctx, data.format, {.hidden = 32});

  ProgressBar bar;
  bar.start(10);
  std::filesystem::remove_all("save");  // train() never overwrites a run
  train(model, data, {.iterations = 10, .critic_steps = 5, .batch = 16},
        {.save_dir = "save", .report = [&](std::size_t iteration, std::span<const NamedLoss> losses) {
           bar.update(iteration, {{"wasserstein", loss_of(losses, "wasserstein")},
                                  {"penalty", loss_of(losses, "penalty")}});
         }});
  bar.finish();

  // One file is enough to generate: it also holds the skeleton, the vocabulary and the rate.
  const Dvgan loaded = Dvgan::load(ctx, "save/generator.safetensors");
  auto walks = loaded.generate("walk slowly", {.count = 2, .seed = 7});
  motion::write_bvh("walk.bvh", motion::resample(walks[0], 30));
  std::printf("walk.bvh: %zu frames at %g frames per second, resampled to 30\n", walks[0].frames,
              walks[0].rate);
}
