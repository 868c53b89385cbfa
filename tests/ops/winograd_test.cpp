// Convolutions in Winograd's form against the sum of shifted products.
#include <doctest/doctest.h>

#include <cmath>
#include <motiongan/autograd/grad.hpp>
#include <motiongan/core/random.hpp>
#include <motiongan/ops/conv1d.hpp>
#include <motiongan/ops/elementwise.hpp>
#include <random>

#include "../support/precision.hpp"

namespace winograd_test {

using namespace motiongan;
using namespace motiongan::detail;

namespace {

using testing::context_of;

Tensor some(const Context& context, std::uint32_t seed, std::size_t frames, std::size_t batch,
            std::size_t channels) {
  return random_normal(context, {.seed = seed}, frames, batch, channels);
}

/// |a - b| / |b|
double distance(const Tensor& a, const Tensor& b) {
  REQUIRE(a.shape() == b.shape());
  const std::vector<double> x = a.to_host<double>(), y = b.to_host<double>();
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < x.size(); ++i) difference += std::pow(x[i] - y[i], 2), size += y[i] * y[i];
  return std::sqrt(difference / size);
}

double allowed_distance(Precision precision) { return precision == Precision::f32 ? 3e-6 : 5e-15; }

/// Whether convolutions are computed in Winograd's form here; says that a test is skipped if not.
bool in_use(const Context& context) {
  const bool used = packs_weights(context);
  if (!used) MESSAGE("skipped: only the native engine's narrow form uses Winograd's form");
  return used;
}

Taps all_taps(const Offsets& offsets) {
  Taps taps(offsets.size());
  std::iota(taps.begin(), taps.end(), std::size_t{0});
  return taps;
}

struct Case {
  const char* name;
  Offsets offsets;
  std::size_t frames_in, frames_out, runs, others;
};

/// Same padding, its gradient, a cut, halves of frames as in conv_down() and their gradient, five taps.
const std::vector<Case>& cases() {
  static const std::vector<Case> all{{"4 frames", {-1, 0, 1}, 4, 4, 1, 0},
                                     {"7 frames", {-1, 0, 1}, 7, 7, 1, 0},
                                     {"15 frames", {-1, 0, 1}, 15, 15, 1, 0},
                                     {"30 frames", {-1, 0, 1}, 30, 30, 1, 0},
                                     {"32 frames", {-1, 0, 1}, 32, 32, 1, 0},
                                     {"reversed", {1, 0, -1}, 16, 16, 1, 0},
                                     {"cut", {0, 1, 2}, 18, 16, 1, 0},
                                     {"past the end", {3, 4, 5}, 20, 24, 1, 0},
                                     {"before the start", {-9, -8, -7}, 20, 24, 1, 0},
                                     {"pairs", {0, 9, 1}, 17, 8, 1, 1},
                                     {"pairs reversed", {0, -17, -1}, 16, 33, 1, 1},
                                     {"five taps", {-2, -1, 0, 1, 2}, 16, 16, 2, 0},
                                     {"four taps", {0, 1, 2, 3}, 16, 16, 2, 0},
                                     {"irregular", {1, 0, 2}, 16, 16, 0, 3},
                                     {"two frames", {-1, 0, 1}, 2, 2, 0, 3}};
  return all;
}

TEST_CASE("a form computes a convolution") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const WinogradForm& form : winograd_forms()) {
    CAPTURE(form.frames);
    CAPTURE(form.taps);
    CHECK(form.points == form.frames + form.taps - 1);
    std::vector<double> x(form.points), w(form.taps), products(form.points);
    for (double& v : x) v = uniform(random);
    for (double& v : w) v = uniform(random);
    for (std::size_t a = 0; a < form.points; ++a) {
      double of_x = 0, of_w = 0;
      for (std::size_t j = 0; j < form.points; ++j) of_x += form.input(a, j) * x[j];
      for (std::size_t s = 0; s < form.taps; ++s) of_w += form.weights(a, s) * w[s];
      products[a] = of_x * of_w;
    }
    for (std::size_t t = 0; t < form.frames; ++t) {
      double y = 0, expected = 0;
      for (std::size_t a = 0; a < form.points; ++a) y += form.output(t, a) * products[a];
      for (std::size_t s = 0; s < form.taps; ++s) expected += x[t + s] * w[s];
      CHECK(y == doctest::Approx(expected).epsilon(1e-12));
    }
  }
}

