// Frozen: which gradients flow during its lifetime and after it.
#include <doctest/doctest.h>

#include <motiongan/nn/module.hpp>
#include <motiongan/ops/elementwise.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace frozen_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

Var leaf(double value) { return Var::leaf(Tensor::from(double_context(), {1}, std::vector<double>{value})); }

}  // namespace

TEST_CASE("a graph recorded while a parameter was frozen has its whole gradient afterwards" *
          doctest::test_suite("double")) {
  Var p = leaf(3);
  const Var x = leaf(2);
  const auto f = [&] { return x * square(p) + x * p; };  // by p: 2 x p + x, by x: p^2 + p
  const std::vector<NamedParameter> parameters{{"p", &p}};
  Var recorded, of_frozen_alone;
  {
    const Frozen frozen(parameters);
    recorded = f();
    of_frozen_alone = square(p);
    CHECK(grad(recorded, {x})[0].item() == 12);
  }
  CHECK(grad(recorded, {p})[0].item() == 14);
  CHECK(grad(recorded, {x})[0].item() == 12);
  CHECK(grad(of_frozen_alone, {p})[0].item() == 6);
  const Var slope = grad(recorded, {x}, {.create_graph = true})[0];
  CHECK(grad(slope, {p})[0].item() == 7);
}

TEST_CASE("the gradient of a frozen parameter is an error, whenever its graph was recorded" *
          doctest::test_suite("double")) {
  Var p = leaf(3), q = leaf(5), none;
  const std::vector<NamedParameter> parameters{{"p", &p}, {"none", &none}};
  const Var before = p * q;
  {
    const Frozen frozen(parameters);
    { const Frozen again(parameters); }
    const Var during = p * q;
    for (const Var& y : {before, during}) {
      CHECK(says(message_of([&] { grad(y, {p}); }), "grad: an input of shape [1] is frozen"));
      CHECK(says(message_of([&] { grad(y, {q, p}); }), "end the lifetime of Frozen"));
      CHECK(grad(y, {q})[0].item() == 3);
    }
  }
  CHECK(grad(before, {p})[0].item() == 5);
}

}  // namespace frozen_test
