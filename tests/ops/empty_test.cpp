// Tensors with an axis of size 0: the empty or zero result that mathematics gives, or an Error.
#include <doctest/doctest.h>

#include <motiongan/core/random.hpp>
#include <motiongan/ops/cross_entropy.hpp>
#include <motiongan/ops/layout.hpp>

#include "../support/check_zero.hpp"

namespace empty_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("elementwise operations on nothing" * doctest::test_suite("double")) {
  const Shape none{0, 3};
  check_zero(
      "affine", [](auto& v) { return affine(v[0], 2, 3); }, {none}, none);
  check_zero(
      "sum", [](auto& v) { return v[0] + v[1]; }, {none, none}, none);
  check_zero(
      "product", [](auto& v) { return v[0] * v[1]; }, {none, none}, none);
  check_zero(
      "quotient", [](auto& v) { return v[0] / v[1]; }, {none, none}, none);
  check_zero(
      "tanh", [](auto& v) { return tanh(v[0]) * sigmoid(v[0]); }, {none}, none);
  check_zero(
      "exp", [](auto& v) { return exp(v[0]) + log(v[0]) + sqrt(v[0]); }, {none}, none);
  check_zero(
      "relu", [](auto& v) { return leaky_relu(v[0], 0.2); }, {none}, none);
  check_zero("reshape", [](auto& v) { return reshape(v[0], {3, 5, 0}); }, {none}, {3, 5, 0});
}

TEST_CASE("sums of nothing are 0, means are errors" * doctest::test_suite("double")) {
  check_zero("sum", [](auto& v) { return sum(v[0]); }, {{0, 3}}, {1});
  check_zero("sum over frames", [](auto& v) { return sum(v[0], 0); }, {{0, 3, 5}}, {3, 5});
  check_zero("sum over channels", [](auto& v) { return sum(v[0], -1, 2); }, {{4, 3, 0}}, {4, 3});
  check_zero("sum of no rows", [](auto& v) { return sum(v[0], -1); }, {{0, 4}}, {0});
  check_zero("sum of many empty rows", [](auto& v) { return sum(v[0], 0); }, {{300, 0}}, {0});
  check_zero("sum_per_sample", [](auto& v) { return sum_per_sample(v[0]); }, {{0, 2, 3}}, {2});
  check_zero("sum of no samples", [](auto& v) { return sum_per_sample(v[0]); }, {{2, 0, 3}}, {0});
  check_zero("mean over no columns", [](auto& v) { return mean(v[0], 0); }, {{4, 0}}, {0});
  const Var none = some({2, 0, 3});
  check_error([&] { mean(none); }, "mean: shape [2, 0, 3] has no elements");
  check_error([&] { mean(none, 1); }, "mean: axis 1 of [2, 0, 3] is empty; give at least one frame");
  check_error([&] { mean(none, -2); }, "mean: axis -2 of [2, 0, 3] is empty");
  check_error([&] { mean(none, 3); }, "mean: axis 3 of [2, 0, 3], expected -3 to 2");
  check_error([&] { mean(none, -4); }, "mean: axis -4 of [2, 0, 3], expected -3 to 2");
}

TEST_CASE("broadcasts and pools of nothing" * doctest::test_suite("double")) {
  check_zero("to no frames", [](auto& v) { return broadcast_to(v[0], {0, 3}); }, {{1, 3}}, {0, 3});
  check_zero("to no columns", [](auto& v) { return broadcast_to(v[0], {3, 0}); }, {{3, 1}}, {3, 0});
  check_zero("scalar", [](auto& v) { return broadcast_to(v[0], {2, 0}); }, {{1}}, {2, 0});
  check_zero("of nothing", [](auto& v) { return broadcast_to(v[0], {4, 0, 3}); }, {{0, 3}}, {4, 0, 3});
  check_zero("upsample", [](auto& v) { return upsample_nearest(v[0], 2); }, {{0, 2, 3}}, {0, 2, 3});
  check_zero("no times", [](auto& v) { return upsample_nearest(v[0], 0); }, {{2, 3}}, {0, 3});
  check_zero("pool", [](auto& v) { return sum_pool(v[0], 2); }, {{0, 2, 3}}, {0, 2, 3});
  check_zero("pool of no samples", [](auto& v) { return sum_pool(v[0], 2); }, {{4, 0, 3}}, {2, 0, 3});
  check_zero("normalize no rows", [](auto& v) { return normalize_rows(v[0]); }, {{0, 4}}, {0, 4});
  check_zero("normalize empty rows", [](auto& v) { return normalize_rows(v[0]); }, {{3, 0}}, {3, 0});
  const Function relus = [](auto& v) { return relu_of_sum(v[0], v[1]); };
  check_zero("relu_of_sum, no frames", relus, {{0, 2}, {0, 2}}, {0, 2});
  check_zero("relu_of_sum, no channels", relus, {{4, 0}, {2, 0}}, {4, 0});
  check_error([] { sum_pool(some({4, 2}), 0); }, "sum_pool: groups of 0 frames of [4, 2]");
  check_error([] { sum_pool(some({5, 2}), 2); }, "sum_pool: groups of 2 frames of [5, 2]");
  check_error([] { relu_of_sum(some({0, 2}), some({3, 2})); }, "relu_of_sum: shapes [0, 2] and [3, 2]");
  check_error([] { relu_of_sum(some({4, 2}), some({0, 2})); }, "relu_of_sum: shapes [4, 2] and [0, 2]");
  check_error([] { relu_of_sum(some({4, 2}), some({3, 2})); }, "relu_of_sum: shapes [4, 2] and [3, 2]");
  check_error([] { upsample_nearest(some({}), 2); }, "upsample_nearest: shape [] has no axis 0");
}

