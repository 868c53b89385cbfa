// The LSTM rollout: derivatives in double, and the fused form against the composed one.
#include <doctest/doctest.h>

#include <motiongan/ops/rollout.hpp>

#include "../support/check_grads.hpp"

namespace rollout_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// given, x_gates, W0, W1, b1, Wd, bd; small weights avoid saturation.
std::vector<Input> inputs(std::size_t frames, std::size_t batch, std::size_t dof, std::size_t k,
                          std::size_t given) {
  std::vector<Input> all{randn({given, batch, dof}),
                         randn({frames - 1, batch, 4 * k}),
                         randn({4 * k, dof + k}),
                         randn({4 * k, 2 * k}),
                         randn({4 * k}),
                         randn({dof, k}),
                         randn({dof})};
  for (std::size_t i : {2u, 3u, 5u})
    for (double& v : all[i].values) v *= 0.3;
  return all;
}

auto fused(double leak = 0) {
  return [leak](const std::vector<Var>& v) {
    return rollout(v[0], v[1], {v[2], v[3], v[4], v[5], v[6], leak});
  };
}
Var composed(const std::vector<Var>& v, double leak) {
  return detail::rollout_composed(v[0], v[1], {v[2], v[3], v[4], v[5], v[6], leak});
}

}  // namespace

TEST_CASE("rollout: derivatives with respect to every input, with and without given frames" *
          doctest::test_suite("double")) {
  for (const auto& [frames, k, given] :
       {std::array<std::size_t, 3>{4, 3, 1}, {5, 3, 3}, {3, 5, 3}, {2, 9, 1}}) {
    CAPTURE(frames);
    CAPTURE(given);
    CHECK(check_grads(double_context(), fused(), inputs(frames, 2, 3, k, given), 2) < 1e-7);
    CHECK(check_grads(double_context(), fused(0.25), inputs(frames, 2, 3, k, given), 2) < 1e-7);
  }
  CHECK(check_grads(double_context(), fused(), inputs(3, 2, 2, 2, 1), 3) < 1e-7);
}

TEST_CASE("rollout: the fused form equals the composed one" * doctest::test_suite("double")) {
  struct Case {
    std::size_t given;
    double leak;
  };
  for (const Case& c : {Case{1, 0}, {4, 0}, {9, 0}, {1, 0.1}, {4, 0.5}}) {
    CAPTURE(c.given);
    CAPTURE(c.leak);
    std::vector<Var> x;
    for (const Input& i : inputs(9, 3, 7, 20, c.given))
      x.push_back(Var::leaf(Tensor::from(double_context(), i.shape, i.values)));
    const Var a = fused(c.leak)(x), b = composed(x, c.leak);
    const Input u = randn(a.shape());
    const Var seed = Var::constant(Tensor::from(double_context(), u.shape, u.values));
    const std::vector<Var> ga = grad({a}, {seed}, x), gb = grad({b}, {seed}, x);
    const auto difference = [](const Var& p, const Var& q) {
      const auto v = p.value().to_host<double>(), w = q.value().to_host<double>();
      double worst = 0;
      for (std::size_t i = 0; i < v.size(); ++i) worst = std::max(worst, std::abs(v[i] - w[i]));
      return worst;
    };
    CHECK(difference(a, b) < 1e-12);
    for (std::size_t i = 0; i < x.size(); ++i) {
      CAPTURE(i);
      CHECK(difference(ga[i], gb[i]) < 1e-10);
    }
  }
}

TEST_CASE("rollout: one frame returns the given one; wrong shapes are rejected" *
          doctest::test_suite("double")) {
  const Context& context = double_context();
  const auto value = [&](Shape shape) { return zeros(context, std::move(shape)); };
  const RolloutWeights w{value({8, 5}), value({8, 4}), value({8}), value({3, 2}), value({3})};
  CHECK(rollout(value({2, 4, 3}), value({1, 4, 8}), w).shape() == Shape{2, 4, 3});
  CHECK_THROWS_WITH_AS(rollout(value({3, 4, 3}), value({1, 4, 8}), w),
                       "rollout: given [3, 4, 3], gates [1, 4, 8], weights [8, 5], [8, 4], [3, 2]", Error);
  CHECK_THROWS_AS(rollout(value({1, 4, 3}), value({1, 5, 8}), w), Error);
  RolloutWeights empty = w;
  empty.leak = 1;
  CHECK_THROWS_WITH_AS(rollout(value({2, 4, 3}), value({1, 4, 8}), empty),
                       "rollout: leak 1, expected at least 0 and below 1", Error);
}

}  // namespace rollout_test
