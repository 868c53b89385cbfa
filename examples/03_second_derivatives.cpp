// A critic of your own with a gradient penalty, which needs the derivative of the norm of a derivative. Any
// function of Vars can be differentiated, and the result differentiated again.
#include <cmath>
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

/// Scores motion [T, B, C] with one hidden layer, frame by frame; returns the mean score over frames, [B].
struct FrameCritic {
  Conv1d hidden, score;

  FrameCritic(Initializer init, std::size_t channels, std::size_t width)
      : hidden(init, channels, width), score(init, width, 1) {}

  Var operator()(const Var& motion) const {
    const Var frames = score(mean(relu(hidden(motion)), 0));  // [1, B, 1]
    return reshape(frames, {motion.dim(1)});
  }
  void list_parameters(ParameterList& list) {
    list.add_module("hidden", hidden);
    list.add_module("score", score);
  }
};

int main() {
  const Context ctx(ContextOptions{.precision = Precision::f64});
  FrameCritic critic(Initializer(ctx, 1), 6, 16);
  const Var motion = Var::leaf(random_normal(ctx, {.seed = 2}, 8, 4, 6));  // 8 frames, 4 samples, 6 channels

  // (|d score / d motion| - 1)^2, and its gradient with respect to every weight: a second derivative.
  const auto penalty = [&] { return gradient_penalty(critic, motion); };
  const auto parameters = named_parameters(critic);
  const std::vector<Var> gradients = grad(penalty(), values_of(parameters));
  std::printf("penalty %.6f\n", penalty().item());

  // The same derivative by finite differences: one weight is moved a little.
  const std::vector<double> gradient = gradients[0].value().to_host<double>();
  Tensor weight = parameters[0].value->value();
  std::vector<double> values = weight.to_host<double>();
  const double step = 1e-5, before = values[0];
  double moved[2];
  for (int i = 0; i < 2; ++i) {
    values[0] = before + (i == 0 ? step : -step);
    weight.write(std::span<const double>(values));
    moved[i] = penalty().item();
  }
  const double difference = (moved[0] - moved[1]) / (2 * step);
  std::printf("d penalty / d %s[0]: %.9f by autograd, %.9f by finite differences\n",
              parameters[0].name.c_str(), gradient[0], difference);
  return std::abs(gradient[0] - difference) < 1e-6 ? 0 : 1;
}
