// The motion-completion baselines: parameter names, rollout, model files.
#include <doctest/doctest.h>

#include <filesystem>
#include <motiongan/models/prediction_model.hpp>

#include "../support/folders.hpp"
#include "../support/messages.hpp"

namespace prediction_models_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t dof = 3, actions = 2, batch = 2;
constexpr Predictor all_predictors[] = {Predictor::lstm, Predictor::seq2seq, Predictor::erd,
                                        Predictor::lstm_3lr};

PredictionModel small(const Context& context, Predictor predictor, std::size_t hidden = 12) {
  return {context, {dof, actions}, {.predictor = predictor, .hidden = hidden}};
}

std::vector<std::string> listed(PredictionModel model) {
  std::vector<std::string> lines;
  for (const NamedParameter& p : named_parameters(model))
    lines.push_back(p.name + " " + to_string(io::file_shape(p)));
  return lines;
}

/// [frames, batch, dof]
std::vector<float> motion(std::size_t frames, float phase = 0) {
  std::vector<float> values;
  for (std::size_t i = 0; i < frames * batch * dof; ++i)
    values.push_back(std::sin(0.37F * static_cast<float>(i) + phase));
  return values;
}

const std::vector<std::size_t> labels{1, 0};

void fill_with(const NamedParameter& p, float value) {
  Tensor place = p.value->value();
  place.write(std::span<const float>(std::vector<float>(place.size(), value)));
}

}  // namespace

TEST_CASE("parameters have PyTorch's names and shapes") {
  const Context context;
  CHECK(listed(small(context, Predictor::seq2seq)) ==
        std::vector<std::string>{"gru.weight_ih_l0 [36, 5]", "gru.weight_hh_l0 [36, 12]",
                                 "gru.bias_ih_l0 [36]", "gru.bias_hh_l0 [36]", "out.weight [3, 12]",
                                 "out.bias [3]"});
  const auto unlabelled = listed({context, {dof, actions}, {.hidden = 12, .labels = false}});
  CHECK(unlabelled.front() == "gru.weight_ih_l0 [36, 3]");
  const auto erd = listed(small(context, Predictor::erd, 40));
  CHECK(erd.size() == 18);
  for (const char* line : {"encode.0.weight [20, 3]", "encode.1.weight [20, 20]",
                           "lstm.weight_ih_l0 [160, 20]", "lstm.weight_hh_l1 [160, 40]",
                           "decode.0.weight [20, 40]", "decode.1.weight [4, 20]", "decode.2.weight [3, 4]"})
    CHECK(std::find(erd.begin(), erd.end(), line) != erd.end());
  const auto lstm_3lr = listed(small(context, Predictor::lstm_3lr));
  CHECK(lstm_3lr.size() == 14);
  CHECK(lstm_3lr.front() == "lstm.weight_ih_l0 [48, 3]");
  CHECK(lstm_3lr.back() == "out.bias [3]");
}

TEST_CASE("the default sizes are those of the papers") {
  CHECK(usual_hidden(Predictor::lstm) == 256);
  CHECK(usual_hidden(Predictor::seq2seq) == 1024);
  CHECK(usual_hidden(Predictor::erd) == 1000);
  CHECK(usual_hidden(Predictor::lstm_3lr) == 1000);
  const Context context;
  CHECK(PredictionModel(context, {dof, actions}, {.predictor = Predictor::lstm}).options().hidden == 256);
  for (const Predictor p : all_predictors) CHECK(enum_from<Predictor>(name_of(p), "predictor") == p);
  CHECK(says(message_of([] { enum_from<Predictor>("gru", "predictor"); }),
             "expected one of lstm, seq2seq, erd, lstm_3lr"));
}

TEST_CASE("a rollout equals feeding back one pose at a time") {
  const Context context;
  for (const Predictor predictor : all_predictors) {
    CAPTURE(std::string(name_of(predictor)));
    const PredictionModel model = small(context, predictor, 40);
    std::vector<float> seen = motion(5);
    const std::vector<float> made = model.predict(seen, batch, labels, 4);
    REQUIRE(made.size() == 4 * batch * dof);
    for (std::size_t t = 0; t < 4; ++t) {
      const std::vector<float> next = model.predict(seen, batch, labels, 1);
      for (std::size_t i = 0; i < next.size(); ++i)
        CHECK(next[i] == doctest::Approx(made[t * batch * dof + i]).epsilon(1e-4));
      const auto frame = made.begin() + static_cast<std::ptrdiff_t>(t * batch * dof);
      seen.insert(seen.end(), frame, frame + batch * dof);
    }
    CHECK(model.predict(motion(5, 1), batch, labels, 4) != made);
    // A prefix gives the same alone as in a batch.
    std::vector<float> first;
    for (std::size_t t = 0; t < 5; ++t)
      for (std::size_t d = 0; d < dof; ++d) first.push_back(motion(5)[t * batch * dof + d]);
    const std::vector<float> alone = model.predict(first, 1, std::span(labels).first(1), 4);
    for (std::size_t t = 0; t < 4; ++t)
      for (std::size_t d = 0; d < dof; ++d) CHECK(alone[t * dof + d] == made[t * batch * dof + d]);
  }
}

