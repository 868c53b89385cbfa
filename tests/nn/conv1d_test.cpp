// Convolutions along time against plain loops.
#include <doctest/doctest.h>

#include <motiongan/networks/residual.hpp>
#include <motiongan/nn/linear.hpp>
#include <motiongan/ops/reduce.hpp>

#include "../support/check_grads.hpp"

namespace conv1d_test {

using namespace motiongan;
using testing::double_context;

namespace {

/// PyTorch's Conv1d with stride 1 and zero "same" padding; x [T, B, in], weight [taps, out, in].
std::vector<double> plain_conv(const Tensor& x, const Tensor& weight, const Tensor& bias) {
  const std::size_t frames = x.dim(0), batch = x.dim(1), in = x.dim(2), taps_count = weight.dim(0),
                    out = weight.dim(1);
  const std::vector<double> xs = x.to_host<double>(), ws = weight.to_host<double>(),
                            bs = bias.to_host<double>();
  std::vector<double> y(frames * batch * out);
  for (std::size_t t = 0; t < frames; ++t)
    for (std::size_t b = 0; b < batch; ++b)
      for (std::size_t o = 0; o < out; ++o) {
        double sum = bs[o];
        for (std::size_t s = 0; s < taps_count; ++s) {
          const long from = static_cast<long>(t + s) - static_cast<long>(taps_count / 2);
          if (from < 0 || from >= static_cast<long>(frames)) continue;
          for (std::size_t i = 0; i < in; ++i)
            sum += ws[(s * out + o) * in + i] * xs[(static_cast<std::size_t>(from) * batch + b) * in + i];
        }
        y[(t * batch + b) * out + o] = sum;
      }
  return y;
}

void check_near(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) worst = std::max(worst, std::abs(found[i] - expected[i]));
  CHECK(worst < 1e-12);
}

Var random(std::size_t frames, std::size_t batch, std::size_t channels) {
  return Var::constant(random_normal(double_context(), {.seed = 11}, frames, batch, channels));
}

}  // namespace

TEST_CASE("Conv1d matches PyTorch, for 1, 3, 5 and 7 taps and from one frame" *
          doctest::test_suite("double")) {
  Initializer init(double_context(), 1);
  for (std::size_t taps_count : {1, 3, 5, 7})
    for (std::size_t frames : {1, 2, 3, 4, 8, 13}) {
      CAPTURE(taps_count);
      CAPTURE(frames);
      const Conv1d conv(init, 6, 5, taps_count);
      const Var x = random(frames, 3, 6);
      check_near(conv(x).value().to_host<double>(),
                 plain_conv(x.value(), conv.weight.value(), conv.bias.value()));
    }
}

TEST_CASE("residual and ReLU are applied after the convolution" * doctest::test_suite("double")) {
  Initializer init(double_context(), 2);
  const Conv1d conv(init, 4, 4, 3);
  const Var x = random(6, 2, 4);
  std::vector<double> expected = plain_conv(x.value(), conv.weight.value(), conv.bias.value());
  const std::vector<double> xs = x.value().to_host<double>();
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = std::max(0.0, expected[i] + xs[i]);
  check_near(conv(x, {.residual = x, .relu = true}).value().to_host<double>(), expected);
}

