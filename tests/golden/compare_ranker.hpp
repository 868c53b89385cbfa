// The rankers on golden files.
#pragma once
#include <numeric>

#include <motiongan/models/ranker.hpp>
#include <motiongan/ops/cross_entropy.hpp>

#include "file.hpp"

namespace motiongan::golden::detail {

/// Scores clip i against all descriptions; description i is the right one.
template <class Network>
void ranker(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  const bool is_cnn = std::is_same_v<Network, CnnRanker>;  // the RNN takes any number of frames
  Network model(Initializer(context, 1), {.vocabulary = file.number("vocab"),
                                          .dof = file.number("dof"),
                                          .frames = is_cnn ? file.number("frames") : 2,
                                          .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var motion = Var::constant(file.tensor(context, "in.motion"));
  const Var scores =
      matmul(normalize_rows(model.embed(motion)), model.describe(file.sentences(context)), false, true);
  outputs.push_back(output(file, "out.scores", scores));
  std::vector<std::size_t> right(motion.dim(1));
  std::iota(right.begin(), right.end(), std::size_t{0});
  const Var loss = cross_entropy(scores, Var::constant(one_hot(context, right, right.size())));
  add_gradients(gradients, file, parameters, grad(loss, values_of(parameters)));
}

}  // namespace motiongan::golden::detail
