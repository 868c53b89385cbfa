// Initial weights: PyTorch's distributions, and independence.
#include <doctest/doctest.h>

#include <algorithm>
#include <motiongan/nn/text_encoder.hpp>

namespace initialization_test {

using namespace motiongan;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

/// Within [-bound, bound], reaching close to both ends, with the mean and variance of a uniform distribution.
void check_uniform(const Var& v, double bound) {
  const std::vector<float> x = v.value().to_host();
  const double n = static_cast<double>(x.size());
  double mean = 0, square = 0;
  for (double value : x) {
    mean += value / n;
    square += value * value / n;
  }
  const double variance = bound * bound / 3;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  CHECK(*low >= -static_cast<float>(bound));
  CHECK(*high <= static_cast<float>(bound));
  CHECK(*low < -bound * (1 - 20 / n));
  CHECK(*high > bound * (1 - 20 / n));
  CHECK(std::abs(mean) < 5 * std::sqrt(variance / n));
  CHECK(std::abs(square - variance) < 5 * variance * std::sqrt(0.8 / n));
}

}  // namespace

TEST_CASE("Linear and Conv1d: uniform within 1 / sqrt(fan_in)") {
  Initializer init(context(), 1);
  const Conv1d conv(init, 40, 500, 5);
  check_uniform(conv.weight, 1 / std::sqrt(200.0));
  check_uniform(conv.bias, 1 / std::sqrt(200.0));
  const Linear linear(init, 100, 300);
  check_uniform(linear.weight, 0.1);
  check_uniform(linear.bias, 0.1);
}

TEST_CASE("LSTM: uniform within 1 / sqrt(hidden), both layers") {
  Initializer init(context(), 2);
  const Lstm lstm(init, 30, 64, 2);
  CHECK(lstm.hidden() == 64);
  REQUIRE(lstm.layers.size() == 2);
  for (std::size_t l = 0; l < 2; ++l) {
    const Lstm::Layer& layer = lstm.layers[l];
    CHECK(layer.weight_ih.shape() == Shape{256, l == 0 ? 30u : 64u});
    CHECK(layer.weight_hh.shape() == Shape{256, 64});
    for (const Var& v : {layer.weight_ih, layer.weight_hh, layer.bias_ih, layer.bias_hh})
      check_uniform(v, 0.125);
  }
}

TEST_CASE("Embedding: standard normal") {
  Initializer init(context(), 3);
  const std::vector<float> x = Embedding(init, 400, 200).weight.value().to_host();
  const double n = static_cast<double>(x.size());
  double mean = 0, square = 0;
  for (double v : x) {
    mean += v / n;
    square += v * v / n;
  }
  CHECK(x.size() == 80'000);
  CHECK(std::abs(mean) < 5 / std::sqrt(n));
  CHECK(std::abs(square - 1) < 5 * std::sqrt(2 / n));
}

TEST_CASE("equal seeds give equal weights, other seeds others, and no two arrays are equal") {
  const auto weights = [](std::uint64_t seed) {
    Initializer init(context(), seed);
    TextEncoder encoder(init, 10, 16);
    std::vector<std::vector<float>> all;
    for (const NamedParameter& p : named_parameters(encoder)) all.push_back(p.value->value().to_host());
    return all;
  };
  const auto a = weights(7), b = weights(8);
  CHECK(weights(7) == a);
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i] != b[i]);
    for (std::size_t j = 0; j < i; ++j)
      CHECK_FALSE(std::equal(a[i].begin(), a[i].begin() + 16, a[j].begin()));
  }
}

TEST_CASE("initial weights in double equal those in float" * doctest::test_suite("double")) {
  const Context doubles({.precision = Precision::f64});
  Initializer a(context(), 5), b(doubles, 5);
  CHECK(Linear(a, 7, 9).weight.value().to_host<double>() == Linear(b, 7, 9).weight.value().to_host<double>());
}

TEST_CASE("parameters are leaves") {
  Initializer init(context(), 1);
  TextEncoder encoder(init, 5, 8);
  const auto parameters = named_parameters(encoder);
  CHECK(parameters.size() == 11);
  for (const NamedParameter& p : parameters) CHECK(p.value->requires_grad());
  CHECK(parameter_count(parameters) == 5 * 8 + 2 * (2 * 32 * 8 + 2 * 32) + 8 * 32 + 8);
}

}  // namespace initialization_test
