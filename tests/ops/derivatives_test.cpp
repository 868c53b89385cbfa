// Every differentiable operation: first to third derivatives against central differences, in double.
#include <doctest/doctest.h>

#include <motiongan/ops/conv1d.hpp>
#include <motiongan/ops/cross_entropy.hpp>
#include <motiongan/ops/forward_kinematics.hpp>
#include <motiongan/ops/lstm.hpp>

#include "../support/check_grads.hpp"

namespace derivatives_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr double tolerance = 1e-7;

void check(const char* name, const Function& f, const std::vector<Input>& at, int order = 3) {
  CAPTURE(name);
  CHECK(check_grads(double_context(), f, at, order) < tolerance);
}

const Input positive(Shape shape) {
  Input input = randn(std::move(shape));
  for (double& v : input.values) v = 0.5 + std::abs(v);
  return input;
}

}  // namespace

TEST_CASE("elementwise operations" * doctest::test_suite("double")) {
  const Input x = randn({3, 7}), y = randn({3, 7}), kinked = randn({3, 7}, 0.05);
  check("affine", [](auto& v) { return affine(v[0], 1.7, -0.3); }, {x});
  check("weighted_sum", [](auto& v) { return weighted_sum(v[0], 2, v[1], -3); }, {x, y});
  check("product", [](auto& v) { return v[0] * v[1]; }, {x, y});
  check("square", [](auto& v) { return square(v[0]); }, {x});
  check("quotient", [](auto& v) { return v[0] / v[1]; }, {x, positive({3, 7})});
  check("tanh", [](auto& v) { return tanh(v[0]); }, {x});
  check("sigmoid", [](auto& v) { return sigmoid(v[0]); }, {x});
  check("exp", [](auto& v) { return exp(v[0]); }, {x});
  check("log", [](auto& v) { return log(v[0]); }, {positive({3, 7})});
  check("sqrt", [](auto& v) { return sqrt(v[0]); }, {positive({3, 7})});
  check("relu", [](auto& v) { return square(relu(v[0])) * v[1]; }, {kinked, y});
  check("leaky_relu", [](auto& v) { return square(leaky_relu(v[0], 0.2)) * v[1]; }, {kinked, y});
  check("sin", [](auto& v) { return sin(v[0]); }, {x});
  check("cos", [](auto& v) { return cos(v[0]); }, {x});
  check("mixed", [](auto& v) { return tanh(v[0] * v[1]) * exp(v[1]) + sigmoid(v[0]); }, {x, y});
}

TEST_CASE("reductions and broadcasts" * doctest::test_suite("double")) {
  const Input x = randn({4, 3, 5});
  for (int axis : {0, 1, 2, -1}) check("sum", [=](auto& v) { return square(sum(v[0], axis, 0.5)); }, {x});
  check("sum_last", [](auto& v) { return square(sum(v[0], -1)); }, {x});
  check("mean", [](auto& v) { return square(mean(v[0])); }, {x});
  check(
      "long sum", [](auto& v) { return square(sum(v[0], 0)); }, {randn({300, 2})}, 2);
  check("mean_frames", [](auto& v) { return square(mean(v[0], 0)); }, {x});
  check("sum_per_sample", [](auto& v) { return square(sum_per_sample(v[0])); }, {x});
  for (const Shape& from : {Shape{5}, Shape{1}, Shape{3, 1}, Shape{3, 5}, Shape{4, 1, 5}, Shape{1, 3, 1}})
    check("broadcast_to", [](auto& v) { return square(broadcast_to(v[0], {4, 3, 5})); }, {randn(from)});
  check("expand_scalar", [](auto& v) { return square(broadcast_to(v[0], {2, 3})); }, {randn({1})});
  check("upsample_nearest", [](auto& v) { return square(upsample_nearest(v[0], 2)); }, {x});
  check("sum_frames", [](auto& v) { return square(sum_pool(v[0], 2, 0.5)); }, {x});
  check("softmax", [](auto& v) { return softmax(v[0]) * v[1]; }, {x, randn({4, 3, 5})});
  check("log_softmax", [](auto& v) { return square(log_softmax(v[0])) * v[1]; }, {x, randn({4, 3, 5})});
  check("cross_entropy", [](auto& v) { return cross_entropy(v[0], v[1]); }, {randn({4, 3}), randn({4, 3})});
}

