// The training step and the rollouts of the attention WGAN-GP: the workload of `torch_peer.py speed --models
// attention` (30 frames, 93 dof, 4 classes, C = 256).
#pragma once
#include <motiongan/networks/attention_critic.hpp>
#include <motiongan/networks/attention_rollout.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "steps.hpp"

namespace motiongan::bench {

namespace attention {

constexpr std::size_t frames = 30, dof = 93, classes = 4, seconds_made = 30;

/// One-hot rows, class b % 4 for sample b: [batch, classes].
inline Tensor classes_of(const Context& context, std::size_t batch) {
  std::vector<float> rows(batch * classes, 0);
  for (std::size_t b = 0; b < batch; ++b) rows[b * classes + b % classes] = 1;
  return Tensor::from(context, {batch, classes}, rows);
}

inline Measured critic_step(const Context& context, const AttentionGenerator& generator, double seconds) {
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

inline Measured rollout(const Context& context, const AttentionGenerator& generator, std::size_t batch,
                        double seconds, const std::string& suffix = "") {
  const Tensor prior = random_normal(context, {.seed = 5}, frames, batch, dof);
  const Tensor y = classes_of(context, batch);
  AttentionRollout rollout(generator);
  return measure(context, "attention_rollout_30s_b" + std::to_string(batch) + suffix, seconds, [&] {
    Tensor motion = prior;
    for (std::size_t i = 0; i < seconds_made; ++i) motion = rollout.step(motion, y);
  });
}

}  // namespace attention

/// All measurements.
inline std::vector<Measured> attention_steps(const Context& context, double seconds) {
  using namespace attention;
  AttentionGenerator generator(Initializer(context, 1), {.dof = dof, .classes = classes});
  std::vector<Measured> all{critic_step(context, generator, seconds),
                            rollout(context, generator, 64, seconds),
                            rollout(context, generator, 1, seconds)};
  generator.bfloat16();
  for (const std::size_t batch : {1u, 8u, 64u})
    all.push_back(rollout(context, generator, batch, seconds, "_bf16"));
  return all;
}

}  // namespace motiongan::bench
