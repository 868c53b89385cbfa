// Operations on tensors with an axis of size 0.
#pragma once
#include <doctest/doctest.h>

#include "check_grads.hpp"
#include "messages.hpp"

namespace motiongan::testing {

inline Var some(Shape shape) {
  const Input input = randn(std::move(shape));
  return Var::leaf(Tensor::from(double_context(), input.shape, input.values));
}
inline Indices indices(const std::vector<cl_int>& values) { return {double_context(), values}; }

/// Checks that f of tensors of the given shapes has shape `expected` and is zero, and its derivatives up to
/// the second order.
inline void check_zero(const char* name, const Function& f, const std::vector<Shape>& shapes,
                       const Shape& expected) {
  CAPTURE(name);
  std::vector<Input> inputs;
  std::vector<Var> leaves;
  for (const Shape& shape : shapes) {
    inputs.push_back(randn(shape));
    leaves.push_back(some(shape));
  }
  // Buffers of the pool that hold something else than zeros, for results that a kernel forgets to write.
  std::vector<Tensor> used;
  for (int i = 0; i < 4; ++i) used.push_back(full(double_context(), {32}, 7));
  used.clear();
  const Var y = f(leaves);
  CHECK(y.shape() == expected);
  CHECK(y.value().to_host<double>() == std::vector<double>(y.size(), 0.0));
  CHECK(check_grads(double_context(), f, inputs, 2) < 1e-7);
}

template <class F>
void check_error(const F& f, const std::string& part) {
  CHECK(says(message_of(f), part));
}

}  // namespace motiongan::testing
