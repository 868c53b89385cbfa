// The training steps, sampling and streaming of DVGAN's recurrent networks: the workload of
// `torch_peer.py speed --models rnn,rnn_critic` (500 words, 93 dof, 64 frames, k = 256), and characters frame
// by frame.
#pragma once
#include <motiongan/networks/cnn_critic.hpp>
#include <motiongan/networks/rnn_critic.hpp>
#include <motiongan/networks/rnn_stream.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "steps.hpp"

namespace motiongan::bench {

namespace rnn {

constexpr std::size_t frames = 64, dof = 93, vocabulary = 500, hidden = 256;

inline std::vector<std::vector<int>> random_sentences(std::size_t count) {
  std::vector<std::vector<int>> sentences(count);
  for (std::uint32_t b = 0; b < count; ++b)
    for (std::uint32_t i = 0; i < 6; ++i)
      sentences[b].push_back(
          static_cast<int>(random_below({.seed = 9, .stream = RandomStream::captions}, b, vocabulary, i)));
  return sentences;
}

/// Sampling as in use: new sentences every time, with the same weights.
inline Measured sample(const Context& context, const RnnGenerator& generator, std::size_t batch,
                       double seconds, const std::string& suffix = "") {
  RnnStream stream(generator);
  const auto sentences = random_sentences(batch);
  std::uint32_t first = 0;
  return measure(context, "dvgan_rnn_sample_n64_b" + std::to_string(batch) + suffix, seconds, [&] {
    std::vector<StreamStart> starts;
    for (const auto& sentence : sentences) starts.push_back({sentence, 1, first++});
    stream.add(starts);
    stream.step(frames);
    stream.clear();
  });
}

/// Frames per second of `count` characters that all advance one frame at a time.
inline Measured streaming(const Context& context, const RnnGenerator& generator, std::size_t count,
                          double seconds, const std::string& suffix = "") {
  RnnStream stream(generator);
  std::vector<StreamStart> starts;
  for (const auto& sentence : random_sentences(count))
    starts.push_back({sentence, 1, static_cast<std::uint32_t>(starts.size())});
  stream.add(starts);
  constexpr std::size_t steps = 16;  // per measurement, because plots are computed up to 16 frames ahead
  Measured m = measure(context, "dvgan_rnn_stream_" + std::to_string(count) + suffix, seconds, [&] {
    for (std::size_t i = 0; i < steps; ++i) stream.step(1);
  });
  m.extra["frames_per_second"] = static_cast<double>(steps * count) / m.ms * 1e3;
  m.extra["ms_per_step"] = m.ms / steps;
  return m;
}

}  // namespace rnn

/// All measurements.
inline std::vector<Measured> rnn_steps(const Context& context, double seconds) {
  using namespace rnn;
  constexpr std::size_t batch = 64;
  RnnGenerator generator(Initializer(context, 1),
                         {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  CnnCritic cnn(Initializer(context, 2),
                {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = hidden});
  RnnCritic recurrent(Initializer(context, 3), {.vocabulary = vocabulary, .dof = dof, .hidden = hidden});
  Adam generator_adam(named_parameters(generator)), critic_adam(named_parameters(recurrent));
  const Sentences text(context, random_sentences(batch), vocabulary);
  const Tensor real = random_normal(context, {.seed = 5}, frames, batch, dof);
  std::uint32_t step = 0;
  const auto fake = [&] {
    return generator(text, generator.noise(context, {.seed = 1, .step = ++step}, batch, frames));
  };
  const auto generator_step = [&] {
    const KeepPacked weights_packed;  // as in a trainer
    Var h_txt;
    {
      const NoGrad values_only;
      h_txt = cnn.encode_text(text);
    }
    generator_adam.step(grad(generator_loss(cnn(fake(), h_txt)), generator_adam.parameters()));
  };
  const auto critic_step = [&] {
    const KeepPacked weights_packed;
    Tensor made;
    {
      const NoGrad values_only;
      made = fake().value();
    }
    const Var h_txt = recurrent.encode_text(text), pairs = concatenate({h_txt, h_txt}, 0);
    const CriticLoss loss = critic_loss(
        [&](const Var& x) { return recurrent(x, pairs); }, [&](const Var& x) { return recurrent(x, h_txt); },
        real, made,
        random_uniform(context, {.seed = 1, .stream = RandomStream::interpolation, .step = step}, batch), 10);
    critic_adam.step(grad(loss.loss, critic_adam.parameters()));
  };
  std::vector<Measured> all{sample(context, generator, 64, seconds), sample(context, generator, 1, seconds),
                            measure(context, "dvgan_rnn_generator_step_n64_b64", seconds, generator_step),
                            measure(context, "dvgan_rnn_critic_step_n64_b64", seconds, critic_step)};
  constexpr std::size_t crowds[] = {1, 10, 100, 1000};
  for (const std::size_t count : crowds) all.push_back(streaming(context, generator, count, seconds));
  generator.bfloat16();
  all.push_back(sample(context, generator, 1, seconds, "_bf16"));
  for (const std::size_t count : crowds)
    all.push_back(streaming(context, generator, count, seconds, "_bf16"));
  return all;
}

}  // namespace motiongan::bench
