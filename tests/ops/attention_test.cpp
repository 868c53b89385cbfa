// Self-attention along time: values, derivatives against differences, gamma = 0.
#include <doctest/doctest.h>

#include <motiongan/core/random.hpp>
#include <motiongan/nn/self_attention.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace attention_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// A layer with non-zero gamma.
SelfAttention made(std::size_t channels, double gamma) {
  Initializer init(double_context(), 3);
  SelfAttention layer(init, channels);
  layer.gamma = init.constant({1}, gamma);
  return layer;
}

Var random(std::size_t frames, std::size_t batch, std::size_t channels, std::uint64_t seed = 1) {
  return Var::constant(random_normal(double_context(), {.seed = seed}, frames, batch, channels));
}

}  // namespace

TEST_CASE("frame products, sample by sample" * doctest::test_suite("double")) {
  // Two samples of one channel: the product of each frame of a with each frame of c.
  const Var a = Var::constant(Tensor::from(double_context(), {2, 2, 1}, std::vector<double>{1, 10, 2, 20}));
  const Var c =
      Var::constant(Tensor::from(double_context(), {3, 2, 1}, std::vector<double>{1, 1, 3, 5, 4, 6}));
  const Var map = attention_scores(a, c);
  CHECK(map.shape() == Shape{2, 2, 3});
  CHECK(map.value().to_host<double>() == std::vector<double>{1, 3, 4, 2, 6, 8, 10, 50, 60, 20, 100, 120});
  CHECK(attention_apply(map, c).value().to_host<double>() ==
        std::vector<double>{1 + 9 + 16, 10 + 250 + 360, 2 + 18 + 32, 20 + 500 + 720});
  CHECK(attention_apply(map, a, true).shape() == Shape{3, 2, 1});
  CHECK(attention_apply(map, a, true).value().to_host<double>().front() == 1 + 4);
  CHECK(message_of([&] {
          attention_scores(a, random(2, 3, 1));
        }).starts_with("attention_scores: shapes [2, 2, 1]"));
  CHECK(message_of([&] {
          attention_apply(map, a);
        }).starts_with("attention_apply: a map [2, 2, 3] over frames [2, 2, 1]"));
}

TEST_CASE("rows of an attention map sum to one" * doctest::test_suite("double")) {
  const Var map = attention_map(random(4, 2, 3, 1), random(5, 2, 3, 2));
  CHECK(map.shape() == Shape{2, 5, 4});
  for (const double total : sum(map, -1).value().to_host<double>()) CHECK(total == doctest::Approx(1));
}

TEST_CASE("first, second and third derivatives" * doctest::test_suite("double")) {
  const auto check = [](const Function& f, const std::vector<Input>& at) {
    CHECK(check_grads(double_context(), f, at, 3) < 1e-7);
  };
  const Input a = randn({3, 2, 4}), c = randn({5, 2, 4}), map = randn({2, 3, 5});
  check([](auto& v) { return square(attention_scores(v[0], v[1])); }, {a, c});
  check([](auto& v) { return square(attention_apply(v[0], v[1])); }, {map, c});
  check([](auto& v) { return square(attention_apply(v[0], v[1], true)); }, {map, a});
  check([](auto& v) { return attention_apply(attention_map(v[0], v[1]), v[0]) * v[1]; },
        {c, randn({5, 2, 4})});
}

TEST_CASE("the layer's derivatives with respect to input and parameters" * doctest::test_suite("double")) {
  SelfAttention layer = made(8, 0.7);
  std::vector<Input> at{randn({4, 2, 8})};
  std::vector<Shape> shapes;
  for (const NamedParameter& p : named_parameters(layer)) at.push_back(randn(p.value->shape()));
  const Function f = [&](const std::vector<Var>& v) {
    SelfAttention moved = layer;
    const auto parameters = named_parameters(moved);
    for (std::size_t i = 0; i < parameters.size(); ++i) *parameters[i].value = 0.3 * v[i + 1];  // mild maps
    return square(moved(v[0]));
  };
  CHECK(check_grads(double_context(), f, at, 2) < 1e-7);
}

TEST_CASE("with gamma 0 the layer is the identity, and only gamma has a gradient" *
          doctest::test_suite("double")) {
  Initializer init(double_context(), 3);
  SelfAttention layer(init, 16);
  CHECK(layer.gamma.item() == 0);
  CHECK(layer.query.weight.shape() == Shape{1, 2, 16});
  const Var x = random(6, 2, 16);
  CHECK(layer(x).value().to_host<double>() == x.value().to_host<double>());
  const auto parameters = named_parameters(layer);
  const auto gradients = grad(sum(square(layer(x))), values_of(parameters));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    double largest = 0;
    for (const double g : gradients[i].value().to_host<double>()) largest = std::max(largest, std::abs(g));
    CAPTURE(parameters[i].name);
    CHECK((largest > 0) == (parameters[i].name == "gamma"));
  }
}

}  // namespace attention_test
