// Matrix products, convolutions and recurrent networks with an axis of size 0.
#include <doctest/doctest.h>

#include <motiongan/nn/lstm.hpp>
#include <motiongan/nn/self_attention.hpp>
#include <motiongan/ops/attention.hpp>
#include <motiongan/ops/gru_rollout.hpp>
#include <motiongan/ops/lstm.hpp>
#include <motiongan/ops/rollout.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/optim/sgd.hpp>

#include "../support/check_zero.hpp"

namespace empty_products_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("products of nothing" * doctest::test_suite("double")) {
  const Function product = [](auto& v) { return matmul(v[0], v[1]); };
  check_zero("no rows", product, {{0, 3}, {3, 2}}, {0, 2});
  check_zero("no columns", product, {{2, 3}, {3, 0}}, {2, 0});
  check_zero("no terms", product, {{2, 0}, {0, 3}}, {2, 3});
  check_zero("no problems", product, {{0, 2, 3}, {0, 3, 4}}, {0, 2, 4});
  check_zero("problems without terms", product, {{2, 2, 0}, {2, 0, 4}}, {2, 2, 4});
  const Function scores = [](auto& v) { return attention_scores(v[0], v[1]); };
  check_zero("scores, no frames", scores, {{0, 2, 3}, {4, 2, 3}}, {2, 0, 4});
  check_zero("scores, no samples", scores, {{5, 0, 3}, {4, 0, 3}}, {0, 5, 4});
  check_zero("scores, no channels", scores, {{5, 2, 0}, {4, 2, 0}}, {2, 5, 4});
  const Function apply = [](auto& v) { return attention_apply(v[0], v[1]); };
  check_zero("apply to no frames", apply, {{2, 3, 0}, {0, 2, 4}}, {3, 2, 4});
  check_zero("apply for no frames", apply, {{2, 0, 3}, {3, 2, 4}}, {0, 2, 4});
  check_zero("attention over no frames", [](auto& v) { return attention_map(v[0], v[1]); },
             {{0, 2, 3}, {4, 2, 3}}, {2, 4, 0});
}

TEST_CASE("convolutions of nothing" * doctest::test_suite("double")) {
  const auto conv = [](std::size_t frames, bool transposed = false) {
    return [=](auto& v) { return conv1d(v[0], v[1], {-1, 0, 1}, frames, transposed); };
  };
  check_zero("no frames", conv(2), {{0, 2, 3}, {3, 4, 3}}, {2, 2, 4});
  check_zero("to no frames", conv(0), {{2, 2, 3}, {3, 4, 3}}, {0, 2, 4});
  check_zero("no samples", conv(2), {{2, 0, 3}, {3, 4, 3}}, {2, 0, 4});
  check_zero("no inputs", conv(2), {{2, 2, 0}, {3, 4, 0}}, {2, 2, 4});
  check_zero("no outputs", conv(2), {{2, 2, 3}, {3, 0, 3}}, {2, 2, 0});
  check_zero("no outputs of many rows", conv(300), {{300, 1, 16}, {3, 0, 16}}, {300, 1, 0});
  check_zero("transposed", conv(2, true), {{0, 2, 3}, {3, 3, 4}}, {2, 2, 4});
  check_zero("no taps", [](auto& v) { return conv1d(v[0], v[1], {}, 300); }, {{300, 1, 16}, {0, 2, 16}},
             {300, 1, 2});
  check_zero("linear, no rows", [](auto& v) { return linear(v[0], v[1], {.bias = v[2]}); },
             {{0, 3}, {4, 3}, {4}}, {0, 4});
  check_zero("linear, no samples", [](auto& v) { return linear(v[0], v[1], {.bias = v[2], .relu = true}); },
             {{2, 0, 3}, {4, 3}, {4}}, {2, 0, 4});
  check_zero("weights",
             [](auto& v) {
               return conv1d_weight(v[0], v[1], {-1, 0});
             },
             {{0, 2, 3}, {0, 2, 4}}, {2, 3, 4});
  check_zero("weights, no samples", [](auto& v) { return conv1d_weight(v[0], v[1], {0}); },
             {{5, 0, 3}, {5, 0, 4}}, {1, 3, 4});
  // What remains of a convolution without frames is its bias.
  const Var bias = some({4}),
            y = conv1d(some({0, 2, 3}), some({3, 4, 3}), {-1, 0, 1}, 1, false, {.bias = bias});
  const std::vector<double> of_bias = bias.value().to_host<double>();
  CHECK(slice(reshape(y, {2, 4}), 0, 1, 1).value().to_host<double>() == of_bias);
  CHECK(grad(sum(y), {bias})[0].value().to_host<double>() == std::vector<double>(4, 2.0));
  check_error([] { linear(some({3}), some({4, 3})); }, "linear: input [3], expected rows");
  check_error([] { conv1d_weight(some({2, 2, 3}), some({2, 3, 3}), {0}); }, "expected as many rows");
  check_error(
      [] {
        conv_down(some({4, 2, 3}), some({3, 4, 3}), some({4}), 4);
      },
      "pairs [4, 2, 3] of 4 frames");
}