TEST_CASE("relu of a sum with a broadcast operand" * doctest::test_suite("double")) {
  // Values far from the kink, so that no difference step crosses it.
  Input big = randn({6, 2, 5}, 3), small = randn({3, 2, 5});
  for (double& v : small.values) v *= 0.5;
  for (std::size_t i = 0; i < big.values.size(); ++i) big.values[i] += 2 * (big.values[i] > 0 ? 1 : -1);
  check("relu_of_sum", [](auto& v) { return square(relu_of_sum(v[0], v[1])); }, {big, small});
}

TEST_CASE("layout operations" * doctest::test_suite("double")) {
  const Input x = randn({5, 3, 4});
  const Indices offset(double_context(), std::vector<cl_int>{-2, 0, 3}),
      index(double_context(), std::vector<cl_int>{2, 0, 2, 1});
  check("reshape", [](auto& v) { return square(reshape(v[0], {15, 4})); }, {x});
  for (std::size_t axis : {0, 1, 2}) {
    check("slice", [=](auto& v) { return square(slice(v[0], axis, 1, 2)); }, {x});
    check("pad", [=](auto& v) { return square(pad(v[0], axis, 1, 2)) * v[1]; },
          {x, randn({axis == 0 ? 8u : 5u, axis == 1 ? 6u : 3u, axis == 2 ? 7u : 4u})});
    check("concat",
          [=](auto& v) {
            return square(concatenate({v[0], v[1], v[0]}, axis));
          },
          {x, randn({axis == 0 ? 2u : 5u, axis == 1 ? 2u : 3u, axis == 2 ? 2u : 4u})});
  }
  check("shift_frames", [&](auto& v) { return square(shift_frames(v[0], offset, 4)); }, {x});
  check(
      "shift_frames, outside",
      [&](auto& v) { return square(shift_frames(v[0], offset, 4, {.first = 1, .sign = -1, .outside = 3})); },
      {x});
  for (std::size_t frames : {1, 2, 5, 6})
    check("pair_means", [](auto& v) { return square(pair_means(v[0])); }, {randn({frames, 2, 3})});
  check("gather_rows", [&](auto& v) { return square(gather_rows(v[0], index)); }, {randn({3, 5})});
  check("scatter_add_rows", [&](auto& v) { return square(scatter_add_rows(v[0], index, 3)); },
        {randn({4, 5})});
}

TEST_CASE("matmul: plain, transposed and batched" * doctest::test_suite("double")) {
  for (bool ta : {false, true})
    for (bool tb : {false, true}) {
      check("matmul", [=](auto& v) { return square(matmul(v[0], v[1], ta, tb)); },
            {randn(ta ? Shape{4, 3} : Shape{3, 4}), randn(tb ? Shape{5, 4} : Shape{4, 5})});
      check(
          "matmul batch", [=](auto& v) { return square(matmul(v[0], v[1], ta, tb)); },
          {randn(ta ? Shape{2, 4, 3} : Shape{2, 3, 4}), randn(tb ? Shape{2, 5, 4} : Shape{2, 4, 5})}, 2);
    }
}

