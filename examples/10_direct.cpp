// A walk along a path that ends with a hand at a point: the noise of a trained model is chosen so that its
// motion meets both.
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;
  auto data = motion::Dataset::from_motions(
      motion::procedural_motions({.clips = 34}),
      {.frames = 16, .rate = 8.0, .root_rotation = motion::RootRotation::support});
  Dvgan model(ctx, data.format, {.hidden = 16});
  train(model, data, {.iterations = 5, .critic_steps = 2, .batch = 8});

  // Lengths are in the model's unit: here a leg is about 90.
  const std::size_t hand = find_joint(model.format().skeleton(), "LeftHand");
  DirectTask task{
      .text = "walk",
      .constraints = {
          PathConstraint{.points = {{0, 0}, {10, 60}, {40, 110}}},
          JointConstraint{.joint = hand, .from = 1.8, .to = 1.8, .position = motion::Vec3{40, 110, 110}}}};
  DirectOptions options{.iterations = 60, .exact = true};
  options.report = [](const DirectProgress& p) {
    if (p.iteration % 30 == 0) std::printf("step %zu: error / allowed %.2f\n", p.iteration, p.excess);
  };
  const DirectedMotion made = direct(model, {task}, options).front();
  for (const ConstraintError& e : made.errors)
    std::printf("%s: off by %.2f, %.2f allowed\n", e.name.c_str(), e.worst, e.tolerance);
  motion::write_bvh("directed.bvh", made.motion);
  std::printf("%s\n", made.met() ? "all met" : "not all met");
}