TEST_CASE("recurrent networks of no samples" * doctest::test_suite("double")) {
  const std::size_t k = 2, dof = 3;
  const auto layer = [](const Indices& lengths) {
    return [=](auto& v) { return lstm_layer(v[0], v[1], v[2], v[3], lengths); };
  };
  const std::vector<Shape> of_lstm{{9, 0, 4 * k}, {4 * k, k}, {0, k}, {0, k}};
  check_zero("lstm_layer", layer({}), of_lstm, {2, 9, 0, k});
  check_zero("with lengths", layer(indices({})), of_lstm, {2, 9, 0, k});
  check_zero("lstm_hidden", [](auto& v) { return lstm_hidden(v[0], v[1]); }, {of_lstm[0], of_lstm[1]},
             {9, 0, k});
  check_zero("last_state", [](auto& v) { return last_state(v[0], 1); }, {{2, 3, 0, k}}, {0, k});
  check_zero("rollout",
             [](auto& v) {
               return rollout(v[0], v[1], {v[2], v[3], v[4], v[5], v[6]});
             },
             {{1, 0, dof}, {4, 0, 4 * k}, {4 * k, dof + k}, {4 * k, 2 * k}, {4 * k}, {dof, k}, {dof}},
             {5, 0, dof});
  check_zero("gru_rollout",
             [](auto& v) {
               return gru_rollout(v[0], v[1], v[2], {v[3], v[4], v[5], v[6], v[7]}, 3);
             },
             {{2, 0, 3 * k}, {0, 3 * k}, {0, dof}, {3 * k, k}, {3 * k}, {3 * k, dof}, {dof, k}, {dof}},
             {3, 0, dof});
}

TEST_CASE("recurrent networks of no steps or hidden units are errors" * doctest::test_suite("double")) {
  const auto lstm = [](std::size_t frames, std::size_t k) {
    return message_of([=] {
      lstm_layer(some({frames, 2, 4 * k}), some({4 * k, k}), some({2, k}), some({2, k}));
    });
  };
  CHECK(lstm(0, 3) ==
        "lstm_layer: gates [0, 2, 12], weights [12, 3]; give at least one step and one hidden unit");
  CHECK(says(lstm(2, 0), "give at least one step and one hidden unit"));
  check_error([] { last_state(some({2, 0, 3, 4}), 0); }, "last_state: states [2, 0, 3, 4] of no step");
  check_error(
      [] {
        rollout(some({1, 2, 3}), some({4, 2, 0}),
                {some({0, 3}), some({0, 0}), some({0}), some({3, 0}), some({3})});
      },
      "rollout: given [1, 2, 3]");
  check_error(
      [] {
        gru_rollout(some({1, 2, 0}), some({2, 0}), some({2, 3}),
                    {some({0, 0}), some({0}), some({0, 3}), some({3, 0}), some({3})}, 2);
      },
      "gru_rollout: gates [1, 2, 0]");
}

TEST_CASE("layers over nothing" * doctest::test_suite("double")) {
  Initializer init(double_context(), 1);
  const SelfAttention attention(init, 8);
  const Conv1d conv(init, 8, 4, 3);
  const Lstm lstm(init, 8, 4, 2);
  for (const Shape& shape : {Shape{0, 2, 8}, Shape{5, 0, 8}}) {
    CHECK(attention(some(shape)).shape() == shape);
    CHECK(conv(some(shape)).shape() == Shape{shape[0], shape[1], 4});
    CHECK(conv_down(pair_means(some(shape)), conv.weight, conv.bias, shape[0]).shape() ==
          Shape{shape[0] / 2, shape[1], 4});
  }
  LstmState state, other;
  CHECK(lstm.advance(some({3, 0, 8}), state).shape() == Shape{3, 0, 4});
  check_error([&] { lstm.advance(some({0, 2, 8}), other); }, "give at least one step");
}

TEST_CASE("kernels of sampling have nothing to do for no frames or samples" * doctest::test_suite("double")) {
  const auto& now = double_context().statistics();
  const auto tensor = [](Shape shape) { return some(std::move(shape)).value(); };
  const Tensor weight = tensor({2, 8}), bias = tensor({8}), scratch = tensor({100}), classes = tensor({2, 3});
  const std::size_t before = now.launches;
  for (const Shape& shape : {Shape{0, 2, 8}, Shape{5, 0, 8}}) {
    const Tensor x = tensor(shape), all = tensor({shape[0], shape[1], 6});
    detail::attend_frames(all, scratch, x, {weight, bias}, x, {x, 0}, 3);
    detail::rows_with_constants(x, classes, {}, {scratch, 0});
    detail::add_broadcast_relu(x, x, x, shape[0], 1, shape[1] * 8);
    detail::copy_runs(x, 3, 2, x, 5, 2, 0, 4);
  }
  CHECK(now.launches == before);
}

TEST_CASE("layers without inputs are errors, optimizers of nothing do nothing" *
          doctest::test_suite("double")) {
  Initializer init(double_context(), 1);
  check_error([&] { Linear(init, 0, 3); },
              "weights of shape [3, 0] cannot be initialised: a layer has no inputs");
  CHECK(Linear(init, 3, 0)(some({2, 3})).shape() == Shape{2, 0});
  Var none = some({0, 3});
  Sgd sgd({{"none", &none}});
  Adam adam({{"none", &none}});
  for (Optimizer* optimizer : {static_cast<Optimizer*>(&sgd), static_cast<Optimizer*>(&adam)})
    CHECK_NOTHROW(optimizer->step({some({0, 3}).detach()}));
}

}  // namespace empty_products_test
