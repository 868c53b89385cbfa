// Adam against PyTorch's formula on the host, and against results of PyTorch 1.13.
#include <doctest/doctest.h>

#include <motiongan/nn/linear.hpp>
#include <motiongan/optim/adam.hpp>

namespace adam_test {

using namespace motiongan;

namespace {

/// The gradient of the first five parameters at step t: very different magnitudes, changing signs.
double gradient(std::size_t i, std::size_t t) {
  constexpr double scale[] = {1, 1e-3, 100, 1, 1e-6};
  return (static_cast<double>((i * 7 + t * 3) % 11) - 5) / 8 * scale[i % 5];
}

/// torch.optim.Adam, elementwise.
struct PlainAdam {
  AdamOptions o;
  std::vector<double> p, m, v;
  void step(const std::vector<double>& g, std::size_t t) {
    const double c1 = 1 - std::pow(o.beta1, static_cast<double>(t)),
                 c2 = 1 - std::pow(o.beta2, static_cast<double>(t));
    for (std::size_t i = 0; i < p.size(); ++i) {
      m[i] = o.beta1 * m[i] + (1 - o.beta1) * g[i];
      v[i] = o.beta2 * v[i] + (1 - o.beta2) * g[i] * g[i];
      p[i] -= o.learning_rate / c1 * m[i] / (std::sqrt(v[i]) / std::sqrt(c2) + o.epsilon);
    }
  }
};

std::vector<double> first_values(std::size_t n) {
  std::vector<double> values{0.5, -1, 2, 0.001, 100};
  for (std::size_t i = 5; i < n; ++i) values.push_back(std::sin(static_cast<double>(i)));
  values.resize(n);
  return values;
}

std::vector<double> gradients_of(std::size_t n, std::size_t t) {
  std::vector<double> g;
  for (std::size_t i = 0; i < n; ++i) g.push_back(gradient(i, t));
  return g;
}

}  // namespace

TEST_CASE("a schedule lowers the rate to a hundredth, linearly or along a cosine") {
  ScheduleOptions s;
  CHECK(s.factor(50, 100) == 1);
  s.shape = LearningSchedule::linear;
  CHECK(s.factor(0, 100) == 1);
  CHECK(s.factor(50, 100) == doctest::Approx(0.505));
  CHECK(s.factor(100, 100) == doctest::Approx(0.01));
  s.fix(200);
  s.fix(1000);  // a longer training does not move the end
  CHECK(s.factor(100, 1000) == doctest::Approx(0.505));
  CHECK(s.factor(900, 1000) == doctest::Approx(0.01));
  s.shape = LearningSchedule::cosine;
  CHECK(s.factor(50, 0) == doctest::Approx(0.01 + 0.99 * (1 + std::sqrt(0.5)) / 2));
}

TEST_CASE("the rate factor scales a step" * doctest::test_suite("double")) {
  const Context context({.precision = Precision::f64});
  double moved[2];
  for (const double factor : {1.0, 0.25}) {
    Var p = Var::leaf(Tensor::from(context, {1}, std::vector<double>{3}));
    Adam adam({{"p", &p}}, {});
    adam.set_rate_factor(factor);
    adam.step({Var::constant(Tensor::from(context, {1}, std::vector<double>{0.7}))});
    moved[factor == 1 ? 0 : 1] = p.value().to_host<double>()[0] - 3;
  }
  CHECK(moved[1] == doctest::Approx(0.25 * moved[0]));
}

TEST_CASE("five steps in double equal the formula to rounding, whatever the number of parameters" *
          doctest::test_suite("double")) {
  const Context context({.precision = Precision::f64});
  for (const AdamOptions& options :
       {AdamOptions{}, AdamOptions{1e-2, 0.9, 0.999, 1e-8}, AdamOptions{0.1, 0, 0.5, 0.1}})
    for (std::size_t n : {1, 5, 8, 31, 1000}) {
      Var p = Var::leaf(Tensor::from(context, {n}, first_values(n)));
      Adam adam({{"p", &p}}, options);
      PlainAdam plain{options, first_values(n), std::vector<double>(n), std::vector<double>(n)};
      double worst = 0;
      for (std::size_t t = 1; t <= 5; ++t) {
        adam.step({Var::constant(Tensor::from(context, {n}, gradients_of(n, t)))});
        plain.step(gradients_of(n, t), t);
        const std::vector<double> ours = p.value().to_host<double>();
        for (std::size_t i = 0; i < n; ++i)
          worst = std::max(worst, std::abs(ours[i] - plain.p[i]) / (1e-3 + std::abs(plain.p[i])));
      }
      CAPTURE(n);
      CHECK(worst < 1e-14);
      CHECK(adam.steps() == 5);
    }
}

TEST_CASE("five steps in float equal PyTorch 1.13's to two units in the last place") {
  // torch.optim.Adam([p], lr, betas, eps=1e-8), float32, the gradients above.
  const struct {
    AdamOptions options;
    std::vector<float> expected;
  } runs[] = {{{1e-4, 0.5, 0.9, 1e-8},
               {0x1.000b6ap-1f, -0x1.0005a4p+0f, 0x1.fff5b6p+0f, 0x1.405f3ep-10f, 0x1.8fffe0p+6f}},
              {{1e-2, 0.9, 0.999, 1e-8},
               {0x1.058940p-1f, -0x1.042e90p+0f, 0x1.fae544p+0f, 0x1.a3e618p-6f, 0x1.8ff350p+6f}}};
  const Context context;
  for (const auto& run : runs) {
    Var p = Var::leaf(Tensor::from(context, {5}, first_values(5)));
    Adam adam({{"p", &p}}, run.options);
    for (std::size_t t = 1; t <= 5; ++t)
      adam.step({Var::constant(Tensor::from(context, {5}, gradients_of(5, t)))});
    const std::vector<float> ours = p.value().to_host();
    for (std::size_t i = 0; i < 5; ++i) {
      CAPTURE(i);
      const float unit = std::nextafter(std::abs(run.expected[i]), 1e9f) - std::abs(run.expected[i]);
      CHECK(std::abs(ours[i] - run.expected[i]) <= 2 * unit);
    }
  }
}

TEST_CASE("all parameters move into one buffer, and one launch updates them") {
  const Context context;
  Initializer init(context, 1);
  Linear first(init, 6, 4), second(init, 4, 2);
  ParameterList list;
  list.add_module("first", first);
  list.add_module("second", second);
  std::vector<std::vector<float>> before;
  for (const NamedParameter& p : list.items()) before.push_back(p.value->value().to_host());
  Adam adam(list.items());
  for (std::size_t i = 0; i < list.items().size(); ++i) {
    const Tensor& value = list.items()[i].value->value();
    CHECK(value.to_host() == before[i]);  // moved, not changed
    CHECK(value.buffer() == first.weight.value().buffer());
  }
  std::vector<Var> gradients;
  for (const Var& p : adam.parameters()) gradients.push_back(ones(context, p.shape()));
  const std::size_t launches = context.statistics().launches, reads = context.statistics().reads;
  adam.step(gradients);
  CHECK(context.statistics().launches - launches == 2);  // the gradients are copied in one, then the update
  CHECK(context.statistics().reads == reads);
  // The first step moves every parameter by the learning rate.
  CHECK(first.weight.value().to_host()[5] == doctest::Approx(before[0][5] - 1e-4));
  CHECK(second.bias.value().to_host()[1] == doctest::Approx(before[3][1] - 1e-4));
  // A layer created before sees the new values.
  CHECK(first(ones(context, {1, 6})).value().to_host() != std::vector<float>(4, 0));
}

TEST_CASE("a zero gradient changes nothing at first") {
  const Context context;
  Var p = Var::leaf(full(context, {3}, 2));
  Adam adam({{"p", &p}});
  adam.step({zeros(context, {3})});
  CHECK(p.value().to_host() == std::vector<float>(3, 2));
}

TEST_CASE("invalid gradients are rejected and change nothing") {
  const Context context;
  Var p = Var::leaf(full(context, {2, 3}, 1)), q = Var::leaf(full(context, {3}, 1));
  CHECK_THROWS_WITH_AS(Adam({}), "Adam: no parameters", Error);
  Adam adam({{"p", &p}, {"q", &q}});
  CHECK_THROWS_WITH_AS(adam.step({ones(context, {2, 3})}), "Adam: 1 gradients for 2 parameters", Error);
  CHECK_THROWS_WITH_AS(adam.step({ones(context, {2, 3}), ones(context, {4})}),
                       "Adam: gradient 1 has shape [4], the parameter [3]", Error);
  CHECK(adam.steps() == 0);
  CHECK(p.value().to_host() == std::vector<float>(6, 1));
}

}  // namespace adam_test
