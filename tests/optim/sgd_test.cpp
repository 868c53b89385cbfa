// Stochastic gradient descent, against values computed by hand.
#include <doctest/doctest.h>

#include <motiongan/optim/sgd.hpp>

#include "../support/messages.hpp"

namespace sgd_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

const Context& doubles() {
  static const Context context({.precision = Precision::f64});
  return context;
}

Var constant(const std::vector<double>& values) {
  return Var::constant(Tensor::from(doubles(), {values.size()}, values));
}

}  // namespace

TEST_CASE("the global gradient norm is clipped, and the learning rate decays" *
          doctest::test_suite("double")) {
  Var p = Var::leaf(constant({1, 2}).value()), q = Var::leaf(constant({10}).value());
  Sgd sgd({{"p", &p}, {"q", &q}}, {.learning_rate = 0.1, .decay = 0.5, .decay_every = 2, .clip_norm = 3});
  const auto step = [&](std::vector<double> of_p, std::vector<double> of_q) {
    sgd.step({constant(of_p), constant(of_q)});
    std::vector<double> all = p.value().to_host<double>();
    all.push_back(q.value().to_host<double>()[0]);
    return all;
  };
  const auto check = [](const std::vector<double>& found, double a, double b, double c) {
    CHECK(found[0] == doctest::Approx(a).epsilon(1e-14));
    CHECK(found[1] == doctest::Approx(b).epsilon(1e-14));
    CHECK(found[2] == doctest::Approx(c).epsilon(1e-14));
  };
  check(step({1, 2}, {2}), 0.9, 1.8, 9.8);        // norm 3, the maximum
  check(step({2, 4}, {-4}), 0.8, 1.6, 10.0);      // norm 6: halved
  check(step({1, 2}, {2}), 0.75, 1.5, 9.9);       // from here on half the learning rate
  check(step({0, 0}, {-300}), 0.75, 1.5, 10.05);  // norm 300: scaled by 1/100
  check(step({0, 0}, {0}), 0.75, 1.5, 10.05);     // no gradient, no division by zero
  CHECK(sgd.steps() == 5);
  CHECK(sgd.rate(3) == 0.05);
  CHECK(sgd.rate(4) == 0.025);
  CHECK(std::string(sgd.name()) == "sgd");
  CHECK(sgd.state().empty());
}

TEST_CASE("the defaults are those of residual seq2seq" * doctest::test_suite("double")) {
  Var p = Var::leaf(constant({0}).value());
  const Sgd sgd({{"p", &p}});
  CHECK(sgd.rate(0) == 0.005);
  CHECK(sgd.rate(9'999) == 0.005);
  CHECK(sgd.rate(10'000) == doctest::Approx(0.00475).epsilon(1e-14));
  CHECK(sgd.options().clip_norm == 5);
}

TEST_CASE("without clipping and decay: plain descent; large parameters; no reads from the device" *
          doctest::test_suite("double")) {
  for (const double limit : {0.0, 2.0}) {
    std::vector<double> values(10'001), gradient;
    double square = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = std::cos(static_cast<double>(i));
      gradient.push_back(std::sin(0.7 * static_cast<double>(i)));
      square += gradient[i] * gradient[i];
    }
    Var p = Var::leaf(constant(values).value());
    Sgd sgd({{"p", &p}}, {.learning_rate = 0.3, .decay_every = 0, .clip_norm = limit});
    const std::size_t reads = doubles().statistics().reads;
    sgd.step({constant(gradient)});
    CHECK(doubles().statistics().reads == reads);
    const double scale = limit > 0 ? limit / std::sqrt(square) : 1;
    const std::vector<double> found = p.value().to_host<double>();
    double worst = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      worst = std::max(worst, std::abs(found[i] - (values[i] - 0.3 * scale * gradient[i])));
    CHECK(worst < 1e-14);
    CHECK(sgd.rate(1'000'000) == 0.3);
  }
}

TEST_CASE("invalid options and gradients are rejected" * doctest::test_suite("double")) {
  Var p = Var::leaf(constant({1, 2}).value());
  CHECK(says(message_of([] { Sgd({}); }), "Sgd: no parameters"));
  CHECK(says(message_of([&] { Sgd({{"p", &p}}, {.learning_rate = 0}); }), "Sgd: learning rate 0"));
  CHECK(says(message_of([&] { Sgd({{"p", &p}}, {.clip_norm = -1}); }), "clip_norm -1"));
  CHECK(says(message_of([&] { Sgd({{"p", &p}}, {.decay = 0}); }), "decay 0"));
  Sgd sgd({{"p", &p}});
  CHECK(says(message_of([&] { sgd.step({constant({1})}); }),
             "Sgd: gradient 0 has shape [1], the parameter [2]"));
  CHECK(sgd.steps() == 0);
}

}  // namespace sgd_test
