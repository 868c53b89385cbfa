// Trains the attention model on labelled clips, then continues a second of a clip with a schedule of classes.
// For your own clips: motion::ActionDataset::from_folder("clips", {.labels = "labels.tsv"}).
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;
  // Built-in motion; a clip's class is the first word of its name (walk_000).
  const auto data = motion::ActionDataset::from_motions(
      motion::procedural_motions({.clips = 68, .seconds = 4, .rate = 20}),
      {.frames = 10, .rate = 10, .pattern = "{label}_*", .classes = {"walk", "run", "jump"}});
  std::printf("%zu clips for training, %zu for testing\n", data.train.size(), data.test.size());

  ActionGan model(ctx, data.format, {.hidden = 16});
  train(model, data, {.iterations = 5, .critic_steps = 2, .batch = 8},
        {.log_every = 5, .report = [](std::size_t iteration, std::span<const NamedLoss> l) {
           std::printf("iteration %zu: wasserstein %.3f, skeleton %.3f, blend %.3f, accuracy %.2f\n",
                       iteration, loss_of(l, "wasserstein"), loss_of(l, "skeleton"), loss_of(l, "blend"),
                       loss_of(l, "accuracy"));
         }});
  model.save("actions.safetensors");

  // A second of a real clip, then two and a half seconds of walking and one of running.
  const auto clips = model.generate({data.prior(data.test.front())}, "walk:2.5s,run:1s");
  const motion::PositionClip& made = clips.front();
  std::printf("%zu frames, the first %zu of them given\n", made.frames, data.format.frames);

  // Positions are converted to joint rotations, so that the motion can be written as BVH.
  const motion::Motion turned = motion::motion_from_positions(made);
  motion::write_bvh("walk-run.bvh", turned);
  motion::write_position_csv("walk-run.csv", made);
  const std::vector<view::ViewedMotion> shown{{"walk, then run", turned, data.format.frames}};
  view::write_player("walk-run.html", shown);

  // A synthetic clip for each training clip: same first second, same class, same length.
  const auto synthetic = synthesise(model, data, data.train);
  std::printf("%zu synthetic clips, the first of class %s\n", synthetic.size(),
              data.format.classes[synthetic.front().label].c_str());
}