TEST_CASE("Conv1d::down equals the pooled convolution, gradients included" * doctest::test_suite("double")) {
  Initializer init(double_context(), 3);
  const Conv1d conv(init, 5, 7, 3);
  for (std::size_t frames : {2, 3, 4, 5, 8, 32}) {
    CAPTURE(frames);
    const Var x = Var::leaf(random(frames, 2, 5).value());
    const std::size_t half = frames / 2;
    const Var plain = sum_pool(slice(conv(x), 0, 0, 2 * half), 2, 0.5),
              quick = conv_down(pair_means(x), conv.weight, conv.bias, frames);
    check_near(quick.value().to_host<double>(), plain.value().to_host<double>());
    check_near(
        conv_down(pair_means(x), conv.weight, conv.bias, frames, {.relu = true}).value().to_host<double>(),
        relu(plain).value().to_host<double>());
    const std::vector<Var> wanted{x, conv.weight, conv.bias};
    const std::vector<Var> a = grad(square(plain), wanted), b = grad(square(quick), wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      check_near(b[i].value().to_host<double>(), a[i].value().to_host<double>());
  }
  const Conv1d five(init, 2, 2, 5);
  CHECK_THROWS_WITH_AS(conv_down(random(4, 1, 2), five.weight, five.bias, 4),
                       "conv_down: weight has 5 taps, expected 3", Error);
}

TEST_CASE("Linear applies to the last axis, whatever the others" * doctest::test_suite("double")) {
  Initializer init(double_context(), 5);
  const Linear linear(init, 4, 3);
  const Var x = random(2, 3, 4);
  const std::vector<double> xs = x.value().to_host<double>(), ws = linear.weight.value().to_host<double>(),
                            bs = linear.bias.value().to_host<double>();
  std::vector<double> expected;
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t o = 0; o < 3; ++o) {
      double sum = bs[o];
      for (std::size_t i = 0; i < 4; ++i) sum += ws[o * 4 + i] * xs[row * 4 + i];
      expected.push_back(sum);
    }
  check_near(linear(x).value().to_host<double>(), expected);
  check_near(linear(reshape(x, {6, 4})).value().to_host<double>(), expected);
  for (double& v : expected) v = std::max(v, 0.0);
  check_near(linear(x, true).value().to_host<double>(), expected);
  CHECK(linear(x).shape() == Shape{2, 3, 3});
}

TEST_CASE("wrong sizes are rejected, with both shapes" * doctest::test_suite("double")) {
  Initializer init(double_context(), 6);
  CHECK_THROWS_WITH_AS(Conv1d(init, 4, 4, 2), "Conv1d: taps is 2, expected an odd number for same padding",
                       Error);
  const Conv1d conv(init, 4, 4, 3);
  CHECK_THROWS_WITH_AS(conv(random(2, 2, 5)), "conv1d: input [2, 2, 5] does not fit weights [3, 4, 4]",
                       Error);
}

TEST_CASE("numbers of frames that are powers of two") {
  CHECK(levels_of(1) == 0);
  CHECK(levels_of(32) == 5);
  CHECK(levels_of(1024) == 10);
  for (const auto& [frames, text] : {std::pair{33, "33; the nearest are 32 and 64"},
                                     {31, "31; the nearest are 16 and 32"},
                                     {3, "3; the nearest are 2 and 4"},
                                     {0, "0; the nearest are 1 and 2"}}) {
    std::string found;
    try {
      levels_of(static_cast<std::size_t>(frames));
    } catch (const Error& error) {
      found = error.what();
    }
    CHECK(found.find(text) != std::string::npos);
  }
}

TEST_CASE("many rows, with packed weights, give the same bits as few rows") {
  for (const Precision precision : testing::precisions()) {
    const Context context({.precision = precision});
    Initializer init(context, 4);
    constexpr std::size_t frames = 33, batch = 17;
    for (const std::size_t in : {16u, 93u})
      for (const std::size_t out : {32u, 93u, 13u})
        for (const std::size_t taps_count : {1u, 3u, 5u}) {
          const Conv1d conv(init, in, out, taps_count);
          const Tensor x = random_normal(context, {.seed = 1}, frames, batch, in);
          const Tensor u = random_normal(context, {.seed = 2}, frames, batch, out);
          const auto values_and_gradients = [&](const Tensor& at, const Tensor& seed) {
            const Var leaf = Var::leaf(at), y = conv(leaf, {.relu = true});
            return std::pair{y.value(), grad({y}, {Var::constant(seed)}, {leaf})[0].value()};
          };
          const auto [y, gradient] = values_and_gradients(x, u);
          const auto halves = [&](const Tensor& at) {
            const Var pairs = pair_means(Var::constant(at));
            return taps_count == 3 ? conv_down(pairs, conv.weight, conv.bias, frames).value() : at;
          };
          const Tensor halved = halves(x);
          for (const std::size_t b : {0u, 8u, 16u}) {
            CAPTURE(concat("in ", in, " out ", out, " taps ", taps_count, " sample ", b));
            const auto only = [&](const Tensor& t) { return slice(Var::constant(t), 1, b, 1).value(); };
            const auto [y_alone, gradient_alone] = values_and_gradients(only(x), only(u));
            CHECK(y_alone.to_host<double>() == only(y).to_host<double>());
            CHECK(gradient_alone.to_host<double>() == only(gradient).to_host<double>());
            CHECK(halves(only(x)).to_host<double>() == only(halved).to_host<double>());
          }
        }
  }
}

}  // namespace conv1d_test
