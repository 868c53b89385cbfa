// Training of the LSTM baseline (Malek-Podjaski & Deligianni): MSE on the T frames that follow a prior.
#pragma once
#include "motiongan/models/action_gan.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/train/action_windows.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan {

/// Options of BaselineTrainer.
struct BaselineTrainOptions {
  std::size_t iterations = 20'000;  ///< steps
  std::size_t batch = 64;           ///< windows in a step
  bool balanced = true;             ///< draw classes with equal probability, however many clips they have
  AdamOptions adam{};
  std::uint64_t seed = 1;  ///< of the initial weights, batches and noise

  /// Update steps in an iteration.
  std::size_t steps() const { return 1; }

  void list_fields(FieldList& list) {
    list.add(iterations,
             {.key = "iterations", .help = "how long to train", .range = Range::at_least(1), .saved = false});
    list.add(batch, {.key = "batch", .help = "windows in a step", .range = Range::at_least(1)});
    list.add(balanced, {.key = "balanced",
                        .help = "draw all classes with equal probability, however many clips they have"});
    adam.list_fields(list);
    list.add(seed, {.key = "seed", .help = "of the initial weights, batches and noise"});
  }
};

/// Losses of the last iteration.
struct BaselineLosses {
  double error = 0;  ///< MSE of the generated frames, normalised

  /// The columns of the log.
  std::vector<NamedLoss> named() const { return {{"error", error}}; }
};

/// Trains an ActionGan whose generator is the LSTM.
class BaselineTrainer : public ModelTrainer<ActionGan, BaselineTrainOptions, BaselineLosses> {
 public:
  /// Throws Error if the model has an attention generator, or if the data set's format or an option does not
  /// fit.
  BaselineTrainer(ActionGan& model, const motion::ActionDataset& data, const BaselineTrainOptions& options)
      : ModelTrainer(model, options),
        windows_(model.context(), data, data.train, options.balanced),
        adam_(named_parameters(model), options.adam) {
    model.baseline();  // throws for the attention model
    detail::require_same_format(data.format, model.format());
  }

  std::vector<TrainedPart> parts() override { return {{"generator", named_parameters(model_), &adam_}}; }

  /// One update.
  void iterate() override {
    follow_schedule(options_.adam.schedule);
    const KeepPacked weights_packed;
    const auto step = static_cast<std::uint32_t>(iteration_);
    loss_ = parallel_step(adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
              const ActionBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
              const Var made = model_.forward(Var::constant(batch.prior), Var::constant(batch.classes));
              const Var loss = mean(square(made - Var::constant(batch.future)));
              return {loss, {loss}};
            }).front();
    ++iteration_;
  }

  BaselineLosses losses() const override {
    require(!loss_.empty(), "no iteration has run yet");
    return {loss_.item()};
  }

 private:
  ActionSampler windows_;
  Adam adam_;
  Var loss_;
};

/// Trains the LSTM baseline: a whole run, see run_training().
inline RunResult train_baseline(ActionGan& model, const motion::ActionDataset& data,
                                const BaselineTrainOptions& options, const RunOptions& run = {}) {
  BaselineTrainer trainer(model, data, options);
  return run_training(
      trainer, [&](const std::filesystem::path& path) { data.write_split(path); }, run);
}

}  // namespace motiongan
