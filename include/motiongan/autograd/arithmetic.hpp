// Constants and linear operations (a*x + b, a*x + b*y): grad() needs them to seed and accumulate gradients.
#pragma once
#include "motiongan/autograd/var.hpp"

namespace motiongan {

namespace detail {

inline const ElementwiseKernel affine_kernel("affine", 1, "a * v + b");
inline const ElementwiseKernel weighted_sum_kernel("weighted_sum", 2, "a * v + b * w");

inline LaunchGrid vector_grid(const Tensor& t) {
  return LaunchGrid::items((t.size() + t.context().vector_width() - 1) / t.context().vector_width());
}

inline Tensor unary(const ElementwiseKernel& kernel, const Tensor& x, double a = 0, double b = 0) {
  Tensor out(x.context(), x.shape());
  x.context().launch("elementwise", kernel.name(), vector_grid(x), x, out, x.size(), KernelReal{a},
                     KernelReal{b});
  return out;
}

inline Tensor binary(const ElementwiseKernel& kernel, const Tensor& x, const Tensor& y, double a = 0,
                     double b = 0) {
  require(x.shape() == y.shape(), kernel.name(), ": shapes differ, ", x.shape(), " and ", y.shape());
  Tensor out(x.context(), x.shape());
  x.context().launch("elementwise", kernel.name(), vector_grid(x), x, y, out, x.size(), KernelReal{a},
                     KernelReal{b});
  return out;
}

}  // namespace detail

namespace detail {
/// Sets every number of a tensor, or of a view.
inline void fill(const Tensor& t, double value) {
  t.context().launch("elementwise", "fill", vector_grid(t), t, t.size(), KernelReal{value});
}
}  // namespace detail

/// A tensor with all elements equal to `value`.
inline Tensor full(const Context& context, Shape shape, double value) {
  Tensor out(context, std::move(shape));
  detail::fill(out, value);
  return out;
}
/// A constant of zeros.
inline Var zeros(const Context& context, Shape shape) {
  return Var::constant(full(context, std::move(shape), 0));
}
/// A constant of ones.
inline Var ones(const Context& context, Shape shape) {
  return Var::constant(full(context, std::move(shape), 1));
}

/// a*x + b, elementwise.
inline Var affine(const Var& x, double a, double b = 0) {
  return record("affine", {x}, detail::unary(detail::affine_kernel, x.value(), a, b),
                [a](const Node&, const Var& g, const Needs&) -> std::vector<Var> { return {affine(g, a)}; });
}

/// a*x + b*y, elementwise. Throws Error if the shapes differ.
inline Var weighted_sum(const Var& x, double a, const Var& y, double b) {
  return record("weighted_sum", {x, y},
                detail::binary(detail::weighted_sum_kernel, x.value(), y.value(), a, b),
                [a, b](const Node&, const Var& g, const Needs& needs) -> std::vector<Var> {
                  return {needs[0] ? (a == 1 ? g : affine(g, a)) : Var(),
                          needs[1] ? (b == 1 ? g : affine(g, b)) : Var()};
                });
}

/// Sums and differences of equal shapes, and multiples. Throw Error if the shapes differ.
/// \{
inline Var operator+(const Var& x, const Var& y) { return weighted_sum(x, 1, y, 1); }
inline Var operator-(const Var& x, const Var& y) { return weighted_sum(x, 1, y, -1); }
inline Var operator-(const Var& x) { return affine(x, -1); }
inline Var operator*(double a, const Var& x) { return affine(x, a); }
inline Var operator+(const Var& x, double b) { return affine(x, 1, b); }
inline Var operator-(const Var& x, double b) { return affine(x, 1, -b); }
/// \}

}  // namespace motiongan
