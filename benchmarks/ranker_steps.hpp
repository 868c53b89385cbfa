// A training step of a ranker: 64 windows of 32 frames and 64 descriptions of 6 words, including Adam.
#pragma once
#include <motiongan/networks/cnn_ranker.hpp>
#include <motiongan/networks/rnn_ranker.hpp>
#include <motiongan/ops/cross_entropy.hpp>
#include <motiongan/optim/adam.hpp>
#include <numeric>

#include "steps.hpp"

namespace motiongan::bench {

/// The same names and workload as in ranker_peer.py.
template <class Network>
Measured ranker_step(const Context& context, const std::string& name, double seconds) {
  constexpr std::size_t batch = 64, frames = 32, dof = 69, vocabulary = 100, words = 6;
  Network ranker(Initializer(context, 1),
                 {.vocabulary = vocabulary, .dof = dof, .frames = frames, .hidden = 256});
  Adam adam(named_parameters(ranker));
  const Var motion = Var::constant(random_normal(context, {.seed = 5}, frames, batch, dof));
  std::vector<std::vector<int>> sentences(batch, std::vector<int>(words));
  for (std::size_t i = 0; i < batch * words; ++i)
    sentences[i / words][i % words] = static_cast<int>(i * 7 % vocabulary);
  const Sentences text(context, sentences, vocabulary);
  std::vector<std::size_t> right(batch);
  std::iota(right.begin(), right.end(), std::size_t{0});
  const Var targets = Var::constant(one_hot(context, right, batch));
  Measured out = measure(context, name, seconds, [&] {
    const Var scores = matmul(normalize_rows(ranker.embed(motion)), ranker.describe(text), false, true);
    adam.step(grad(cross_entropy(scores, targets), adam.parameters()));
  });
  out.extra["clips_per_second"] = 1e3 * batch / out.ms;
  return out;
}

inline std::vector<Measured> ranker_steps(const Context& context, double seconds) {
  return {ranker_step<RnnRanker>(context, "rnn_ranker_step_b64", seconds),
          ranker_step<CnnRanker>(context, "cnn_ranker_step_b64", seconds)};
}

}  // namespace motiongan::bench
