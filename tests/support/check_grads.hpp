// Checks derivatives of any order against central differences.
#pragma once
#include <motiongan/autograd/grad.hpp>
#include <random>

#include "precision.hpp"

namespace motiongan::testing {

using Function = std::function<Var(const std::vector<Var>&)>;

struct Input {
  Shape shape;
  std::vector<double> values;
};

inline std::mt19937_64& generator() {
  static std::mt19937_64 g(20240229);
  return g;
}

/// Normally distributed values, at least `gap` away from `shift`, for functions with a kink there.
inline Input randn(Shape shape, double gap = 0, double shift = 0) {
  std::normal_distribution<double> normal;
  std::vector<double> values(element_count(shape));
  for (double& v : values) {
    v = normal(generator());
    v += (v < 0 ? -gap : gap) + shift;
  }
  return {std::move(shape), std::move(values)};
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double s = 0;
  for (std::size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
  return s;
}

/// The largest relative error of the derivative of <u, f(x)> in a random direction, over all inputs and all
/// orders up to `order`. Higher orders are checked by recursion on the gradient.
inline double check_grads(const Context& context, const Function& f, const std::vector<Input>& at, int order,
                          double step = 1e-4) {
  const auto leaves = [&](const std::vector<Input>& inputs) {
    std::vector<Var> vars;
    for (const Input& i : inputs) vars.push_back(Var::leaf(Tensor::from(context, i.shape, i.values)));
    return vars;
  };
  const std::vector<Var> xs = leaves(at);
  const Var y = f(xs);
  const Input u = randn(y.shape());
  const std::vector<Var> gradients = grad({y}, {Var::constant(Tensor::from(context, u.shape, u.values))}, xs);
  double worst = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const Input direction = randn(at[k].shape);
    const auto moved = [&](double h) {
      std::vector<Input> there = at;
      for (std::size_t i = 0; i < there[k].values.size(); ++i) there[k].values[i] += h * direction.values[i];
      return dot(u.values, f(leaves(there)).value().to_host<double>());
    };
    // Richardson extrapolation of two central differences: a fourth-order error.
    const double wide = (moved(step) - moved(-step)) / (2 * step),
                 narrow = (moved(step / 2) - moved(-step / 2)) / step;
    const double numeric = (4 * narrow - wide) / 3,
                 exact = dot(gradients[k].value().to_host<double>(), direction.values);
    worst = std::max(worst, std::abs(numeric - exact) / (1e-3 + std::abs(numeric) + std::abs(exact)));
  }
  if (order > 1)
    for (std::size_t k = 0; k < at.size(); ++k) {
      std::vector<Input> with_seed = at;
      with_seed.push_back(randn(y.shape()));
      const Function derivative = [&](const std::vector<Var>& inputs) {
        const std::vector<Var> x(inputs.begin(), inputs.end() - 1);
        return grad({f(x)}, {inputs.back()}, x, {.create_graph = true})[k];
      };
      worst = std::max(worst, check_grads(context, derivative, with_seed, order - 1, step));
    }
  return worst;
}

}  // namespace motiongan::testing
