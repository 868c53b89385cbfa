// The graph: long chains, and release of memory.
#include <doctest/doctest.h>

#include <motiongan/core/random.hpp>
#include <motiongan/ops/lstm.hpp>

#include "../support/check_grads.hpp"

namespace graph_test {

using namespace motiongan;

namespace {

constexpr std::size_t long_chain = 200'000;

/// 2x as one op without work on the device: both inputs are the same value.
Var doubled(const Var& x) {
  return record("doubled", {x, x}, x.value(),
                [](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {g, {}};
                });
}

}  // namespace

TEST_CASE("a chain of 200,000 operations is traversed and destroyed without recursion") {
  const Context context;
  const Var x = Var::leaf(full(context, {4}, 2));
  Var y = x;
  for (std::size_t i = 0; i < long_chain; ++i) y = reshape(y, i % 2 ? Shape{4} : Shape{2, 2});
  CHECK(grad(y, {x})[0].value().to_host() == std::vector<float>(4, 1));
  // The recorded backward pass is a chain of the same length.
  Var gradient = grad({y}, {Var::leaf(full(context, {4}, 3))}, {x}, {.create_graph = true})[0];
  CHECK(gradient.value().to_host() == std::vector<float>(4, 3));
  y = Var();
  gradient = Var();
  CHECK(context.statistics().bytes_in_use == 256);  // x alone
}

TEST_CASE("a long chain of operations that use their input twice") {
  const Context context;
  const Var x = Var::leaf(full(context, {1}, 2));
  Var y = x;
  for (std::size_t i = 0; i < long_chain; ++i) y = doubled(y);
  CHECK(grad(y, {x})[0].item() == 1);
  y = Var();
  CHECK(x.node().use_count() == 1);
}

TEST_CASE("a node still in use outlives the graph around it") {
  const Context context;
  const Var x = Var::leaf(full(context, {2}, 3));
  Var middle;
  {
    Var y = x;
    for (int i = 0; i < 10; ++i) {
      y = 1.0 * y;
      if (i == 4) middle = y * y;
    }
  }
  CHECK(grad(middle, {x})[0].value().to_host() == std::vector<float>{6, 6});
}

TEST_CASE("memory returns to the pool after backward passes of any order") {
  const Context context;
  const auto& now = context.statistics();
  const Var x = Var::leaf(random_normal(context, {.seed = 1}, 6, 3, 8)),
            w = Var::leaf(random_normal(context, {.seed = 2}, 1, 32, 8).reshape({32, 8}));
  const std::size_t before = now.bytes_in_use;
  std::size_t allocations = 0;
  for (int i = 0; i < 4; ++i) {
    {
      const Var gates = reshape(matmul(reshape(x, {18, 8}), w, false, true), {6, 3, 32});
      const Var zero = zeros(context, {3, 8});
      const Var y = mean(square(lstm_layer(gates, w, zero, zero)));
      const std::vector<Var> first = grad(y, {x, w}, {.create_graph = true});
      const Var norm = sum(square(first[0]));
      const std::vector<Var> second = grad(norm, {x, w});
      CHECK(now.bytes_in_use > before);
    }
    CHECK(now.bytes_in_use == before);
    if (i == 0) allocations = now.allocations;
  }
  CHECK(now.allocations == allocations);  // later rounds are served from the pool
}

TEST_CASE("a failed backward pass leaks nothing") {
  const Context context;
  const Var x = Var::leaf(full(context, {2}, 1));
  const std::size_t before = context.statistics().bytes_in_use;
  {
    const Var y =
        record("failing", {x}, x.value(),
               [](const Node&, const Var&, const Needs&) -> std::vector<Var> { throw Error("on purpose"); });
    CHECK_THROWS_WITH_AS(grad(square(y), {x}), "on purpose", Error);
  }
  CHECK(context.statistics().bytes_in_use == before);
  CHECK((x * x).requires_grad());  // recording is on as before
}

}  // namespace graph_test
