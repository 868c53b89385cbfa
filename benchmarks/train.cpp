// DVGAN's training steps compared with PyTorch: the same names and workload as `torch_peer.py speed --models
// cnn` (500 words, 93 dof, 32 frames, final cut, k = 256, batch 64; steps include Adam, the critic step
// includes generating the fakes).
//   bench_train [--json] [--peer torch_peer.py] [--seconds 4]
// With --peer the script then times the same steps in PyTorch, in a separate process, and the ratio is
// printed.
#include <motiongan/networks/cnn_critic.hpp>
#include <motiongan/networks/cnn_generator.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "steps.hpp"

using namespace motiongan;
using bench::measure;
using bench::Measured;

namespace {

std::vector<Measured> ours(const Context& context, double seconds) {
  constexpr std::size_t batch = 64, frames = 32, dof = 93, vocabulary = 500, hidden = 256;
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
    const Tensor made = sample();
    const Var h_txt = critic.encode_text(text), pairs = concatenate({h_txt, h_txt}, 0);
    const CriticLoss loss = critic_loss(
        [&](const Var& x) { return critic(x, pairs); }, [&](const Var& x) { return critic(x, h_txt); }, real,
        made,
        random_uniform(context, {.seed = 1, .stream = RandomStream::interpolation, .step = step}, batch), 10);
    critic_adam.step(grad(loss.loss, critic_adam.parameters()));
  };
  const auto generator_step = [&] {
    Var h_txt;
    {
      const NoGrad values_only;
      h_txt = critic.encode_text(text);
    }
    generator_adam.step(grad(generator_loss(critic(fake(), h_txt)), generator_adam.parameters()));
  };
  return {measure(context, "dvgan_cnn_critic_step_b64", seconds, critic_step),
          measure(context, "dvgan_cnn_generator_step_b64", seconds, generator_step),
          measure(context, "dvgan_cnn_sample_b64", seconds, sample)};
}

}  // namespace

int main(int argc, char** argv) { return bench::main("bench_train", "cnn", ours, argc, argv); }
