// The LSTM layer: values and first to third derivatives, against central differences and against the layer
// composed of elementary operations, in double.
#include <doctest/doctest.h>

#include <motiongan/ops/lstm.hpp>

#include "../support/check_grads.hpp"

namespace lstm_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr std::size_t batch = 2;

Tensor on_device(const Input& input) { return Tensor::from(double_context(), input.shape, input.values); }
Var constant(const Input& input) { return Var::constant(on_device(input)); }

/// Gates, recurrent weights, initial h, initial c.
std::vector<Input> layer_inputs(std::size_t frames, std::size_t k) {
  Input weights = randn({4 * k, k});
  for (double& v : weights.values) v /= std::sqrt(static_cast<double>(k));
  return {randn({frames, batch, 4 * k}), weights, randn({batch, k}), randn({batch, k})};
}

using Layer = std::function<Var(const Var&, const Var&, const Var&, const Var&)>;

Var fused(const Var& x, const Var& w, const Var& h, const Var& c) { return lstm_layer(x, w, h, c); }
Var composed(const Var& x, const Var& w, const Var& h, const Var& c) {
  return detail::lstm_layer_composed(x, w, h, c, {});
}

/// Gradient of <g, layer> with respect to the gates only, as in a gradient penalty. v: gates, weights, g.
Function gate_gradient_of(const Layer& layer, const Var& h_first, const Var& c_first) {
  return [=](const std::vector<Var>& v) {
    return grad({layer(v[0], v[1], h_first, c_first)}, {v[2]}, {v[0]}, {.create_graph = true})[0];
  };
}

void check_equal(const Var& found, const Var& expected, double tolerance) {
  const auto a = found.value().to_host<double>(), b = expected.value().to_host<double>();
  REQUIRE(a.size() == b.size());
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(b[i]));
    difference = std::max(difference, std::abs(a[i] - b[i]));
  }
  CHECK(largest > 0);
  CHECK(difference <= tolerance * largest);
}

}  // namespace

TEST_CASE("derivatives with respect to all four inputs: fused first, composed higher ones" *
          doctest::test_suite("double")) {
  for (std::size_t k : {3, 8, 17})
    for (std::size_t frames : {1, 2, 5}) {
      CAPTURE(k);
      CAPTURE(frames);
      const Function f = [](auto& v) { return lstm_layer(v[0], v[1], v[2], v[3]); };
      CHECK(check_grads(double_context(), f, layer_inputs(frames, k), k == 3 && frames < 5 ? 3 : 2) < 1e-7);
    }
}

TEST_CASE("derivatives of the gradient for the gates, with respect to gates, weights and seed" *
          doctest::test_suite("double")) {
  for (std::size_t k : {3, 8, 17})
    for (std::size_t frames : {1, 2, 5}) {
      CAPTURE(k);
      CAPTURE(frames);
      const auto in = layer_inputs(frames, k);
      const Var h = constant(in[2]), c = constant(in[3]);
      const std::vector<Input> at{in[0], in[1], randn({2, frames, batch, k})};
      CHECK(check_grads(double_context(), gate_gradient_of(fused, h, c), at, k == 3 ? 3 : 2) < 1e-7);
      // Against the composed form: the gradient, and its gradients for all three.
      std::vector<Var> v;
      for (const Input& input : at) v.push_back(Var::leaf(on_device(input)));
      const Var a = gate_gradient_of(fused, h, c)(v), b = gate_gradient_of(composed, h, c)(v);
      check_equal(a, b, 1e-12);
      const Var u = constant(randn(a.shape()));
      const auto of_a = grad({a}, {u}, v), of_b = grad({b}, {u}, v);
      for (std::size_t i = 0; i < v.size(); ++i) check_equal(of_a[i], of_b[i], 1e-12);
    }
}

TEST_CASE("a penalty on the gradient through two layers" * doctest::test_suite("double")) {
  const std::size_t frames = 4, k = 5;
  const auto first = layer_inputs(frames, k), second = layer_inputs(frames, k);
  const Var h = constant(first[2]), c = constant(first[3]);
  const auto penalty_of = [&](const Layer& layer) -> Function {
    return [=](const std::vector<Var>& v) {
      const Var inner = hidden_states(layer(v[0], v[1], h, c));
      const Var gates = reshape(matmul(reshape(inner, {frames * batch, k}), v[3]), {frames, batch, 4 * k});
      const Var score = sum(square(hidden_states(layer(gates, v[2], h, c))));
      const Var gradient = grad(score, {v[0]}, {.create_graph = true})[0];
      return mean(square(sqrt(sum_per_sample(square(gradient))) - 1));
    };
  };
  const std::vector<Input> at{first[0], first[1], second[1], randn({k, 4 * k})};
  CHECK(check_grads(double_context(), penalty_of(fused), at, 1) < 1e-7);
  std::vector<Var> v;
  for (const Input& input : at) v.push_back(Var::leaf(on_device(input)));
  const auto launches = [] { return double_context().statistics().launches; };
  const std::size_t start = launches();
  const auto a = grad(penalty_of(fused)(v), v);
  const std::size_t middle = launches();
  const auto b = grad(penalty_of(composed)(v), v);
  for (std::size_t i = 0; i < v.size(); ++i) check_equal(a[i], b[i], 1e-12);
  CHECK(middle - start < (launches() - middle) / 5);  // the fused kernels were used
}

