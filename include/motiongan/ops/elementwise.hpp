// Functions number by number, with their derivatives.
#pragma once
#include "motiongan/autograd/var.hpp"

namespace motiongan {

namespace detail {

inline Grid vector_grid(const Tensor& t) {
  return Grid::items((t.size() + t.context().vector_width() - 1) / t.context().vector_width());
}

inline Tensor unary(const char* kernel, const Tensor& x, double a = 0, double b = 0) {
  Tensor out(x.context(), x.shape());
  x.context().launch("elementwise", kernel, vector_grid(x), x, out, x.size(), Real{a}, Real{b});
  return out;
}

inline Tensor binary(const char* kernel, const Tensor& x, const Tensor& y, double a = 0, double b = 0) {
  require(x.shape() == y.shape(), kernel, ": shapes differ, ", x.shape(), " and ", y.shape());
  Tensor out(x.context(), x.shape());
  x.context().launch("elementwise", kernel, vector_grid(x), x, y, out, x.size(), Real{a}, Real{b});
  return out;
}

}  // namespace detail

/// A tensor filled with one value.
inline Tensor filled(const Context& context, Shape shape, double value) {
  Tensor out(context, std::move(shape));
  context.launch("elementwise", "fill", detail::vector_grid(out), out, out.size(), Real{value});
  return out;
}
inline Var zeros(const Context& context, Shape shape) {
  return Var::constant(filled(context, std::move(shape), 0));
}
inline Var ones(const Context& context, Shape shape) {
  return Var::constant(filled(context, std::move(shape), 1));
}

/// a*x + b
inline Var affine(const Var& x, double a, double b = 0) {
  return record("affine", {x}, detail::unary("affine", x.value(), a, b),
                [a](const Node&, const Var& g, const Needs&) -> std::vector<Var> { return {affine(g, a)}; });
}

/// a*x + b*y
inline Var weighted_sum(const Var& x, double a, const Var& y, double b) {
  return record("weighted_sum", {x, y}, detail::binary("axpby", x.value(), y.value(), a, b),
                [a, b](const Node&, const Var& g, const Needs& needs) -> std::vector<Var> {
                  return {needs[0] ? (a == 1 ? g : affine(g, a)) : Var(),
                          needs[1] ? (b == 1 ? g : affine(g, b)) : Var()};
                });
}

inline Var operator+(const Var& x, const Var& y) { return weighted_sum(x, 1, y, 1); }
inline Var operator-(const Var& x, const Var& y) { return weighted_sum(x, 1, y, -1); }
inline Var operator-(const Var& x) { return affine(x, -1); }
inline Var operator*(double a, const Var& x) { return affine(x, a); }
inline Var operator+(const Var& x, double b) { return affine(x, 1, b); }
inline Var operator-(const Var& x, double b) { return affine(x, 1, -b); }

inline Var operator*(const Var& x, const Var& y) {
  return record("product", {x, y}, detail::binary("product", x.value(), y.value()),
                [](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  return {needs[0] ? g * self.inputs[1] : Var(), needs[1] ? g * self.inputs[0] : Var()};
                });
}

inline Var operator/(const Var& x, const Var& y) {
  return record("quotient", {x, y}, detail::binary("quotient", x.value(), y.value()),
                [](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var scaled = g / self.inputs[1];
                  return {scaled, needs[1] ? -(scaled * (self.inputs[0] / self.inputs[1])) : Var()};
                });
}

inline Var square(const Var& x) { return x * x; }

namespace detail {
/// g where y > 0, slope*g elsewhere: linear in g; y only chooses, its derivative is zero.
inline Var leaky_relu_grad(const Var& g, const Tensor& y, double slope) {
  return record("leaky_relu_grad", {g}, binary("leaky_relu_grad", g.value(), y, slope),
                [y, slope](const Node&, const Var& u, const Needs&) -> std::vector<Var> {
                  return {leaky_relu_grad(u, y, slope)};
                });
}
}  // namespace detail

/// x where x > 0, slope*x elsewhere (slope >= 0).
inline Var leaky_relu(const Var& x, double slope) {
  return record("leaky_relu", {x}, detail::unary("leaky_relu", x.value(), slope),
                [slope](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::leaky_relu_grad(g, self.value, slope)};
                });
}
inline Var relu(const Var& x) { return leaky_relu(x, 0); }

namespace detail {
/// g * (1 - y^2), the derivative of tanh by its value y, itself differentiable by both.
inline Var tanh_grad(const Var& g, const Var& y) {
  return record("tanh_grad", {g, y}, binary("tanh_grad", g.value(), y.value()),
                [](const Node& self, const Var& u, const Needs& needs) -> std::vector<Var> {
                  const Var &gi = self.inputs[0], &yi = self.inputs[1];
                  return {needs[0] ? tanh_grad(u, yi) : Var(), needs[1] ? -2 * (u * gi * yi) : Var()};
                });
}
/// g * y * (1 - y), likewise for the sigmoid.
inline Var sigmoid_grad(const Var& g, const Var& y) {
  return record(
      "sigmoid_grad", {g, y}, binary("sigmoid_grad", g.value(), y.value()),
      [](const Node& self, const Var& u, const Needs& needs) -> std::vector<Var> {
        const Var &gi = self.inputs[0], &yi = self.inputs[1];
        return {needs[0] ? sigmoid_grad(u, yi) : Var(), needs[1] ? u * gi * affine(yi, -2, 1) : Var()};
      });
}
/// This node as a Var, for derivatives that are functions of the value itself.
inline Var itself(const Node& node) { return Var(std::const_pointer_cast<Node>(node.shared_from_this())); }
}  // namespace detail

inline Var tanh(const Var& x) {
  return record("tanh", {x}, detail::unary("tanh_of", x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::tanh_grad(g, detail::itself(self))};
                });
}

inline Var sigmoid(const Var& x) {
  return record("sigmoid", {x}, detail::unary("sigmoid_of", x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {detail::sigmoid_grad(g, detail::itself(self))};
                });
}

inline Var exp(const Var& x) {
  return record("exp", {x}, detail::unary("exp_of", x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {g * detail::itself(self)};
                });
}

inline Var log(const Var& x) {
  return record(
      "log", {x}, detail::unary("log_of", x.value()),
      [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> { return {g / self.inputs[0]}; });
}

inline Var sqrt(const Var& x) {
  return record("sqrt", {x}, detail::unary("sqrt_of", x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {0.5 * (g / detail::itself(self))};
                });
}

}  // namespace motiongan
