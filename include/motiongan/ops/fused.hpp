// fused(): an operation with fast kernels for its value and first derivative, and a composition of elementary
// operations for higher derivatives (like MLX's primitives with a fallback).
#pragma once
#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan::detail {

/// Vector-Jacobian product of `f` with respect to the needed inputs, itself differentiable. The inputs are
/// copied because grad() stops at nodes older than its inputs.
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

/// Records an operation whose `value` was computed by fused kernels.
///
/// `backward(self, g, needs)` returns the gradients of the inputs as tensors (empty means zero), also from
/// fused kernels. It is used when the backward pass is not recorded, i.e. for first derivatives. To
/// differentiate again, `composed(inputs)` is differentiated instead: the same function, composed of
/// operations with derivatives of every order. `double_backward(self, g, needs)` can return differentiable
/// gradients faster for that case, or an empty list if it cannot.
template <class Backward, class Composed, class DoubleBackward>
Var fused(const char* name, std::vector<Var> inputs, Tensor value, Backward backward, Composed composed,
          DoubleBackward double_backward) {
  return record(name, std::move(inputs), std::move(value),
                [=](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  if (recording()) {
                    std::vector<Var> found = double_backward(self, g, needs);
                    return found.empty() ? partial_derivatives(self.inputs, g, needs, composed) : found;
                  }
                  std::vector<Var> gradients;
                  for (Tensor& t : backward(self, g.value(), needs))
                    gradients.push_back(t.empty() ? Var() : Var::constant(std::move(t)));
                  return gradients;
                });
}

template <class Backward, class Composed>
Var fused(const char* name, std::vector<Var> inputs, Tensor value, Backward backward, Composed composed) {
  return fused(name, std::move(inputs), std::move(value), std::move(backward), std::move(composed),
               [](const Node&, const Var&, const Needs&) { return std::vector<Var>(); });
}

}  // namespace motiongan::detail