TEST_CASE("taps: convolutions and linear layers" * doctest::test_suite("double")) {
  for (bool transposed : {false, true})
    for (std::size_t frames : {1, 2, 5}) {
      const auto conv = [=](auto& v) { return square(conv1d(v[0], v[1], {-1, 0, 1}, frames, transposed)); };
      check("3 taps", conv, {randn({frames, 2, 4}), randn({3, transposed ? 4u : 3u, transposed ? 3u : 4u})},
            2);
    }
  check(
      "5 taps",
      [](auto& v) {
        return square(conv1d(v[0], v[1], {-2, -1, 0, 1, 2}, 4));
      },
      {randn({4, 2, 3}), randn({5, 3, 3})}, 2);
  check("uneven offsets",
        [](auto& v) {
          return square(conv1d(v[0], v[1], {0, 3, 1}, 2));
        },
        {randn({5, 2, 3}), randn({3, 4, 3})});
  check("bias and residual",
        [](auto& v) { return square(conv1d(v[0], v[1], {0}, 4, false, {.bias = v[2], .residual = v[3]})); },
        {randn({4, 3}), randn({1, 5, 3}), randn({5}), randn({4, 5})});
  Input apart = randn({5}, 20);  // every sum is far from the ReLU's kink
  check(
      "bias and relu",
      [](auto& v) { return square(conv1d(v[0], v[1], {0}, 4, false, {.bias = v[2], .relu = true})); },
      {randn({4, 3}), randn({1, 5, 3}), apart}, 2);
  check(
      "weights",
      [](auto& v) {
        return square(conv1d_weight(v[0], v[1], {-1, 0, 1}));
      },
      {randn({4, 2, 3}), randn({4, 2, 5})}, 2);
}

TEST_CASE("LSTM layer: fused first derivative, composed higher ones, sequence lengths" *
          doctest::test_suite("double")) {
  const std::size_t frames = 3, batch = 2, k = 3;
  const std::vector<Input> at{randn({frames, batch, 4 * k}), randn({4 * k, k}), randn({batch, k}),
                              randn({batch, k})};
  for (const Indices& lengths : {Indices(), Indices(double_context(), std::vector<cl_int>{3, 1})}) {
    const Function f = [&](auto& v) { return lstm_layer(v[0], v[1], v[2], v[3], lengths); };
    check("lstm_layer", f, at, 2);
    // The composed form has the same values.
    std::vector<Var> xs;
    for (const Input& i : at) xs.push_back(Var::constant(Tensor::from(double_context(), i.shape, i.values)));
    const auto fused = f(xs).value().to_host<double>(),
               composed =
                   detail::lstm_layer_composed(xs[0], xs[1], xs[2], xs[3], lengths).value().to_host<double>();
    for (std::size_t i = 0; i < fused.size(); ++i)
      CHECK(fused[i] == doctest::Approx(composed[i]).epsilon(1e-13));
  }
}

TEST_CASE("forward kinematics" * doctest::test_suite("double")) {
  motion::Skeleton body;
  body.joints = {{"Reference", -1, {1, 2, 3}, {}, {}},   {"Hips", 0, {4, 5, 6}, {}, {}},
                 {"Spine", 1, {0.1, 0.8, -0.2}, {}, {}}, {"Leg", 1, {0.3, -0.5, 0.1}, {}, {}},
                 {"Foot", 3, {0, -0.7, 0.4}, {}, {}},    {"Toe", 4, {0, -0.1, 0.3}, {}, {}}};
  const JointTree tree(double_context(), body, 1);
  CHECK(tree.parent == std::vector<cl_int>{-1, -1, 1, 1, 3, 4});
  const auto positions = [&](auto& v) { return forward_kinematics(v[0], tree); };
  for (const std::size_t poses : {1, 3, 9}) check("large turns", positions, {randn({18, poses})}, 2);
  check("three orders", positions, {randn({18, 2})});
  Input small = randn({18, 5});
  for (double& v : small.values) v *= 0.02;  // the series of the derivatives
  check("small turns", positions, {small});
  check(
      "no turn", [&](auto& v) { return forward_kinematics(1e-3 * v[0], tree); }, {randn({18, 2})}, 2);
  CHECK_THROWS_WITH_AS(forward_kinematics(Var::constant(Tensor(double_context(), {15, 2})), tree),
                       "forward_kinematics: rotations [15, 2], expected [18, poses]", Error);
}

}  // namespace derivatives_test
