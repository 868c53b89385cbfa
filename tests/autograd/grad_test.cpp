// grad(): results, skipped work, errors.
#include <doctest/doctest.h>

#include <motiongan/core/random.hpp>
#include <motiongan/ops/conv1d.hpp>
#include <motiongan/ops/lstm.hpp>
#include <numeric>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace grad_test {

using namespace motiongan;
using testing::double_context;

namespace {

Var leaf(std::vector<double> values) {
  const std::size_t n = values.size();
  return Var::leaf(Tensor::from(double_context(), {n}, values));
}
Var constant(std::vector<double> values) { return leaf(std::move(values)).detach(); }
std::vector<double> host(const Var& v) { return v.value().to_host<double>(); }

/// The identity; `asked` counts how often its derivative was computed.
Var watched(const Var& x, int& asked) {
  return record("watched", {x}, x.value(),
                [&asked](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  ++asked;
                  return {g};
                });
}

void check_near(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-12));
}

}  // namespace

TEST_CASE("a result requires a gradient if an input does" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2}), c = constant({3, 4});
  CHECK(x.requires_grad());
  CHECK_FALSE(c.requires_grad());
  CHECK((x + c).requires_grad());
  CHECK((c * x).requires_grad());
  CHECK_FALSE((c + c).requires_grad());
  CHECK_FALSE((x + c).detach().requires_grad());
  CHECK_FALSE(Var().requires_grad());
  CHECK((c + c).node()->inputs.empty());
}

TEST_CASE("NoGrad disables recording within its scope" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2});
  {
    const NoGrad scope;
    const Var y = x * x;
    CHECK_FALSE(y.requires_grad());
    CHECK(y.node()->inputs.empty());
    CHECK_FALSE(y.node()->vjp);
    CHECK(host(y) == std::vector<double>{1, 4});
    {
      const NoGrad inner;
      const NoGrad off(false);  // does not re-enable recording
      CHECK_FALSE((x + x).requires_grad());
    }
    CHECK_FALSE((x + x).requires_grad());
  }
  CHECK((x * x).requires_grad());
}

TEST_CASE("seeds: ones by default, weights if given, shapes checked" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2, 3});
  check_near(host(grad(square(x), {x})[0]), {2, 4, 6});
  check_near(host(grad({square(x)}, {constant({1, 10, 100})}, {x})[0]), {2, 40, 600});
  check_near(host(grad({square(x), 5 * x}, {Var(), constant({1, 0, 2})}, {x})[0]), {7, 4, 16});
  CHECK_THROWS_WITH_AS(grad({square(x)}, {constant({1, 2})}, {x}), "grad: the seed is [2], the output [3]",
                       Error);
  CHECK_THROWS_WITH_AS(grad({square(x)}, {}, {x}), "grad: 1 outputs but 0 seeds", Error);
}

TEST_CASE("no gradient with respect to a constant" * doctest::test_suite("double")) {
  const Var x = leaf({1}), c = constant({2});
  CHECK_THROWS_AS(grad(x * c, {c}), Error);
  CHECK_THROWS_AS(grad(x * c, {x.detach()}), Error);
  CHECK_THROWS_AS(grad(x * x, {Var()}), Error);
}

TEST_CASE("an unused input has a zero gradient" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2}), unused = leaf({5, 6, 7});
  const std::vector<Var> g = grad(square(x), {x, unused});
  check_near(host(g[0]), {2, 4});
  CHECK(host(g[1]) == std::vector<double>{0, 0, 0});
  const Var y = square(x), later = square(leaf({1, 2}));  // newer than the output
  CHECK(host(grad(y, {later})[0]) == std::vector<double>{0, 0});
}

TEST_CASE("no gradient of a constant" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2});
  const auto message = [&](const Var& output) {
    return testing::message_of([&] { grad({square(x), output}, {Var(), Var()}, {x}); });
  };
  Var unrecorded;
  {
    const NoGrad scope;
    unrecorded = square(x);
  }
  for (const Var& output : {constant({3}), square(constant({3, 4})), square(x).detach(), unrecorded}) {
    CHECK(
        testing::says(message(output), concat("grad: output 1 of shape ", output.shape(), " is a constant")));
    CHECK(testing::says(message(output), "compute it from a Var::leaf outside of NoGrad"));
    CHECK_THROWS_AS(grad(output, {x}), Error);
  }
  CHECK_THROWS_AS(grad(Var(), {x}), Error);
}

TEST_CASE("derivatives of a polynomial past its degree are zero" * doctest::test_suite("double")) {
  const Var x = leaf({2, -1}), other = leaf({5});
  std::vector<std::vector<double>> orders;
  Var d = 3 * square(x);
  for (int order = 1; order <= 4; ++order) {
    d = grad(d, {x}, {.create_graph = true})[0];
    orders.push_back(host(d));
  }
  CHECK(orders == std::vector<std::vector<double>>{{12, -6}, {6, 6}, {0, 0}, {0, 0}});
  // A penalty on the slope of a linear function.
  const Var slope = grad(2 * x, {x}, {.create_graph = true})[0];
  CHECK(host(grad(sum(square(slope - 1)), {x})[0]) == std::vector<double>{0, 0});
  CHECK(host(grad(grad(x * x, {other}, {.create_graph = true})[0], {other})[0]) == std::vector<double>{0});
}

