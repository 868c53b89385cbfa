// What a fused operation does when more than its first derivative is asked: it differentiates the same
// function written in elementary operations.
#pragma once
#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan::detail {

/// Partial derivatives of `f` by those inputs that are needed, themselves differentiable. Copies of the
/// inputs are younger than what they copy, so the sweep stops at them.
template <class F>
std::vector<Var> partial_derivatives(const std::vector<Var>& inputs, const Var& g, const Needs& needs,
                                     const F& f) {
  std::vector<Var> copies, wanted;
  for (const Var& input : inputs) copies.push_back(reshape(input, input.shape()));
  for (std::size_t i = 0; i < copies.size(); ++i)
    if (needs[i]) wanted.push_back(copies[i]);
  const std::vector<Var> found = grad({f(copies)}, {g}, wanted, {.create_graph = true});
  std::vector<Var> result(inputs.size());
  for (std::size_t i = 0, j = 0; i < result.size(); ++i)
    if (needs[i]) result[i] = found[j++];
  return result;
}

}  // namespace motiongan::detail
