// The training steps of DVGAN's CNN models: the workload of `torch_peer.py speed --models cnn` at any size.
#pragma once
#include <motiongan/networks/cnn_critic.hpp>
#include <motiongan/networks/cnn_generator.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "steps.hpp"

namespace motiongan::bench {

struct CnnSize {
  std::size_t batch = 64, frames = 32, hidden = 256;
};

/// 500 words, 93 dof, final cut. Steps include Adam; the critic's step includes generating the fakes.
/// `suffix` is appended to the names.
inline std::vector<Measured> cnn_steps(const Context& context, double seconds, const CnnSize& size,
                                       const std::string& suffix) {
  constexpr std::size_t dof = 93, vocabulary = 500;
  const std::size_t batch = size.batch, frames = size.frames, hidden = size.hidden;
  CnnGenerator generator(Initializer(context, 1),
                         {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  CnnCritic critic(Initializer(context, 2),
                   {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  Adam generator_adam(named_parameters(generator)), critic_adam(named_parameters(critic));
  std::vector<std::vector<int>> sentences(batch);
  for (std::uint32_t b = 0; b < batch; ++b)
    for (std::uint32_t i = 0; i < 6; ++i)
      sentences[b].push_back(
          static_cast<int>(random_below({.seed = 9, .stream = RandomStream::captions}, b, vocabulary, i)));
  const Sentences text(context, sentences, vocabulary);
  const Tensor real = random_normal(context, {.seed = 5}, frames, batch, dof);
  std::uint32_t step = 0;
  const auto fake = [&] {
    const RandomKey key{.seed = 1, .step = ++step};
    const Indices cut = generator.cuts(context, key, batch);
    return generator(text, generator.noise(context, key, batch, cut), cut);
  };
  const auto sample = [&] {
    const NoGrad values_only;
    return fake().value();
  };
  const auto critic_step = [&] {
    const KeepPacked weights_packed;  // as in a trainer
    const Tensor made = sample();
    const Var h_txt = critic.encode_text(text), pairs = concatenate({h_txt, h_txt}, 0);
    const CriticLoss loss = critic_loss(
        [&](const Var& x) { return critic(x, pairs); }, [&](const Var& x) { return critic(x, h_txt); }, real,
        made,
        random_uniform(context, {.seed = 1, .stream = RandomStream::interpolation, .step = step}, batch), 10);
    critic_adam.step(grad(loss.loss, critic_adam.parameters()));
  };
  const auto generator_step = [&] {
    const KeepPacked weights_packed;
    Var h_txt;
    {
      const NoGrad values_only;
      h_txt = critic.encode_text(text);
    }
    generator_adam.step(grad(generator_loss(critic(fake(), h_txt)), generator_adam.parameters()));
  };
  return {measure(context, "dvgan_cnn_critic_step" + suffix, seconds, critic_step),
          measure(context, "dvgan_cnn_generator_step" + suffix, seconds, generator_step),
          measure(context, "dvgan_cnn_sample" + suffix, seconds, sample)};
}

}  // namespace motiongan::bench
