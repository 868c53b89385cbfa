// The running mean of weights against the same on the host.
#include <doctest/doctest.h>

#include <cmath>
#include <list>
#include <motiongan/optim/sgd.hpp>
#include <motiongan/optim/weight_mean.hpp>

namespace weight_mean_test {

using namespace motiongan;

namespace {

const Context& context() {
  static const Context c(ContextOptions{.precision = Precision::f64});
  return c;
}
Var leaf(const std::vector<double>& values) {
  return Var::leaf(Tensor::from(context(), {values.size()}, values));
}
Var constant(const std::vector<double>& values) {
  return Var::constant(Tensor::from(context(), {values.size()}, values));
}

}  // namespace

TEST_CASE("the mean follows the weights by the share of each step, and the first step is all of it" *
          doctest::test_suite("double")) {
  for (const double decay : {0.5, 0.9, 0.999}) {
    CAPTURE(decay);
    Var p = leaf({1, 2, 3}), q = leaf({-4});
    Sgd sgd({{"p", &p}, {"q", &q}}, {.learning_rate = 1});
    WeightMean mean(sgd, decay);
    CHECK(mean.values().to_host<double>() == std::vector<double>(4, 0));
    mean.apply();  // without steps there is no mean
    CHECK(p.value().to_host<double>() == std::vector<double>{1, 2, 3});
    std::vector<double> expected(4, 0);
    for (int t = 1; t <= 40; ++t) {
      sgd.step({constant({std::sin(0.3 * t), 0.1, -0.2}), constant({std::cos(0.7 * t)})});
      mean.update();
      const std::vector<double> now = sgd.values().to_host<double>();
      const double share = t == 1 ? 1 : std::max((1 - decay) / (1 - std::pow(decay, t)), 9.0 / (10 + t));
      for (std::size_t i = 0; i < 4; ++i) expected[i] += share * (now[i] - expected[i]);
      const std::vector<double> found = mean.values().to_host<double>();
      for (std::size_t i = 0; i < 4; ++i) REQUIRE(found[i] == doctest::Approx(expected[i]).epsilon(1e-12));
    }
    CHECK(mean.steps() == 40);
    std::list<Var> hold;
    const auto means = mean.means_of({{"p", &p}, {"q", &q}}, hold);
    REQUIRE(means.size() == 2);
    CHECK(means[1].name == "q");
    CHECK(means[0].value->shape() == Shape{3});
    CHECK(means[1].value->value().to_host<double>()[0] == doctest::Approx(expected[3]).epsilon(1e-12));
    CHECK(p.value().to_host<double>()[0] != doctest::Approx(expected[0]));
    mean.apply();
    CHECK(p.value().to_host<double>()[0] == doctest::Approx(expected[0]).epsilon(1e-12));
    CHECK(q.value().to_host<double>()[0] == doctest::Approx(expected[3]).epsilon(1e-12));
  }
}

TEST_CASE("weights that stay are their own mean" * doctest::test_suite("double")) {
  Var p = leaf({0.1, -7});
  Sgd sgd({{"p", &p}}, {.learning_rate = 1});
  WeightMean mean(sgd, 0.999);
  for (int t = 0; t < 5; ++t) {
    sgd.step({constant({0, 0})});
    mean.update();
    CHECK(mean.values().to_host<double>() == std::vector<double>{0.1, -7});
  }
}

}  // namespace weight_mean_test
