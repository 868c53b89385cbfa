// Training of the motion-completion baselines: convergence, batches, resuming bit for bit.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <motiongan/train/train.hpp>

#include "../support/folders.hpp"
#include "../support/small_actions.hpp"

namespace prediction_trainer_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t dof = 3;
constexpr Predictor all_predictors[] = {Predictor::lstm, Predictor::seq2seq, Predictor::erd,
                                        Predictor::lstm_3lr};

float wave(std::size_t frame, std::size_t channel, double rate) {
  return static_cast<float>(std::sin(rate * static_cast<double>(frame) + 2.1 * static_cast<double>(channel)));
}

std::vector<float> waves(std::size_t frames, double rate) {
  std::vector<float> poses;
  for (std::size_t t = 0; t < frames; ++t)
    for (std::size_t d = 0; d < dof; ++d) poses.push_back(wave(t, d, rate));
  return poses;
}

/// Two actions: slow and fast waves.
PredictionData small_data() { return {dof, {waves(60, 0.3), waves(47, 0.5), waves(80, 0.3)}, {0, 1, 0}, 2}; }

/// Options with learning rates for such small models.
PredictionTrainOptions small_options(std::size_t iterations) {
  PredictionTrainOptions options{.iterations = iterations, .batch = 4, .prefix = 10, .future = 6};
  options.sgd.learning_rate = 0.1;
  options.adam.learning_rate = 3e-3;
  options.noise = {{2, 0.01}, {4, 0.05}};
  return options;
}

/// Shared by the tests, so that kernels are compiled once.
const Context& shared_context() {
  static const Context context;
  return context;
}

struct Run {
  Context context = shared_context();
  PredictionModel model;
  PredictionTrainer trainer;
  explicit Run(Predictor predictor, const PredictionTrainOptions& options = small_options(6))
      : model(context, {dof, 2}, {.predictor = predictor, .hidden = 40}),
        trainer(model, small_data(), options) {}
};

std::vector<std::vector<float>> state(PredictionTrainer& trainer) {
  std::vector<std::vector<float>> all = values_in(trainer.model());
  for (const auto& [name, tensor] : trainer.parts().front().optimizer->state())
    all.push_back(tensor.to_host());
  return all;
}

}  // namespace

TEST_CASE("on sine waves every model is far better than zero velocity") {
  const Context& context = shared_context();
  const PredictionData data = small_data();
  constexpr std::size_t prefix = 10, future = 6;
  for (const Predictor predictor : all_predictors) {
    CAPTURE(std::string(name_of(predictor)));
    const bool narrow = predictor == Predictor::erd;  // its bottleneck is a tenth of its width
    PredictionModel model(context, {dof, 2}, {.predictor = predictor, .hidden = narrow ? 80U : 40U});
    PredictionTrainOptions options = small_options(predictor == Predictor::seq2seq ? 400 : 300);
    options.batch = 8;
    CHECK(train(model, data, options).iterations == options.iterations);
    double error = 0, held = 0;
    for (std::size_t at = 0; at < 40; at += 5) {  // windows of a training sequence
      const std::span<const float> sequence = data.sequences[2];
      const std::vector<std::size_t> action{0};
      const auto made = model.predict(sequence.subspan(at * dof, prefix * dof), 1, action, future);
      for (std::size_t i = 0; i < made.size(); ++i) {
        const float truth = sequence[(at + prefix) * dof + i],
                    last = sequence[(at + prefix - 1) * dof + i % dof];
        error += (made[i] - truth) * (made[i] - truth);
        held += (last - truth) * (last - truth);
      }
    }
    CAPTURE(error / held);
    CHECK(error < 0.05 * held);
  }
}

TEST_CASE("a resumed run equals an uninterrupted one bit for bit") {
  const Scratch scratch;
  const fs::path path = scratch.path / "c.safetensors";
  for (const Predictor predictor : all_predictors) {
    CAPTURE(std::string(name_of(predictor)));
    PredictionTrainOptions options = small_options(6);
    options.sgd.decay_every = 2;
    Run unbroken(predictor, options), first(predictor, options), second(predictor, options);
    for (int i = 0; i < 6; ++i) unbroken.trainer.iterate();
    for (int i = 0; i < 3; ++i) first.trainer.iterate();
    save_checkpoint(first.trainer, path);
    load_checkpoint(second.trainer, path);
    CHECK(second.trainer.iteration() == 3);
    for (int i = 0; i < 3; ++i) second.trainer.iterate();
    CHECK(state(second.trainer) == state(unbroken.trainer));
    const io::SafeTensors file = io::SafeTensors::read(path);
    const bool descends = predictor == Predictor::seq2seq;
    CHECK(file.metadata.at(descends ? "sgd.generator.steps" : "adam.generator.steps") == "3");
    CHECK(file.tensors.contains("adam.generator.mean") != descends);
    CHECK(PredictionModel::load(first.context, path).options().predictor == predictor);
    options.noise = {};
    Run other(predictor, options);
    CHECK(says(message_of([&] { load_checkpoint(other.trainer, path); }), "started with noise"));
  }
}

TEST_CASE("a whole run: files, log, resuming with more iterations") {
  const Scratch scratch;
  const Context& context = shared_context();
  PredictionModel model(context, {dof, 2}, {.hidden = 12}), same(context, {dof, 2}, {.hidden = 12}),
      again(context, {dof, 2}, {.hidden = 12});
  const RunFiles files{scratch.path / "run"};
  train(model, small_data(), small_options(3), {.save_dir = files.folder});
  train(same, small_data(), small_options(5), {.save_dir = files.folder, .resume = true});
  train(again, small_data(), small_options(5));
  CHECK(values_in(same) == values_in(again));
  CHECK(read_csv_log(files.log()).column("error").size() == 5);
  PredictionModel loaded = PredictionModel::load(context, files.generator());
  CHECK(values_in(loaded) == values_in(same));
  std::ifstream split(files.split());
  std::string text((std::istreambuf_iterator<char>(split)), {});
  CHECK(text == "sequence\taction\tframes\n0\t0\t60\n1\t1\t47\n2\t0\t80\n");
}

