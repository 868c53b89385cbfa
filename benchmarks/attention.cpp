// The attention WGAN-GP compared with PyTorch: the same names and workload as
// `torch_peer.py speed --models attention` (30 frames, 93 dof, 4 classes, C = 256). The critic step includes
// generating the fakes and Adam; a rollout is 30 seconds of motion, each second the prior of the next.
//   bench_attention [--json] [--peer torch_peer.py [--python PYTHON]...] [--seconds 4] [--rounds 5]
// With --peer the script times the same work in PyTorch, in a process of its own, in turn with ours: medians
// over the rounds, and the ratio to the fastest PyTorch, are printed.
#include <motiongan/networks/attention_critic.hpp>
#include <motiongan/networks/attention_rollout.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "steps.hpp"

using namespace motiongan;
using bench::measure;
using bench::Measured;

namespace {

constexpr std::size_t frames = 30, dof = 93, classes = 4, seconds_made = 30;

/// One-hot rows, class b % 4 for sample b: [batch, classes].
Tensor classes_of(const Context& context, std::size_t batch) {
  std::vector<float> rows(batch * classes, 0);
  for (std::size_t b = 0; b < batch; ++b) rows[b * classes + b % classes] = 1;
  return Tensor::from(context, {batch, classes}, rows);
}

Measured critic_step(const Context& context, const AttentionGenerator& generator, double seconds) {
  constexpr std::size_t batch = 64;
  AttentionCritic critic(Initializer(context, 2), {.dof = dof});
  Adam adam(named_parameters(critic));
  const Tensor prior = random_normal(context, {.seed = 5}, frames, batch, dof);
  const Tensor future = random_normal(context, {.seed = 6}, frames, batch, dof);
  const Var x = Var::constant(prior), y = Var::constant(classes_of(context, batch));
  const Tensor real = concatenate({x, Var::constant(future)}, 0).value();
  std::uint32_t step = 0;
  return measure(context, "attention_critic_step_b64", seconds, [&] {
    const KeepPacked weights_packed;  // as in a trainer
    Tensor fake;
    {
      const NoGrad values_only;
      fake = concatenate({x, generator(x, y)}, 0).value();
    }
    const auto judge = [&](const Var& motion) { return critic(motion); };
    const CriticLoss loss = critic_loss(
        judge, judge, real, fake,
        random_uniform(context, {.seed = 1, .stream = RandomStream::interpolation, .step = ++step}, batch),
        10);
    adam.step(grad(loss.loss, adam.parameters()));
  });
}

Measured rollout(const Context& context, const AttentionGenerator& generator, std::size_t batch,
                 double seconds, const std::string& suffix = "") {
  const Tensor prior = random_normal(context, {.seed = 5}, frames, batch, dof);
  const Tensor y = classes_of(context, batch);
  AttentionRollout rollout(generator);
  return measure(context, "attention_rollout_30s_b" + std::to_string(batch) + suffix, seconds, [&] {
    Tensor motion = prior;
    for (std::size_t i = 0; i < seconds_made; ++i) motion = rollout.step(motion, y);
  });
}

std::vector<Measured> ours(const Context& context, double seconds) {
  AttentionGenerator generator(Initializer(context, 1), {.dof = dof, .classes = classes});
  std::vector<Measured> all{critic_step(context, generator, seconds),
                            rollout(context, generator, 64, seconds),
                            rollout(context, generator, 1, seconds)};
  generator.bfloat16();
  for (const std::size_t batch : {1u, 8u, 64u})
    all.push_back(rollout(context, generator, batch, seconds, "_bf16"));
  return all;
}

}  // namespace

int main(int argc, char** argv) { return bench::main("bench_attention", "attention", ours, argc, argv); }
