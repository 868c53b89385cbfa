// The GRU rollout: derivatives in double, and the fused form against the composed one.
#include <doctest/doctest.h>

#include <motiongan/ops/gru_rollout.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace gru_rollout_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// x_gates, each, last, W_h, b_h, pose, Wd, bd; small weights avoid saturation.
std::vector<Input> inputs(std::size_t given, std::size_t batch, std::size_t dof, std::size_t k) {
  std::vector<Input> all{randn({given, batch, 3 * k}),
                         randn({batch, 3 * k}),
                         randn({batch, dof}),
                         randn({3 * k, k}),
                         randn({3 * k}),
                         randn({3 * k, dof}),
                         randn({dof, k}),
                         randn({dof})};
  for (const std::size_t i : {3u, 5u, 6u})
    for (double& v : all[i].values) v *= 0.3;
  return all;
}

Function fused(std::size_t frames) {
  return [=](const std::vector<Var>& v) {
    return gru_rollout(v[0], v[1], v[2], {v[3], v[4], v[5], v[6], v[7]}, frames);
  };
}
Function composed(std::size_t frames) {
  return [=](const std::vector<Var>& v) {
    return detail::gru_rollout_composed(v[0], v[1], v[2], {v[3], v[4], v[5], v[6], v[7]}, frames);
  };
}

}  // namespace

TEST_CASE("gru_rollout: derivatives with respect to every input, to third order" *
          doctest::test_suite("double")) {
  for (const auto& sizes :
       {std::array<std::size_t, 3>{1, 1, 3}, {3, 1, 2}, {1, 3, 3}, {3, 3, 9}, {2, 4, 5}}) {
    const std::size_t given = sizes[0], frames = sizes[1], k = sizes[2];
    CAPTURE(given);
    CAPTURE(frames);
    CHECK(check_grads(double_context(), fused(frames), inputs(given, 2, 3, k), 2) < 1e-7);
  }
  CHECK(check_grads(double_context(), fused(2), inputs(2, 2, 2, 2), 3) < 1e-7);
}

TEST_CASE("gru_rollout: the fused form equals the composed one" * doctest::test_suite("double")) {
  for (const auto& sizes : {std::array<std::size_t, 2>{1, 1}, {5, 1}, {1, 6}, {4, 7}}) {
    const std::size_t given = sizes[0], frames = sizes[1];
    CAPTURE(given);
    CAPTURE(frames);
    std::vector<Var> x;
    for (const Input& i : inputs(given, 3, 7, 20))
      x.push_back(Var::leaf(Tensor::from(double_context(), i.shape, i.values)));
    const Var a = fused(frames)(x), b = composed(frames)(x);
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
    const NoGrad off;
    CHECK(difference(fused(frames)(x), a) == 0);  // without a trace: the same bits
  }
}

TEST_CASE("gru_rollout: few launches per step; wrong shapes are rejected") {
  const Context context;
  std::vector<Var> x;
  for (const Input& i : inputs(9, 2, 16, 32))
    x.push_back(Var::leaf(Tensor::from(context, i.shape, i.values)));
  const auto launches = [&](std::size_t frames) {
    const std::size_t before = context.statistics().launches;
    fused(frames)(x);
    return context.statistics().launches - before;
  };
  CHECK(launches(12) - launches(2) <= 50);
  x[1] = zeros(context, {3, 96});
  CHECK(
      says(message_of([&] { fused(2)(x); }), "gru_rollout: gates [9, 2, 96] and [3, 96], last pose [2, 16]"));
}

}  // namespace gru_rollout_test