TEST_CASE("second derivatives outside the fused form are composed, and correct" *
          doctest::test_suite("double")) {
  const std::size_t frames = 3, k = 3;
  const auto in = layer_inputs(frames, k);
  const Input seed = randn({2, frames, batch, k});
  SUBCASE("initial states with gradients") {
    const Function f = [](const std::vector<Var>& v) {
      return grad({lstm_layer(v[0], v[1], v[2], v[3])}, {v[4]}, {v[0]}, {.create_graph = true})[0];
    };
    CHECK(check_grads(double_context(), f, {in[0], in[1], in[2], in[3], seed}, 2) < 1e-7);
  }
  SUBCASE("samples of different lengths") {
    const Indices lengths(double_context(), std::vector<cl_int>{3, 1});
    const Function f = [&](const std::vector<Var>& v) {
      const Var states = lstm_layer(v[0], v[1], constant(in[2]), constant(in[3]), lengths);
      return grad({states}, {v[2]}, {v[0]}, {.create_graph = true})[0];
    };
    CHECK(check_grads(double_context(), f, {in[0], in[1], seed}, 2) < 1e-7);
  }
  SUBCASE("with respect to the weights") {
    const Function f = [&](const std::vector<Var>& v) {
      const Var states = lstm_layer(v[0], v[1], constant(in[2]), constant(in[3]));
      return grad({states}, {v[2]}, {v[1]}, {.create_graph = true})[0];
    };
    CHECK(check_grads(double_context(), f, {in[0], in[1], seed}, 2) < 1e-7);
  }
}

TEST_CASE("first derivatives with sequence lengths equal the composed form's" *
          doctest::test_suite("double")) {
  const std::size_t frames = 4, k = 5;
  const auto in = layer_inputs(frames, k);
  const Indices lengths(double_context(), std::vector<cl_int>{4, 2});
  std::vector<Var> v;
  for (const Input& input : in) v.push_back(Var::leaf(on_device(input)));
  const Var a = lstm_layer(v[0], v[1], v[2], v[3], lengths),
            b = detail::lstm_layer_composed(v[0], v[1], v[2], v[3], lengths);
  check_equal(a, b, 1e-13);
  const Var u = constant(randn(a.shape()));
  const auto of_a = grad({a}, {u}, v), of_b = grad({b}, {u}, v);
  for (std::size_t i = 0; i < v.size(); ++i) check_equal(of_a[i], of_b[i], 1e-12);
}

TEST_CASE("h only: the layer without cell states, to the third derivative" * doctest::test_suite("double")) {
  for (std::size_t frames : {1, 4}) {
    CAPTURE(frames);
    const std::size_t k = 3;
    const auto in = layer_inputs(frames, k);
    const Var zero = zeros(double_context(), {batch, k});
    const Function alone = [](auto& v) { return lstm_hidden(v[0], v[1]); };
    const Function taken = [&](auto& v) { return hidden_states(lstm_layer(v[0], v[1], zero, zero)); };
    CHECK(check_grads(double_context(), alone, {in[0], in[1]}, 3) < 1e-7);
    const auto gradient = [&](const Function& f) -> Function {
      return [&f](const std::vector<Var>& v) {
        return grad({f({v[0], v[1]})}, {v[2]}, {v[0]}, {.create_graph = true})[0];
      };
    };
    const std::vector<Input> at{in[0], in[1], randn({frames, batch, k})};
    CHECK(check_grads(double_context(), gradient(alone), at, 3) < 1e-7);
    std::vector<Var> v;
    for (const Input& input : at) v.push_back(Var::leaf(on_device(input)));
    const Var a = gradient(alone)(v), b = gradient(taken)(v);
    check_equal(a, b, 0);
    const Var u = constant(randn(a.shape()));
    const auto of_a = grad({a}, {u}, v), of_b = grad({b}, {u}, v);
    for (std::size_t i = 0; i < v.size(); ++i)
      if (frames > 1 || i != 1) check_equal(of_a[i], of_b[i], 0);
  }
}

}  // namespace lstm_test
