// The CNN critic: parameter names, level weights, first and second derivatives.
#include <doctest/doctest.h>

#include <motiongan/networks/cnn_critic.hpp>
#include <motiongan/nn/state_dict.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "../support/check_grads.hpp"

namespace critic_test {

using namespace motiongan;
using testing::double_context;

namespace {

constexpr std::size_t vocabulary = 7, dof = 3, k = 4, batch = 2;

CnnCritic made(CnnCriticOptions options) {
  options.vocabulary = vocabulary;
  options.dof = dof;
  options.hidden = k;
  return CnnCritic(Initializer(double_context(), 21), options);
}

std::vector<std::string> listed(const CnnCriticOptions& options) {
  CnnCritic model = made(options);
  std::vector<std::string> lines;
  for (const NamedParameter& p : named_parameters(model))
    lines.push_back(p.name + " " + to_string(io::file_shape(p)));
  return lines;
}

Sentences some_text() { return Sentences(double_context(), {{1, 2, 3}, {4}}, vocabulary); }

Tensor some_motion(std::size_t frames, std::uint64_t seed = 1) {
  return random_normal(double_context(), {.seed = seed}, frames, batch, dof);
}

/// Sets one parameter by name.
void set(CnnCritic& model, const std::string& name, const std::vector<double>& values) {
  for (const NamedParameter& p : named_parameters(model))
    if (p.name == name) {
      Tensor place = p.value->value();
      place.write(std::span<const double>(values));
      return;
    }
  FAIL("no parameter called ", name);
}

std::vector<double> scores(const CnnCritic& model, std::size_t frames) {
  return model(Var::constant(some_motion(frames)), model.encode_text(some_text())).value().to_host<double>();
}

}  // namespace

TEST_CASE("parameter names and shapes, for every validation mode" * doctest::test_suite("double")) {
  const std::vector<std::string> text{"text.embedding.weight [7, 4]",
                                      "text.lstm.weight_ih_l0 [16, 4]",
                                      "text.lstm.weight_hh_l0 [16, 4]",
                                      "text.lstm.bias_ih_l0 [16]",
                                      "text.lstm.bias_hh_l0 [16]",
                                      "text.lstm.weight_ih_l1 [16, 4]",
                                      "text.lstm.weight_hh_l1 [16, 4]",
                                      "text.lstm.bias_ih_l1 [16]",
                                      "text.lstm.bias_hh_l1 [16]",
                                      "text.proj.weight [4, 16]",
                                      "text.proj.bias [4]"};
  const std::vector<std::string> trunk{"encode.weight [4, 3, 1]",           "encode.bias [4]",
                                       "residual.0.conv1.weight [4, 4, 3]", "residual.0.conv1.bias [4]",
                                       "residual.0.conv2.weight [4, 4, 3]", "residual.0.conv2.bias [4]",
                                       "residual.1.conv1.weight [4, 4, 3]", "residual.1.conv1.bias [4]",
                                       "residual.1.conv2.weight [4, 4, 3]", "residual.1.conv2.bias [4]"};
  const std::vector<std::string> level0{"validate.0.motion.weight [4, 4, 1]", "validate.0.motion.bias [4]",
                                        "validate.0.text.weight [4, 4, 1]",   "validate.0.text.bias [4]",
                                        "validate.0.score.weight [1, 4, 1]",  "validate.0.score.bias [1]"};
  const std::vector<std::string> level1{"validate.1.motion.weight [4, 4, 1]", "validate.1.motion.bias [4]",
                                        "validate.1.text.weight [4, 4, 1]",   "validate.1.text.bias [4]",
                                        "validate.1.score.weight [1, 4, 1]",  "validate.1.score.bias [1]"};
  const std::vector<std::string> level2{"validate.2.motion.weight [4, 4, 1]", "validate.2.motion.bias [4]",
                                        "validate.2.text.weight [4, 4, 1]",   "validate.2.text.bias [4]",
                                        "validate.2.score.weight [1, 4, 1]",  "validate.2.score.bias [1]"};
  const auto joined = [&](const std::vector<std::vector<std::string>>& levels) {
    std::vector<std::string> all = text;
    all.insert(all.end(), trunk.begin(), trunk.end());
    for (const auto& level : levels) all.insert(all.end(), level.begin(), level.end());
    all.push_back("level_weight [" + std::to_string(levels.size()) + "]");
    return all;
  };
  CHECK(listed({.frames = 4}) == joined({level0, level1, level2}));
  CHECK(listed({.frames = 4, .validation = Validation::mod2}) == joined({level0, level2}));
  CHECK(listed({.frames = 4, .validation = Validation::final}) == joined({level0}));
  CHECK(listed({.frames = 4, .taps = 5}).at(13) == "residual.0.conv1.weight [4, 4, 5]");
}

TEST_CASE("the score is the weighted sum of the levels' scores, convex at first" *
          doctest::test_suite("double")) {
  for (LevelWeights kind : {LevelWeights::exp, LevelWeights::softmax}) {
    CnnCritic model = made({.frames = 8, .level_weights = kind});
    const std::vector<double> at_first = scores(model, 8);
    // Each level by itself, with all weight on it.
    std::vector<double> mean(batch, 0), weighted(batch, 0);
    const std::vector<double> w{0.3, -1, 0.5, 2};
    double total = 0;
    for (double v : w) total += std::exp(v);
    for (std::size_t level = 0; level < 4; ++level) {
      std::vector<double> only(4, -800);  // exp is 0
      only[level] = 0;
      set(model, "level_weight", only);
      const std::vector<double> s = scores(model, 8);
      for (std::size_t b = 0; b < batch; ++b) {
        mean[b] += s[b] / 4;
        weighted[b] += s[b] * std::exp(w[level]) / (kind == LevelWeights::exp ? 1 : total);
      }
    }
    set(model, "level_weight", w);
    const std::vector<double> found = scores(model, 8);
    for (std::size_t b = 0; b < batch; ++b) {
      CHECK(at_first[b] == doctest::Approx(mean[b]).epsilon(1e-12));
      CHECK(found[b] == doctest::Approx(weighted[b]).epsilon(1e-12));
    }
  }
  // A softmax is invariant to a shift of all its weights.
  CnnCritic model = made({.frames = 8, .level_weights = LevelWeights::softmax});
  set(model, "level_weight", {1, 2, 3, 4});
  const std::vector<double> a = scores(model, 8);
  set(model, "level_weight", {6, 7, 8, 9});
  CHECK(scores(model, 8)[0] == doctest::Approx(a[0]).epsilon(1e-12));
}

TEST_CASE("scores and penalties are the same whether `encode` is applied first or through other layers" *
          doctest::test_suite("double")) {
  const CnnCritic composed = made({.frames = 8}), direct = made({.frames = 8, .composes = false});
  const std::vector<double> expected = scores(composed, 8), found = scores(direct, 8);
  for (std::size_t b = 0; b < batch; ++b) CHECK(std::abs(found[b] - expected[b]) < 1e-12);
  const auto penalty = [&](CnnCritic critic) {
    const Var text = critic.encode_text(some_text());
    const Var loss =
        gradient_penalty([&](const Var& x) { return critic(x, text); }, Var::leaf(some_motion(8)));
    std::vector<double> out{loss.item()};
    for (const Var& g : grad(loss, values_of(named_parameters(critic))))
      for (const double v : g.value().to_host<double>()) out.push_back(v);
    return out;
  };
  const std::vector<double> a = penalty(composed), b = penalty(direct);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) < 1e-10);
}

