// The RNN critic: parameter names, scores against eq. 10, first and second derivatives.
#include <doctest/doctest.h>

#include <map>
#include <motiongan/networks/rnn_critic.hpp>
#include <motiongan/nn/state_dict.hpp>
#include <motiongan/train/wgan_gp.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace rnn_critic_test {

using namespace motiongan;
using testing::double_context;
using testing::message_of;

namespace {

constexpr std::size_t vocabulary = 7, dof = 3, k = 4, batch = 2;

RnnCritic made(DiffInput diff_input = DiffInput::hidden) {
  return RnnCritic(Initializer(double_context(), 21),
                   {.vocabulary = vocabulary, .dof = dof, .hidden = k, .diff_input = diff_input});
}

Sentences some_text() { return Sentences(double_context(), {{1, 2, 3}, {4}}, vocabulary); }

Tensor some_motion(std::size_t frames, std::uint64_t seed = 1) {
  return random_normal(double_context(), {.seed = seed}, frames, batch, dof);
}

/// x [.., in] through the linear layer called `name`, in plain loops.
Var linear(const std::map<std::string, Var>& parameters, const std::string& name, const Var& x) {
  const Var &w = parameters.at(name + ".weight"), &b = parameters.at(name + ".bias");
  Shape shape = x.shape();
  const std::size_t out = b.size(), in = shape.back(), rows = x.size() / in;
  shape.back() = out;
  const Var y = matmul(reshape(x, {rows, in}), reshape(w, {out, in}), false, true);
  return reshape(y + broadcast_to(b, {rows, out}), shape);
}

/// Eq. 10 (Lin & Amer) layer by layer for one sample: motion [N, 1, dof], text [1, k].
double by_the_equation(RnnCritic& model, const Var& motion, const Var& h_txt) {
  std::map<std::string, Var> p;
  for (const NamedParameter& named : named_parameters(model)) p[named.name] = *named.value;
  const std::size_t frames = motion.dim(0);
  const auto validate = [&](const std::string& name, const Var& h) {
    const Var text = linear(p, name + ".text", reshape(h_txt, {1, 1, k}));
    const Var inner = linear(p, name + ".motion", h) + broadcast_to(text, h.shape());
    return mean(linear(p, name + ".score", relu(inner))).item();
  };
  Var seen = linear(p, "diff", slice(motion, 0, 1, frames - 1) - slice(motion, 0, 0, frames - 1));
  if (model.options().diff_input == DiffInput::hidden) {
    const Var zero = zeros(double_context(), {1, k});
    for (const std::string l : {"l0", "l1"}) {
      std::map<std::string, Var> ih{{"ih.weight", p.at("lstm.weight_ih_" + l)},
                                    {"ih.bias", p.at("lstm.bias_ih_" + l) + p.at("lstm.bias_hh_" + l)}};
      seen = hidden_states(
          detail::lstm_layer_composed(linear(ih, "ih", seen), p.at("lstm.weight_hh_" + l), zero, zero, {}));
    }
  }
  const std::vector<double> weights = p.at("weights").value().to_host<double>();
  return weights[0] * validate("frame_validate", linear(p, "frame", motion)) +
         weights[1] * validate("diff_validate", seen);
}

}  // namespace

TEST_CASE("parameter names and shapes" * doctest::test_suite("double")) {
  RnnCritic model = made();
  std::vector<std::string> lines;
  for (const NamedParameter& p : named_parameters(model))
    lines.push_back(p.name + " " + to_string(io::file_shape(p)));
  std::vector<std::string> expected{"text.embedding.weight [7, 4]"};
  const auto lstm = [&](const std::string& name) {
    for (const char* layer : {"l0", "l1"})
      for (const char* line :
           {"weight_ih_%s [16, 4]", "weight_hh_%s [16, 4]", "bias_ih_%s [16]", "bias_hh_%s [16]"}) {
        std::string text = line;
        text.replace(text.find("%s"), 2, layer);
        text.insert(0, name + ".");
        expected.push_back(text);
      }
  };
  lstm("text.lstm");
  for (const char* line : {"text.proj.weight [4, 16]", "text.proj.bias [4]", "frame.weight [4, 3]",
                           "frame.bias [4]", "diff.weight [4, 3]", "diff.bias [4]"})
    expected.emplace_back(line);
  lstm("lstm");
  for (const std::string name : {"frame_validate", "diff_validate"})
    for (const char* line : {"motion.weight [4, 4, 1]", "motion.bias [4]", "text.weight [4, 4, 1]",
                             "text.bias [4]", "score.weight [1, 4, 1]", "score.bias [1]"})
      expected.push_back(name + "." + line);
  expected.emplace_back("weights [2]");
  CHECK(lines == expected);
  CHECK(parameter_count(named_parameters(model)) > 0);
  CHECK(named_parameters(model).back().value->value().to_host() == std::vector<float>{0.5F, 0.5F});
}

