// The losses of the Wasserstein GAN, with critics simple enough to have closed-form results.
#include <doctest/doctest.h>

#include <motiongan/ops/matmul.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "../support/check_grads.hpp"

namespace wgan_gp_test {

using namespace motiongan;
using testing::double_context;

namespace {

constexpr std::size_t frames = 3, batch = 4, channels = 2;

Var constant(Shape shape, const std::vector<double>& values) {
  return Var::constant(Tensor::from(double_context(), std::move(shape), values));
}
Tensor motion(std::uint64_t seed) {
  const testing::Input i = testing::randn({frames, batch, channels}, 0, static_cast<double>(seed));
  return Tensor::from(double_context(), i.shape, i.values);
}
std::vector<double> host(const Var& v) { return v.value().to_host<double>(); }

/// D(x) = <w, x> per sample; w is [frames, channels].
Var linear_critic(const Var& x, const Var& w) {
  const std::size_t samples = x.dim(1);
  return sum_per_sample(x * broadcast_to(reshape(w, {frames, 1, channels}), {frames, samples, channels}));
}

}  // namespace

TEST_CASE("the penalty of a linear critic is (|w| - 1)^2, with gradient 2 (|w| - 1) w / |w|" *
          doctest::test_suite("double")) {
  const std::vector<double> weights{0.5, -1, 2, 0.25, -0.75, 1.5};
  const Var w = Var::leaf(Tensor::from(double_context(), {frames, channels}, weights));
  double norm = 0;
  for (double v : weights) norm += v * v;
  norm = std::sqrt(norm);
  const Var x = Var::leaf(motion(1));
  const Var penalty = gradient_penalty([&](const Var& m) { return linear_critic(m, w); }, x);
  CHECK(penalty.shape() == Shape{1});
  CHECK(penalty.item() == doctest::Approx((norm - 1) * (norm - 1)).epsilon(1e-11));
  const std::vector<double> gradient = host(grad(penalty, {w})[0]);
  for (std::size_t i = 0; i < weights.size(); ++i)
    CHECK(gradient[i] == doctest::Approx(2 * (norm - 1) * weights[i] / norm).epsilon(1e-11));
}

TEST_CASE("the norm is over all frames and channels of each sample separately" *
          doctest::test_suite("double")) {
  // D(x_b) = <x_b, x_b> / 2 has the gradient x_b, so the norm differs between samples.
  const Tensor x = motion(0);
  const std::vector<double> xs = x.to_host<double>();
  double expected = 0;
  for (std::size_t b = 0; b < batch; ++b) {
    double square = 0;
    for (std::size_t t = 0; t < frames; ++t)
      for (std::size_t c = 0; c < channels; ++c) {
        const double v = xs[(t * batch + b) * channels + c];
        square += v * v;
      }
    expected += (std::sqrt(square) - 1) * (std::sqrt(square) - 1) / batch;
  }
  const CriticFn judge = [](const Var& m) { return 0.5 * sum_per_sample(square(m)); };
  CHECK(gradient_penalty(judge, Var::leaf(x)).item() == doctest::Approx(expected).epsilon(1e-11));
}

TEST_CASE("a constant critic has penalty 1 and a finite gradient" * doctest::test_suite("double")) {
  const Var w = Var::leaf(full(double_context(), {frames, channels}, 0));
  const Var penalty =
      gradient_penalty([&](const Var& m) { return linear_critic(m, w); }, Var::leaf(motion(2)));
  CHECK(penalty.item() == doctest::Approx(1).epsilon(1e-5));
  for (double v : host(grad(penalty, {w})[0])) CHECK(std::isfinite(v));
}

TEST_CASE("the gradient of a nonlinear critic's penalty equals central differences" *
          doctest::test_suite("double")) {
  const testing::Function penalty = [](const std::vector<Var>& v) {
    const Var x = Var::leaf(v[1].value());
    return gradient_penalty([&](const Var& m) { return tanh(linear_critic(m, v[0])); }, x);
  };
  const testing::Input w = testing::randn({frames, channels}), x = testing::randn({frames, batch, channels});
  const testing::Function by_weights = [&](const std::vector<Var>& v) {
    return penalty({v[0], Var::constant(Tensor::from(double_context(), x.shape, x.values))});
  };
  CHECK(testing::check_grads(double_context(), by_weights, {w}, 2) < 1e-7);
}

TEST_CASE("interpolate: real where eps is 1, fake where it is 0, a leaf" * doctest::test_suite("double")) {
  const Tensor real = motion(1), fake = motion(2), eps = constant({batch}, {0, 1, 0.25, 0.5}).value();
  const Var mixed = interpolate(real, fake, eps);
  CHECK(mixed.requires_grad());
  CHECK(mixed.node()->inputs.empty());
  const std::vector<double> r = real.to_host<double>(), f = fake.to_host<double>(), e = eps.to_host<double>(),
                            m = host(mixed);
  for (std::size_t i = 0; i < m.size(); ++i) {
    const double share = e[i / channels % batch];
    CHECK(m[i] == doctest::Approx(share * r[i] + (1 - share) * f[i]).epsilon(1e-13));
  }
}

TEST_CASE("the terms of the critic's loss" * doctest::test_suite("double")) {
  const std::vector<double> weights{1, 0, 0, 2, 0, -2};  // |w| = 3
  const Var w = Var::leaf(Tensor::from(double_context(), {frames, channels}, weights));
  const CriticFn judge = [&](const Var& m) { return linear_critic(m, w); };
  const Tensor real = motion(1), fake = motion(2);
  const CriticLoss loss =
      critic_loss(judge, judge, real, fake, constant({batch}, {0.1, 0.2, 0.3, 0.4}).value(), 10);
  const std::vector<double> of_real = host(judge(Var::constant(real))),
                            of_fake = host(judge(Var::constant(fake))), scores = host(loss.scores);
  double mean_real = 0, mean_fake = 0;
  for (std::size_t b = 0; b < batch; ++b) {
    CHECK(scores[b] == of_real[b]);
    CHECK(scores[batch + b] == of_fake[b]);
    mean_real += of_real[b] / batch;
    mean_fake += of_fake[b] / batch;
  }
  CHECK(loss.wasserstein.item() == doctest::Approx(mean_real - mean_fake));
  CHECK(loss.penalty.item() == doctest::Approx(4));
  CHECK(loss.loss.item() == doctest::Approx(mean_fake - mean_real + 40));
  CHECK(generator_loss(judge(Var::constant(fake))).item() == doctest::Approx(-mean_fake));

  // d/dw: mean fake - mean real + 10 * 2 (|w| - 1) w / |w|
  const std::vector<double> gradient = host(grad(loss.loss, {w})[0]), r = real.to_host<double>(),
                            f = fake.to_host<double>();
  for (std::size_t t = 0; t < frames; ++t)
    for (std::size_t c = 0; c < channels; ++c) {
      double expected = 40 * weights[t * channels + c] / 3;
      for (std::size_t b = 0; b < batch; ++b) {
        const std::size_t at = (t * batch + b) * channels + c;
        expected += (f[at] - r[at]) / batch;
      }
      CHECK(gradient[t * channels + c] == doctest::Approx(expected).epsilon(1e-10));
    }
}

}  // namespace wgan_gp_test