TEST_CASE("outputs and intermediate values can be inputs" * doctest::test_suite("double")) {
  const Var x = leaf({3}), y = square(x), z = square(y);
  CHECK(host(grad(z, {z})[0]) == std::vector<double>{1});
  const std::vector<Var> g = grad(z, {y, x, z});
  check_near(host(g[0]), {18});
  check_near(host(g[1]), {108});
  check_near(host(g[2]), {1});
}

TEST_CASE("the gradients of a value used several times add up" * doctest::test_suite("double")) {
  const Var x = leaf({2});
  check_near(host(grad(x * x * x, {x})[0]), {12});
  check_near(host(grad(x + x + x, {x})[0]), {3});
  const Var y = tanh(x);
  check_near(host(grad(y * y + 3 * y, {x})[0]), {(2 * std::tanh(2) + 3) * (1 - std::tanh(2) * std::tanh(2))});
  check_near(host(grad({y, y}, {Var(), Var()}, {y})[0]), {2});
  check_near(host(grad(x * x, {x, x})[1]), {4});
}

TEST_CASE("branches without a requested input are skipped" * doctest::test_suite("double")) {
  int left = 0, right = 0;
  const Var a = leaf({1, 2}), b = leaf({3, 4});
  const Var z = watched(square(a), left) * watched(square(b), right);
  grad(z, {a});
  CHECK(left == 1);
  CHECK(right == 0);
  grad(z, {a, b});
  CHECK(left == 2);
  CHECK(right == 1);

  // An op knows which gradients are needed, and nodes older than the requested input are not visited.
  const Var middle = watched(square(a), left), end = square(middle);
  left = 0;
  grad(end, {middle});
  CHECK(left == 0);
  const auto launches = [](const auto& action) {
    const std::size_t before = double_context().statistics().launches;
    action();
    return double_context().statistics().launches - before;
  };
  const Var product = a * b;
  const std::size_t one = launches([&] { grad(product, {a}); }), both = launches([&] {
                                                                   grad(product, {a, b});
                                                                 });
  CHECK(one == 2);   // the seed and g * b
  CHECK(both == 3);  // and g * a
}

TEST_CASE("the result has a graph only with create_graph" * doctest::test_suite("double")) {
  const Var x = leaf({0.5, -1});
  const Var plain = grad(x * x * x, {x})[0];
  CHECK_FALSE(plain.requires_grad());
  CHECK(plain.node()->inputs.empty());
  CHECK_THROWS_AS(grad(leaf({1}) * leaf({1}), {plain}), Error);
  const Var gradient = grad(x * x * x, {x}, {.create_graph = true})[0];
  CHECK(gradient.requires_grad());
  check_near(host(grad(gradient, {x})[0]), {3, -6});
  const NoGrad scope;  // recording is off for the backward pass too
  CHECK_FALSE(grad(gradient, {x}, {.create_graph = true})[0].requires_grad());
}

TEST_CASE("third derivative of x^2 exp(a x)" * doctest::test_suite("double")) {
  const double a = 0.7;
  const std::vector<double> at{-1.3, 0, 0.4, 2};
  const Var x = leaf(at);
  Var d = x * x * exp(a * x);
  for (int order = 1; order <= 3; ++order) d = grad(d, {x}, {.create_graph = order < 3})[0];
  std::vector<double> expected;
  for (double v : at) expected.push_back(std::exp(a * v) * (a * a * a * v * v + 6 * a * a * v + 6 * a));
  check_near(host(d), expected);
}

TEST_CASE("mixed derivatives do not depend on the order" * doctest::test_suite("double")) {
  const Var x = leaf({0.3, -0.8}), y = leaf({1.1, 0.4});
  const Var f = tanh(x * y) * exp(x - y);
  const Var by_x = grad(f, {x}, {.create_graph = true})[0], by_y = grad(f, {y}, {.create_graph = true})[0];
  check_near(host(grad(by_x, {y})[0]), host(grad(by_y, {x})[0]));
}

TEST_CASE("an op's derivative of the wrong shape is rejected" * doctest::test_suite("double")) {
  const Var x = leaf({1, 2});
  const Var y = record("crooked", {x}, x.value(),
                       [](const Node&, const Var& g, const Needs&) -> std::vector<Var> { return {sum(g)}; });
  CHECK_THROWS_WITH_AS(grad(y, {x}), "gradient of crooked, input 0, has shape [1], expected [2]", Error);
}

TEST_CASE("an empty Var") { CHECK_THROWS_WITH_AS(Var().value(), "an empty Var has no value", Error); }

TEST_CASE("gradients of two runs are equal bit for bit") {
  const auto run = [] {
    const Context context;
    const auto random = [&](RandomStream stream, std::size_t a, std::size_t b, std::size_t c) {
      return Var::leaf(random_normal(context, {.seed = 5, .stream = stream}, a, b, c));
    };
    const Var x = random(RandomStream::noise, 17, 5, 33), w = random(RandomStream::noise + 1, 3, 20, 33),
              bias = reshape(random(RandomStream::noise + 2, 1, 1, 20), {20});
    const Var y = conv1d(x, w, {-1, 0, 1}, 17, false, {.bias = bias, .relu = true});
    const Var gradient = grad(mean(square(y)), {x}, {.create_graph = true})[0];
    std::vector<std::vector<float>> all;
    for (const Var& g : grad(sum(sqrt(square(gradient) + 1e-12)), {x, w, bias}))
      all.push_back(g.value().to_host());
    return all;
  };
  const auto first = run();
  CHECK(run() == first);
  CHECK(testing::dot({first[1].begin(), first[1].end()}, {first[1].begin(), first[1].end()}) > 0);
}

}  // namespace grad_test