TEST_CASE("the input noise follows its schedule and applies only to one-step-ahead models") {
  const Run run(Predictor::erd);
  CHECK(run.trainer.noise_at(1) == 0);
  CHECK(run.trainer.noise_at(2) == 0.01);
  CHECK(run.trainer.noise_at(3) == 0.01);
  CHECK(run.trainer.noise_at(1'000'000) == 0.05);
  const PredictionTrainOptions defaults;
  CHECK(defaults.noise.front().iteration == 250);
  CHECK(defaults.noise.back().value == 0.7);
  for (const Predictor predictor : all_predictors) {
    CAPTURE(std::string(name_of(predictor)));
    PredictionTrainOptions loud = small_options(1);
    loud.noise = {{0, 0.5}};
    Run noisy(predictor, loud), quiet(predictor, small_options(1));
    noisy.trainer.iterate();
    quiet.trainer.iterate();
    CHECK((noisy.trainer.losses().error != quiet.trainer.losses().error) == noisy.model.one_step_ahead());
  }
}

TEST_CASE("batches contain windows of one sequence with its action; short sequences are left out") {
  const Context& context = shared_context();
  PredictionData data = small_data();
  data.sequences.push_back(waves(15, 0.7));  // one frame too short
  data.actions.push_back(1);
  const PredictionSampler sampler(context, data, 16);
  const PredictionBatch batch = sampler.draw(3, 9, 30);
  const std::vector<float> windows = batch.windows.to_host(), actions = batch.actions.to_host();
  CHECK(batch.windows.shape() == Shape{16, 30, dof});
  CHECK(windows == sampler.draw(3, 9, 30).windows.to_host());
  CHECK(windows != sampler.draw(3, 10, 30).windows.to_host());
  std::size_t fast = 0;
  for (std::size_t b = 0; b < 30; ++b) {
    const bool is_fast = actions[2 * b + 1] == 1;
    fast += is_fast;
    CHECK(actions[2 * b] + actions[2 * b + 1] == 1);
    // A sine wave satisfies x[t+1] + x[t-1] = 2 cos(rate) x[t].
    const double factor = 2 * std::cos(is_fast ? 0.5 : 0.3);
    for (std::size_t t = 1; t + 1 < 16; ++t) {
      const auto x = [&](std::size_t frame) { return windows[(frame * 30 + b) * dof]; };
      CHECK(x(t + 1) + x(t - 1) == doctest::Approx(factor * x(t)).epsilon(1e-3));
    }
  }
  CHECK(fast > 2);
  CHECK(fast < 20);
}

TEST_CASE("invalid data and options are refused by name") {
  const Context& context = shared_context();
  PredictionModel model(context, {dof, 2}, {.hidden = 12});
  const auto refused = [&](const PredictionData& data, const PredictionTrainOptions& options) {
    return message_of([&] { PredictionTrainer(model, data, options); });
  };
  const auto with = [](auto change) {
    PredictionTrainOptions options = small_options(1);
    change(options);
    return options;
  };
  CHECK(says(refused(small_data(), with([](auto& o) { o.batch = 0; })), "batch is 0, expected at least 1"));
  CHECK(says(refused(small_data(), with([](auto& o) { o.prefix = 75; })),
             "no sequence has 81 frames (the longest has 80)"));
  CHECK(says(refused(small_data(), with([](auto& o) { o.iterations = 1U << 24U; })),
             "random numbers count 2^24 steps"));
  CHECK(says(refused(small_data(), with([](auto& o) { o.adam.learning_rate = 0; })),
             "learning_rate is 0, expected above 0"));
  CHECK(says(refused(small_data(), with([](auto& o) { o.sgd.learning_rate = -1; })),
             "sgd_learning_rate is -1, expected above 0"));
  CHECK(says(refused(small_data(), with([](auto& o) {
                       o.noise = {{5, 0.1}, {5, 0.2}};
                     })),
             "noise stage 2 (from iteration 5 on"));
  CHECK(says(refused(small_data(), with([](auto& o) {
                       o.noise = {{5, -0.1}};
                     })),
             "deviations be at least 0"));
  const auto data = [](auto change) {
    PredictionData changed = small_data();
    change(changed);
    return changed;
  };
  const PredictionTrainOptions options = small_options(1);
  CHECK(says(refused(data([](auto& d) { d.actions[1] = 2; }), options), "sequence 1 has action 2"));
  CHECK(says(refused(data([](auto& d) { d.actions.pop_back(); }), options), "3 sequences with 2 actions"));
  CHECK(says(refused(data([](auto& d) { d.sequences[2].pop_back(); }), options), "sequence 2 has 239"));
  CHECK(says(refused(data([](auto& d) { d.sequences[0][7] = NAN; }), options), "sequence 0 contains"));
  CHECK(says(refused(data([](auto& d) { d.action_count = 3; }), options), "do not fit the model"));
  CHECK(says(refused({}, options), "dof is 0"));
  Run run(Predictor::lstm);
  CHECK(says(message_of([&] { static_cast<void>(run.trainer.losses()); }), "no iteration"));
}

}  // namespace prediction_trainer_test