TEST_CASE("softmax of nothing" * doctest::test_suite("double")) {
  for (const Shape& shape : {Shape{0, 4}, Shape{3, 0}, Shape{2, 0, 3}, Shape{0}}) {
    check_zero(
        "softmax", [](auto& v) { return softmax(v[0]); }, {shape}, shape);
    check_zero(
        "log_softmax", [](auto& v) { return log_softmax(v[0]); }, {shape}, shape);
  }
  check_error([] { softmax(some({})); }, "softmax: shape [] has no axis 0");
  check_error(
      [] {
        cross_entropy(some({0, 3}), some({0, 3}));
      },
      "cross_entropy: logits [0, 3]; give at least");
  check_error(
      [] {
        cross_entropy(some({2, 0}), some({2, 0}));
      },
      "cross_entropy: logits [2, 0]; give at least");
  CHECK(one_hot(double_context(), {}, 3).shape() == Shape{0, 3});
}

TEST_CASE("slices, padding and concatenation of nothing" * doctest::test_suite("double")) {
  check_zero("slice", [](auto& v) { return slice(v[0], 1, 1, 2); }, {{0, 3}}, {0, 2});
  check_zero("slice of no columns", [](auto& v) { return slice(v[0], 1, 2, 0); }, {{3, 4}}, {3, 0});
  check_zero("slice of no rows", [](auto& v) { return slice(v[0], 0, 3, 0); }, {{3, 4}}, {0, 4});
  check_zero("pad", [](auto& v) { return pad(v[0], 0, 1, 2); }, {{0, 3}}, {3, 3});
  check_zero("pad no rows", [](auto& v) { return pad(v[0], 1, 1, 2); }, {{0, 3}}, {0, 6});
  check_zero("pad empty rows", [](auto& v) { return pad(v[0], 1, 1, 1); }, {{3, 0}}, {3, 2});
  const auto joined = [](std::size_t axis) {
    return [axis](auto& v) { return concatenate({v[0], v[1]}, axis); };
  };
  check_zero("concatenate", joined(1), {{0, 3}, {0, 2}}, {0, 5});
  check_zero("concatenate frames", joined(0), {{0, 3}, {0, 3}}, {0, 3});
  const Var x = some({2, 3});
  CHECK(concatenate({some({0, 3}), x}, 0).value().to_host<double>() == x.value().to_host<double>());
  CHECK(concatenate({x, some({2, 0})}, 1).value().to_host<double>() == x.value().to_host<double>());
  check_error([&] { slice(x, 2, 0, 1); }, "slice: shape [2, 3] has no axis 2");
  check_error([&] { pad(x, 2, 0, 1); }, "pad: shape [2, 3] has no axis 2");
  check_error([&] { concatenate({x}, 2); }, "concatenate: shape [2, 3] has no axis 2");
}

TEST_CASE("frames and rows of nothing" * doctest::test_suite("double")) {
  const auto shifted = [](const Indices& offset, std::size_t frames) {
    return [=](auto& v) { return shift_frames(v[0], offset, frames); };
  };
  check_zero("shift no frames", shifted(indices({1, -1}), 2), {{0, 2, 3}}, {2, 2, 3});
  check_zero("shift to no frames", shifted(indices({1, -1}), 0), {{2, 2, 3}}, {0, 2, 3});
  check_zero("shift no samples", shifted(indices({}), 2), {{2, 0, 3}}, {2, 0, 3});
  check_zero("shift no channels", shifted(indices({1, -1}), 2), {{2, 2, 0}}, {2, 2, 0});
  check_zero("pair_means", [](auto& v) { return pair_means(v[0]); }, {{0, 2, 3}}, {1, 2, 3});
  check_zero("pair_means of no samples", [](auto& v) { return pair_means(v[0]); }, {{4, 0, 3}}, {5, 0, 3});
  check_zero("its adjoint", [](auto& v) { return pair_means_adjoint(v[0], 0); }, {{1, 2, 3}}, {0, 2, 3});
  check_error([] { pair_means_adjoint(some({0, 2}), 0); }, "pairs [0, 2] of 0 frames, expected 1");
  check_error([] { pair_means_adjoint(some({4, 2}), 4); }, "pairs [4, 2] of 4 frames, expected 5");
  check_zero("gather", [](auto& v) { return gather_rows(v[0], indices({})); }, {{3, 4}}, {0, 4});
  check_zero("gather empty", [](auto& v) { return gather_rows(v[0], indices({1, 1})); }, {{3, 0}}, {2, 0});
  check_zero("scatter", [](auto& v) { return scatter_add_rows(v[0], indices({}), 3); }, {{0, 4}}, {3, 4});
  check_zero("scatter to none", [](auto& v) { return scatter_add_rows(v[0], indices({}), 0); }, {{0, 4}},
             {0, 4});
}

TEST_CASE("random numbers for nothing" * doctest::test_suite("double")) {
  CHECK(random_normal(double_context(), {}, 0, 2, 3).shape() == Shape{0, 2, 3});
  CHECK(random_normal(double_context(), {}, 2, 2, 0).shape() == Shape{2, 2, 0});
  CHECK(random_uniform(double_context(), {}, 0).size() == 0);
  CHECK(random_integers(double_context(), {}, 0, 0, 3).size() == 0);
}

}  // namespace empty_test