TEST_CASE("seq2seq is residual: with a zero output layer it holds the last pose") {
  const Context context;
  PredictionModel model = small(context, Predictor::seq2seq);
  for (const NamedParameter& p : named_parameters(model))
    if (p.name.starts_with("out.")) fill_with(p, 0);
  const std::vector<float> prefix = motion(6), made = model.predict(prefix, batch, labels, 3);
  for (std::size_t i = 0; i < made.size(); ++i) CHECK(made[i] == prefix[5 * batch * dof + i % (batch * dof)]);
  // Its bias is added to the pose in every frame.
  for (const NamedParameter& p : named_parameters(model))
    if (p.name == "out.bias") fill_with(p, 0.25F);
  const std::vector<float> moved = model.predict(prefix, batch, labels, 3);
  for (std::size_t i = 0; i < made.size(); ++i)
    CHECK(moved[i] == doctest::Approx(made[i] + 0.25 * static_cast<double>(i / (batch * dof) + 1)));
}

TEST_CASE("only models that are given the action depend on it") {
  const Context context;
  const std::vector<std::size_t> others{0, 1};
  const auto differs = [&](const PredictionModel& model) {
    return model.predict(motion(5), batch, labels, 2) != model.predict(motion(5), batch, others, 2);
  };
  CHECK(differs(small(context, Predictor::lstm)));
  CHECK(differs(small(context, Predictor::seq2seq)));
  CHECK_FALSE(differs({context, {dof, actions}, {.hidden = 12, .labels = false}}));
  CHECK_FALSE(differs(small(context, Predictor::erd)));
  CHECK_FALSE(differs(small(context, Predictor::lstm_3lr)));
}

TEST_CASE("a loaded model makes the same predictions") {
  const Scratch scratch;
  const Context context;
  for (const Predictor predictor : all_predictors) {
    PredictionModel model(context, {dof, actions},
                          {.predictor = predictor, .hidden = 12, .labels = false, .seed = 7});
    const fs::path path = scratch.path / name_of(predictor);
    model.save(path);
    const PredictionModel loaded = PredictionModel::load(context, path);
    CHECK(loaded.options().predictor == predictor);
    CHECK(loaded.options().labels == false);
    CHECK(loaded.dof() == dof);
    CHECK(loaded.action_count() == actions);
    CHECK(loaded.predict(motion(4), batch, labels, 5) == model.predict(motion(4), batch, labels, 5));
  }
  io::SafeTensors file = io::SafeTensors::read(scratch.path / "erd");
  const auto refused = [&](const char* key, const char* value) {
    io::SafeTensors changed = file;
    changed.metadata[key] = value;
    changed.write(scratch.path / "changed");
    return message_of([&] { PredictionModel::load(context, scratch.path / "changed"); });
  };
  CHECK(says(refused("motiongan_model", "cnn_generator"), "expected one of predictor_lstm"));
  CHECK(says(refused("motiongan_model", "predictor_gru"), "a model called \"predictor_gru\""));
  CHECK(says(refused("options", "[]"), "cannot be read, expected a JSON object"));
  CHECK(says(refused("options", R"({"hidden": 70000, "labels": true})"),
             "hidden is 70000, expected 0 to 65536"));
  CHECK(says(refused("options", R"({"hidden": 14, "labels": true})"), "encode.0.weight"));
  CHECK(says(refused("format", R"({"dof": 4, "actions": 2})"), "encode.0.weight"));
}

TEST_CASE("invalid sizes and calls are refused by name") {
  const Context context;
  CHECK(says(message_of([&] { PredictionModel(context, {0, 1}, {}); }), "dof is 0, expected 1 to 65536"));
  CHECK(says(message_of([&] { PredictionModel(context, {3, 0}, {}); }), "actions is 0, expected 1 to 65536"));
  CHECK(says(message_of([&] { small(context, Predictor::erd, 1); }), "hidden above 1"));
  const PredictionModel model = small(context, Predictor::lstm_3lr);
  CHECK(says(message_of([&] { model.predict(motion(2), batch, labels, 0); }), "frames is 0"));
  CHECK(says(message_of([&] { model.predict(std::vector<float>(7), batch, labels, 1); }),
             "prefixes has 7 values, expected a multiple of 2 x 3"));
  CHECK(says(message_of([&] { model.predict({}, batch, labels, 1); }), "prefixes has 0 values"));
  CHECK(says(message_of([&] { model.predict(motion(2), batch, std::span(labels).first(1), 1); }),
             "1 actions for 2 prefixes"));
  const std::vector<std::size_t> wrong{0, 2};
  CHECK(says(message_of([&] { model.predict(motion(2), batch, wrong, 1); }), "label 2 of sample 1"));
  CHECK(says(message_of([&] {
               small(context, Predictor::seq2seq).next_poses(zeros(context, {2, batch, dof}));
             }),
             "seq2seq is not trained one step ahead"));
}

}  // namespace prediction_models_test