TEST_CASE("values equal the sum of shifted products") {
  constexpr std::size_t batch = 3, in = 65, out = 93;
  for (const Precision precision : testing::precisions()) {
    const Context& context = context_of(precision);
    if (!in_use(context)) return;
    const double allowed = allowed_distance(precision);
    for (const Case& c : cases())
      for (const bool transposed : {false, true})
        for (const bool finished : {false, true}) {
          CAPTURE(c.name);
          CAPTURE(transposed);
          CAPTURE(finished);
          const Tensor x = some(context, 1, c.frames_in, batch, in),
                       w = some(context, 2, c.offsets.size(), transposed ? in : out, transposed ? out : in);
          Epilogue epilogue;
          if (finished)
            epilogue = {some(context, 3, 1, 1, out).view(0, {out}),
                        some(context, 4, c.frames_out, batch, out), true};
          const Convolution convolution{x, w, c.offsets, c.frames_out, transposed};
          const TapPlan plan = plan_taps(convolution, ConvolutionPart::value);
          CHECK(plan.runs.size() == c.runs);
          CHECK(plan.others.size() == c.others);
          const Tensor y(context, {c.frames_out, batch, out});
          conv1d_direct(convolution, all_taps(c.offsets), {0, c.frames_out}, epilogue, y);
          CHECK(distance(conv1d_value(x, w, c.offsets, c.frames_out, transposed, epilogue), y) < allowed);
        }
  }
}

TEST_CASE("gradients of weights equal the sum of shifted products") {
  constexpr std::size_t batch = 3, p_channels = 96, q_channels = 101;
  for (const Precision precision : testing::precisions()) {
    const Context& context = context_of(precision);
    if (!in_use(context)) return;
    const double allowed = allowed_distance(precision);
    std::size_t in_this_form = 0;
    for (const Case& c : cases()) {
      CAPTURE(c.name);
      const Tensor p = some(context, 1, c.frames_out, batch, p_channels),
                   q = some(context, 2, c.frames_in, batch, q_channels);
      const Tensor w(context, {c.offsets.size(), p_channels, q_channels});
      in_this_form +=
          plan_taps({q, w, c.offsets, c.frames_out, false}, ConvolutionPart::weight_gradient).runs.size();
      conv1d_weight_direct(p, q, c.offsets, all_taps(c.offsets), w);
      CHECK(distance(conv1d_weight_value(p, q, c.offsets), w) < allowed);
    }
    CHECK(in_this_form >= 8);
  }
}

TEST_CASE("a sample is the same, bit for bit, alone and in a batch") {
  const Context& context = context_of(Precision::f32);
  constexpr std::size_t frames = 30, batch = 5, channels = 96;
  const Tensor x = some(context, 1, frames, batch, channels), w = some(context, 2, 3, channels, channels);
  const std::vector<float> all = conv1d_value(x, w, {-1, 0, 1}, frames, false, {}).to_host<float>();
  const std::vector<float> inputs = x.to_host<float>();
  for (std::size_t b = 0; b < batch; ++b) {
    std::vector<float> one(frames * channels), expected(frames * channels);
    for (std::size_t t = 0; t < frames; ++t)
      for (std::size_t c = 0; c < channels; ++c) {
        one[t * channels + c] = inputs[(t * batch + b) * channels + c];
        expected[t * channels + c] = all[(t * batch + b) * channels + c];
      }
    const Tensor alone = Tensor::from(context, {frames, 1, channels}, one);
    CHECK(conv1d_value(alone, w, {-1, 0, 1}, frames, false, {}).to_host<float>() == expected);
  }
}

TEST_CASE("first and second derivatives agree with differences along a direction" *
          doctest::test_suite("double")) {
  const Context& context = context_of(Precision::f64);
  constexpr std::size_t frames = 8, batch = 2, channels = 96;
  const Offsets offsets{-1, 0, 1};
  const Tensor x = some(context, 1, frames, batch, channels), w = some(context, 2, 3, channels, channels),
               dx = some(context, 3, frames, batch, channels), dw = some(context, 4, 3, channels, channels);
  // The squared norm of the gradient of sum(y^4) by x: like a gradient penalty, nonlinear in x and w.
  const auto penalty = [&](const Var& at_x, const Var& at_w) {
    const Var y = conv1d(at_x, 0.01 * at_w, offsets, frames);
    return sum(square(grad(square(square(y)), {at_x}, {.create_graph = true})[0]));
  };
  const auto at = [&](double step) {
    const Var moved_x = Var::leaf(weighted_sum(Var::constant(x), 1, Var::constant(dx), step).value()),
              moved_w = Var::leaf(weighted_sum(Var::constant(w), 1, Var::constant(dw), step).value());
    return std::pair{moved_x, moved_w};
  };
  const auto [x0, w0] = at(0);
  const std::vector<Var> slopes = grad(penalty(x0, w0), {x0, w0});
  const double slope = sum(slopes[0] * Var::constant(dx)).item() + sum(slopes[1] * Var::constant(dw)).item();
  constexpr double step = 1e-4;
  const auto [x1, w1] = at(step);
  const auto [x2, w2] = at(-step);
  CHECK(slope ==
        doctest::Approx((penalty(x1, w1).item() - penalty(x2, w2).item()) / (2 * step)).epsilon(1e-6));
}

}  // namespace

}  // namespace winograd_test