TEST_CASE("a sample's score does not depend on its batch; it depends on text and motion" *
          doctest::test_suite("double")) {
  const CnnCritic model = made({.frames = 4});
  const std::vector<double> both = scores(model, 4);
  const Var first = slice(Var::constant(some_motion(4)), 1, 0, 1);
  const Var text = model.encode_text(Sentences(double_context(), {{1, 2, 3}}, vocabulary)),
            other_text = model.encode_text(Sentences(double_context(), {{5}}, vocabulary));
  CHECK(model(first, text).item() == both[0]);
  CHECK(model(first, other_text).item() != both[0]);
  CHECK(model(2 * first, text).item() != both[0]);
}

TEST_CASE("motion of another size is rejected" * doctest::test_suite("double")) {
  const CnnCritic model = made({.frames = 4});
  const Var text = model.encode_text(some_text());
  CHECK_THROWS_WITH_AS(model(Var::constant(some_motion(8)), text),
                       "CnnCritic: motion [8, 2, 3], expected [4, batch, 3]", Error);
  CHECK_THROWS_AS(made({.frames = 33}), Error);
}

TEST_CASE("derivatives of the score with respect to motion and every parameter" *
          doctest::test_suite("double")) {
  for (const CnnCriticOptions& options :
       {CnnCriticOptions{.frames = 4}, CnnCriticOptions{.frames = 4, .level_weights = LevelWeights::softmax},
        CnnCriticOptions{.frames = 4, .taps = 5, .validation = Validation::mod2}}) {
    CnnCritic model = made(options);
    const std::vector<NamedParameter> parameters = named_parameters(model);
    std::vector<testing::Input> at{{{4, batch, dof}, some_motion(4).to_host<double>()}};
    for (const NamedParameter& p : parameters)
      at.push_back({p.value->shape(), p.value->value().to_host<double>()});
    const testing::Function f = [&](const std::vector<Var>& values) {
      for (std::size_t i = 0; i < parameters.size(); ++i) *parameters[i].value = values[i + 1];
      return model(values[0], model.encode_text(some_text()));
    };
    CHECK(testing::check_grads(double_context(), f, at, 1) < 1e-7);
  }
}

TEST_CASE("the penalty's gradient for every parameter equals central differences" *
          doctest::test_suite("double")) {
  for (LevelWeights kind : {LevelWeights::exp, LevelWeights::softmax}) {
    CnnCritic model = made({.frames = 4, .level_weights = kind});
    const std::vector<NamedParameter> parameters = named_parameters(model);
    const Sentences text = some_text();
    const Var x = Var::leaf(some_motion(4, 6));
    std::vector<testing::Input> at;
    for (const NamedParameter& p : parameters)
      at.push_back({p.value->shape(), p.value->value().to_host<double>()});
    const testing::Function penalty = [&](const std::vector<Var>& values) {
      for (std::size_t i = 0; i < parameters.size(); ++i) *parameters[i].value = values[i];
      return gradient_penalty([&](const Var& m) { return model(m, model.encode_text(text)); }, x);
    };
    CHECK(testing::check_grads(double_context(), penalty, at, 1) < 1e-7);
  }
}

}  // namespace critic_test