TEST_CASE("scores follow eq. 10, on the LSTM's states or on the differences" *
          doctest::test_suite("double")) {
  std::vector<double> by_option;
  for (DiffInput diff_input : {DiffInput::hidden, DiffInput::difference})
    for (std::size_t frames : {2, 3, 9}) {
      RnnCritic model = made(diff_input);
      Tensor weights = named_parameters(model).back().value->value();
      weights.write(std::span<const double>(std::vector<double>{0.7, -1.3}));
      const Var motion = Var::constant(some_motion(frames)), text = model.encode_text(some_text());
      const std::vector<double> scores = model(motion, text).value().to_host<double>();
      REQUIRE(scores.size() == batch);
      for (std::size_t b = 0; b < batch; ++b)
        CHECK(scores[b] ==
              doctest::Approx(by_the_equation(model, slice(motion, 1, b, 1), slice(text, 0, b, 1)))
                  .epsilon(1e-12));
      by_option.push_back(scores[0]);
    }
  CHECK(by_option[2] != doctest::Approx(by_option[5]).epsilon(1e-3));
}

TEST_CASE("a sample's score does not depend on its batch; it depends on text and motion" *
          doctest::test_suite("double")) {
  const RnnCritic model = made();
  const std::vector<double> both =
      model(Var::constant(some_motion(6)), model.encode_text(some_text())).value().to_host<double>();
  const Var first = slice(Var::constant(some_motion(6)), 1, 0, 1);
  const Var text = model.encode_text(Sentences(double_context(), {{1, 2, 3}}, vocabulary)),
            other_text = model.encode_text(Sentences(double_context(), {{5}}, vocabulary));
  CHECK(model(first, text).item() == both[0]);
  CHECK(model(first, other_text).item() != both[0]);
  CHECK(model(2 * first, text).item() != both[0]);
}

TEST_CASE("motion of one frame or another size is rejected" * doctest::test_suite("double")) {
  const RnnCritic model = made();
  const Var text = model.encode_text(some_text());
  CHECK(message_of([&] { model(Var::constant(some_motion(1)), text); }) ==
        "RnnCritic: motion [1, 2, 3], expected [2 or more frames, batch, 3]");
  const Tensor wide(double_context(), {4, batch, dof + 1}), flat(double_context(), {4, dof});
  CHECK(message_of([&] { model(Var::constant(wide), text); }) ==
        "RnnCritic: motion [4, 2, 4], expected [2 or more frames, batch, 3]");
  CHECK_THROWS_AS(model(Var::constant(flat), text), Error);
  CHECK(message_of([&] { RnnCritic(Initializer(double_context(), 1), {.vocabulary = 3}); }) ==
        "RnnCritic: vocabulary, dof and hidden must be positive");
}

TEST_CASE("derivatives of the score with respect to motion and every parameter" *
          doctest::test_suite("double")) {
  for (DiffInput diff_input : {DiffInput::hidden, DiffInput::difference}) {
    RnnCritic model = made(diff_input);
    const std::vector<NamedParameter> parameters = named_parameters(model);
    // Motion 1 puts a ReLU at its kink.
    std::vector<testing::Input> at{{{4, batch, dof}, some_motion(4, 3).to_host<double>()}};
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
  for (DiffInput diff_input : {DiffInput::hidden, DiffInput::difference})
    for (std::size_t frames : {2, 7}) {
      CAPTURE(frames);
      RnnCritic model = made(diff_input);
      const std::vector<NamedParameter> parameters = named_parameters(model);
      const Sentences text = some_text();
      const Var x = Var::leaf(some_motion(frames, 6));
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

}  // namespace rnn_critic_test
