// Differentiable elementwise operations; binary ones throw Error if the shapes differ.
#pragma once
#include "motiongan/autograd/arithmetic.hpp"
#include "motiongan/core/gemm.hpp"

namespace motiongan {

namespace detail {
inline const ElementwiseKernel product_kernel("product", 2, "v * w");
inline const ElementwiseKernel quotient_kernel("quotient", 2, "v / w");
inline const ElementwiseKernel tanh_of_kernel("tanh_of", 1, "tanh(v)");
inline const ElementwiseKernel sigmoid_of_kernel("sigmoid_of", 1, "1 / (1 + exp(-v))");
inline const ElementwiseKernel exp_of_kernel("exp_of", 1, "exp(v)");
inline const ElementwiseKernel log_of_kernel("log_of", 1, "log(v)");
inline const ElementwiseKernel sqrt_of_kernel("sqrt_of", 1, "sqrt(v)");
// Gradients in terms of the function's value w; v is the incoming gradient.
inline const ElementwiseKernel leaky_relu_grad_kernel("leaky_relu_grad", 2, "w > 0 ? v : a * v");
inline const ElementwiseKernel tanh_grad_kernel("tanh_grad", 2, "v * (1 - w * w)");
inline const ElementwiseKernel sigmoid_grad_kernel("sigmoid_grad", 2, "v * w * (1 - w)");
}  // namespace detail

/// The product, element by element. Throws Error if the shapes differ.
inline Var operator*(const Var& x, const Var& y) {
  return record("product", {x, y}, detail::binary(detail::product_kernel, x.value(), y.value()),
                [](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  return {needs[0] ? g * self.inputs[1] : Var(), needs[1] ? g * self.inputs[0] : Var()};
                });
}

/// The quotient, element by element. Throws Error if the shapes differ.
inline Var operator/(const Var& x, const Var& y) {
  return record("quotient", {x, y}, detail::binary(detail::quotient_kernel, x.value(), y.value()),
                [](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var scaled = g / self.inputs[1];
                  return {scaled, needs[1] ? -(scaled * (self.inputs[0] / self.inputs[1])) : Var()};
                });
}

/// The square of each element.
inline Var square(const Var& x) { return x * x; }

namespace detail {
/// g where y > 0, slope*g elsewhere. Linear in g; the derivative with respect to y is zero.
inline Var leaky_relu_grad(const Var& g, const Tensor& y, double slope) {
  return record("leaky_relu_grad", {g}, binary(leaky_relu_grad_kernel, g.value(), y, slope),
                [y, slope](const Node&, const Var& u, const Needs&) -> std::vector<Var> {
                  return {leaky_relu_grad(u, y, slope)};
                });
}
}  // namespace detail

/// x where x > 0, slope*x elsewhere (slope >= 0).
inline Var leaky_relu(const Var& x, double slope) {
  return record("leaky_relu", {x}, detail::unary(detail::leaky_relu_kernel, x.value(), slope),
                [slope](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::leaky_relu_grad(g, self.value, slope)};
                });
}
/// max(x, 0).
inline Var relu(const Var& x) { return leaky_relu(x, 0); }

namespace detail {
/// g * (1 - y^2), the gradient of tanh in terms of its value y; differentiable in g and y.
inline Var tanh_grad(const Var& g, const Var& y) {
  return record("tanh_grad", {g, y}, binary(tanh_grad_kernel, g.value(), y.value()),
                [](const Node& self, const Var& u, const Needs& needs) -> std::vector<Var> {
                  const Var &gi = self.inputs[0], &yi = self.inputs[1];
                  return {needs[0] ? tanh_grad(u, yi) : Var(), needs[1] ? -2 * (u * gi * yi) : Var()};
                });
}
/// g * y * (1 - y), the same for the sigmoid.
inline Var sigmoid_grad(const Var& g, const Var& y) {
  return record(
      "sigmoid_grad", {g, y}, binary(sigmoid_grad_kernel, g.value(), y.value()),
      [](const Node& self, const Var& u, const Needs& needs) -> std::vector<Var> {
        const Var &gi = self.inputs[0], &yi = self.inputs[1];
        return {needs[0] ? sigmoid_grad(u, yi) : Var(), needs[1] ? u * gi * affine(yi, -2, 1) : Var()};
      });
}
/// This node as a Var, for derivatives that are functions of its value.
inline Var itself(const Node& node) { return Var(std::const_pointer_cast<Node>(node.shared_from_this())); }
}  // namespace detail

/// The hyperbolic tangent of each element.
inline Var tanh(const Var& x) {
  return record("tanh", {x}, detail::unary(detail::tanh_of_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::tanh_grad(g, detail::itself(self))};
                });
}

/// 1 / (1 + exp(-x)).
inline Var sigmoid(const Var& x) {
  return record("sigmoid", {x}, detail::unary(detail::sigmoid_of_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::sigmoid_grad(g, detail::itself(self))};
                });
}

/// The exponential of each element.
inline Var exp(const Var& x) {
  return record("exp", {x}, detail::unary(detail::exp_of_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {g * detail::itself(self)};
                });
}

/// The natural logarithm of each element.
inline Var log(const Var& x) {
  return record(
      "log", {x}, detail::unary(detail::log_of_kernel, x.value()),
      [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> { return {g / self.inputs[0]}; });
}

/// The square root of each element.
inline Var sqrt(const Var& x) {
  return record("sqrt", {x}, detail::unary(detail::sqrt_of_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {0.5 * (g / detail::itself(self))};
                });
}

}  // namespace motiongan
