// What a fused operation does when more than its first derivative is asked: it differentiates the same
// function written in elementary operations.
#pragma once
#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan::detail {

/// The recorded gradients of <composed(inputs), g> by the inputs of `self` that need one. The copies of the
/// inputs are younger than what they copy, so the sweep stops at them and gives partial derivatives.
template <class Composed>
std::vector<Var> derivative_of_composed(const Node& self, const Var& g, const Needs& needs,
                                        const Composed& composed) {
  std::vector<Var> copies, wanted;
  for (const Var& input : self.inputs) copies.push_back(reshape(input, input.shape()));
  for (std::size_t i = 0; i < copies.size(); ++i)
    if (needs[i]) wanted.push_back(copies[i]);
  const std::vector<Var> found = grad({composed(copies)}, {g}, wanted, {.create_graph = true});
  std::vector<Var> result(self.inputs.size());
  for (std::size_t i = 0, j = 0; i < result.size(); ++i)
    if (needs[i]) result[i] = found[j++];
  return result;
}

}  // namespace motiongan::detail
