// The attention networks: parameter names, derivatives, options.
#include <doctest/doctest.h>

#include <motiongan/networks/attention_classifier.hpp>
#include <motiongan/networks/attention_critic.hpp>
#include <motiongan/networks/attention_generator.hpp>
#include <motiongan/networks/lstm_baseline.hpp>
#include <motiongan/nn/state_dict.hpp>
#include <motiongan/ops/cross_entropy.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace attention_models_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr std::size_t dof = 3, classes = 2, k = 8, batch = 2;

Var random(std::size_t frames, std::size_t channels, std::uint64_t seed = 1) {
  return Var::constant(random_normal(double_context(), {.seed = seed}, frames, batch, channels));
}
Var some_classes() {
  const std::vector<std::size_t> labels{1, 0};
  return Var::constant(one_hot(double_context(), labels, classes));
}

/// Sets gamma of the attention to a non-zero value: it starts at 0, where most derivatives vanish.
template <class Model>
void open(Model& model) {
  for (const NamedParameter& p : named_parameters(model))
    if (p.name == "attention.gamma") {
      Tensor place = p.value->value();
      const std::vector<double> gamma{0.6};
      place.write(std::span<const double>(gamma));
    }
}

template <class Model>
std::vector<std::string> listed(Model model) {
  std::vector<std::string> lines;
  for (const NamedParameter& p : named_parameters(model))
    lines.push_back(p.name + " " + to_string(io::file_shape(p)));
  return lines;
}

/// Worst error of the derivatives with respect to input and parameters, up to `order`.
template <class Model, class Call>
double worst(Model model, const Input& x, int order, Call&& call) {
  open(model);
  std::vector<Input> at{x};
  for (const NamedParameter& p : named_parameters(model))
    at.push_back({p.value->shape(), p.value->value().template to_host<double>()});
  return check_grads(
      double_context(),
      [&](const std::vector<Var>& v) {
        Model moved = model;
        const auto parameters = named_parameters(moved);
        for (std::size_t i = 0; i < parameters.size(); ++i) *parameters[i].value = v[i + 1];
        return call(moved, v[0]);
      },
      at, order, 1e-5);
}

AttentionGenerator make_generator(std::size_t noise = 0, bool attention = true) {
  return {Initializer(double_context(), 3),
          {.dof = dof, .classes = classes, .hidden = k, .noise_dim = noise, .attention = attention}};
}
AttentionCritic make_critic(std::size_t told = 0, bool attention = true) {
  return {Initializer(double_context(), 4),
          {.dof = dof, .hidden = k, .classes = told, .attention = attention}};
}

}  // namespace

TEST_CASE("parameter names and shapes" * doctest::test_suite("double")) {
  const std::vector<std::string> attention{"attention.query.weight [1, 8, 1]",
                                           "attention.query.bias [1]",
                                           "attention.key.weight [1, 8, 1]",
                                           "attention.key.bias [1]",
                                           "attention.value.weight [1, 8, 1]",
                                           "attention.value.bias [1]",
                                           "attention.out.weight [8, 1, 1]",
                                           "attention.out.bias [8]",
                                           "attention.gamma [1]"};
  std::vector<std::string> expected{"encode.weight [8, 5, 3]", "encode.bias [8]"};
  const auto block = [&](const std::string& i) {
    for (const char* conv : {".conv1", ".conv2"}) {
      expected.push_back("block." + i + conv + ".weight [8, 8, 3]");
      expected.push_back("block." + i + conv + ".bias [8]");
    }
  };
  block("0");
  expected.insert(expected.end(), attention.begin(), attention.end());
  block("1");
  expected.insert(expected.end(), {"decode.weight [3, 8, 3]", "decode.bias [3]"});
  CHECK(listed(make_generator()) == expected);
  CHECK(listed(make_generator(0, false)).size() == expected.size() - attention.size());
  CHECK(listed(make_generator(4)).front() == "encode.weight [8, 9, 3]");
  CHECK(listed(make_critic()).front() == "encode.weight [8, 3, 3]");
  CHECK(listed(make_critic()).back() == "score.bias [1]");
  CHECK(listed(make_critic(2)).front() == "encode.weight [8, 5, 3]");
  CHECK(listed(make_critic()).size() == listed(make_critic(0, false)).size() + attention.size());
  const std::vector<std::string> lstm{"frame.weight [8, 5]",       "frame.bias [8]",
                                      "lstm.weight_ih_l0 [32, 8]", "lstm.weight_hh_l0 [32, 8]",
                                      "lstm.bias_ih_l0 [32]",      "lstm.bias_hh_l0 [32]",
                                      "out.weight [3, 8]",         "out.bias [3]"};
  CHECK(listed(LstmBaseline(Initializer(double_context(), 1),
                            {.dof = dof, .classes = classes, .hidden = k})) == lstm);
}

