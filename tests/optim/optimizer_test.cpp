// What all optimizers share: the buffer of the parameters.
#include <doctest/doctest.h>

#include <memory>
#include <motiongan/nn/linear.hpp>
#include <motiongan/optim/adam.hpp>
#include <motiongan/optim/sgd.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace optimizer_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

Var leaf(const std::vector<double>& values) {
  return Var::leaf(Tensor::from(double_context(), {values.size()}, values));
}
Var constant(const std::vector<double>& values) { return leaf(values).detach(); }
std::vector<double> host(const Var& v) { return v.value().to_host<double>(); }

constexpr SgdOptions plain{.learning_rate = 0.5, .decay_every = 0, .clip_norm = 0};

}  // namespace

TEST_CASE("two optimizers take turns with a shared parameter" * doctest::test_suite("double")) {
  Var shared = leaf({1, 2}), own = leaf({10}), other = leaf({20});
  Sgd first({{"own", &own}, {"shared", &shared}}, plain);
  Sgd second({{"shared", &shared}, {"other", &other}}, plain);
  first.step({constant({2}), constant({2, 4})});
  CHECK(host(shared) == std::vector<double>{0, 0});
  CHECK(host(own) == std::vector<double>{9});
  second.step({constant({-2, -2}), constant({4})});
  CHECK(host(shared) == std::vector<double>{1, 1});
  CHECK(host(other) == std::vector<double>{18});
  first.step({constant({2}), constant({2, 0})});
  first.step({constant({2}), constant({2, 0})});
  CHECK(host(shared) == std::vector<double>{-1, 1});
  CHECK(host(own) == std::vector<double>{7});
  CHECK(host(other) == std::vector<double>{18});
  // A graph from before a move can still be differentiated.
  const Var loss = sum(square(shared) * shared);
  second.step({constant({0, 0}), constant({0})});
  CHECK(host(grad(loss, {shared})[0]) == std::vector<double>{3, 3});
}

TEST_CASE("clipping applies to the parameters, also after another optimizer has moved them" *
          doctest::test_suite("double")) {
  Var p = leaf({-4, 0.25});
  Adam first({{"p", &p}});
  const Adam second({{"p", &p}});
  first.clip(1);
  CHECK(host(p) == std::vector<double>{-1, 0.25});
}

TEST_CASE("a parameter that nobody has moved costs no launch" * doctest::test_suite("double")) {
  Var p = leaf({1, 2}), q = leaf({3});
  Sgd sgd({{"p", &p}, {"q", &q}}, plain);
  const auto launches = [&](Sgd& optimizer) {
    const std::size_t before = double_context().statistics().launches;
    optimizer.step({constant({1, 1}), constant({1})});
    return double_context().statistics().launches - before;
  };
  CHECK(launches(sgd) == 2);  // the gradients are copied, the parameters updated
  Sgd thief({{"q", &q}}, plain);
  CHECK(launches(sgd) == 3);  // q moves back
  CHECK(launches(sgd) == 2);
}

TEST_CASE("a new optimizer takes over from one that is gone" * doctest::test_suite("double")) {
  Var p = leaf({1, 2});
  auto first = std::make_unique<Sgd>(std::vector<NamedParameter>{{"p", &p}}, plain);
  first->step({constant({2, 2})});
  first.reset();
  CHECK(host(p) == std::vector<double>{0, 1});
  Sgd second({{"p", &p}}, plain);
  second.step({constant({2, 2})});
  CHECK(host(p) == std::vector<double>{-1, 0});
}

TEST_CASE("a parameter listed twice is an error that names both places" * doctest::test_suite("double")) {
  Var p = leaf({1, 2}), q = leaf({3}), alias = p;
  const std::string text = message_of([&] { Sgd({{"p", &p}, {"q", &q}, {"tied", &alias}}, plain); });
  CHECK(says(text, "Sgd: the parameters \"p\" and \"tied\" are one"));
  CHECK(says(text, "list it once"));
}

}  // namespace optimizer_test