TEST_CASE("derivatives of the networks with respect to input and parameters" *
          doctest::test_suite("double")) {
  CHECK(worst(make_generator(2), randn({5, batch, dof}), 1, [&](const auto& m, const Var& x) {
          return m(x, some_classes(), reshape(random(1, 2), {batch, 2}));
        }) < 1e-6);
  CHECK(worst(AttentionClassifier(Initializer(double_context(), 5),
                                  {.dof = dof, .classes = classes, .hidden = k}),
              randn({5, batch, dof}), 1, [](const auto& m, const Var& x) { return m(x); }) < 1e-6);
  CHECK(worst(LstmBaseline(Initializer(double_context(), 6), {.dof = dof, .classes = classes, .hidden = 4}),
              randn({3, batch, dof}), 2,
              [&](const auto& m, const Var& x) { return m(x, some_classes(), 4); }) < 1e-6);
}

TEST_CASE("the gradient penalty through attention has the right gradient" * doctest::test_suite("double")) {
  // The penalty's gradient for every parameter involves second derivatives; compared with finite differences.
  for (const std::size_t told : {std::size_t{0}, classes}) {
    CAPTURE(told);
    CHECK(worst(make_critic(told), randn({7, batch, dof}), 1, [&](const auto& m, const Var& x) {
            return gradient_penalty([&](const Var& y) { return told > 0 ? m(y, some_classes()) : m(y); }, x);
          }) < 2e-6);
  }
}

TEST_CASE("the output depends on class, noise and prior" * doctest::test_suite("double")) {
  AttentionGenerator model = make_generator(2);
  open(model);
  const Var x = random(6, dof), a = some_classes(), n = reshape(random(1, 2, 7), {batch, 2});
  const Var swapped = Var::constant(one_hot(double_context(), std::vector<std::size_t>{0, 1}, classes));
  const auto made = [&](const Var& prior, const Var& c, const Var& noise) {
    return model(prior, c, noise).value().to_host<double>();
  };
  CHECK(made(x, a, n) == made(x, a, n));
  CHECK(made(x, a, n) != made(x, swapped, n));
  CHECK(made(x, a, n) != made(x, a, 2.0 * n));
  CHECK(made(x, a, n) != made(2.0 * x, a, n));
}

TEST_CASE("the baseline in one call equals feeding its own output back step by step" *
          doctest::test_suite("double")) {
  LstmBaseline model(Initializer(double_context(), 6), {.dof = dof, .classes = classes, .hidden = 4});
  const Var prior = random(4, dof);
  const std::vector<double> at_once = model(prior, some_classes(), 3).value().to_host<double>();
  Var seen = prior;
  std::vector<double> step_by_step;
  for (int t = 0; t < 3; ++t) {
    const Var next = model(seen, some_classes(), 1);
    for (const double v : next.value().to_host<double>()) step_by_step.push_back(v);
    seen = concatenate({seen, next}, 0);
  }
  for (std::size_t i = 0; i < at_once.size(); ++i)
    CHECK(at_once[i] == doctest::Approx(step_by_step[i]).epsilon(1e-12));
}

TEST_CASE("attention maps, and the error without attention" * doctest::test_suite("double")) {
  const Var x = random(6, dof);
  const Var map = make_generator().attention_map(x, some_classes());
  CHECK(map.shape() == Shape{batch, 6, 6});
  for (const double total : sum(map, -1).value().to_host<double>()) CHECK(total == doctest::Approx(1));
  CHECK(make_critic().attention_map(random(12, dof)).shape() == Shape{batch, 6, 6});
  CHECK(says(message_of([&] { make_generator(0, false).attention_map(x, some_classes()); }),
             "without attention"));
  CHECK(says(message_of([&] { make_critic(0, false).attention_map(x); }), "without attention"));
}

TEST_CASE("inputs of the wrong shape are rejected" * doctest::test_suite("double")) {
  const Var x = random(6, dof);
  CHECK(says(message_of([&] { make_generator()(random(6, 4), some_classes()); }),
             "AttentionGenerator: prior [6, 2, 4] and classes [2, 2]"));
  CHECK(says(message_of([&] { make_generator(2)(x, some_classes()); }), "noise of 0 values, expected 2"));
  CHECK(says(message_of([&] { make_critic()(random(3, dof)); }), "expected [4 or more frames"));
  CHECK(says(message_of([&] { make_critic()(x, some_classes()); }), "2 classes, expected 0"));
  CHECK(says(message_of([&] { make_critic(2)(x); }), "0 classes, expected 2"));
}

}  // namespace attention_models_test
