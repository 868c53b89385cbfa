// Training of the motion-completion baselines.
#pragma once
#include <memory>

#include "motiongan/models/prediction_model.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/optim/sgd.hpp"
#include "motiongan/train/prediction_windows.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan {

/// Options of PredictionTrainer. The defaults are those of residual seq2seq (Martinez, Black & Romero 2017);
/// the noise schedule is that of the published code of structural RNNs (Jain et al. 2016), which also trains
/// ERD and LSTM-3LR.
struct PredictionTrainOptions {
  std::size_t iterations = 100'000;                                       ///< steps
  std::size_t batch = 16;                                                 ///< windows in a step
  std::size_t prefix = 50, future = 25;                                   ///< frames given, frames to predict
  SgdOptions sgd{};                                                       ///< used for seq2seq
  AdamOptions adam{.learning_rate = 1e-3, .beta1 = 0.9, .beta2 = 0.999};  ///< used for the other three
  /// For erd and lstm_3lr: standard deviation of the Gaussian noise added to the normalised input poses, each
  /// value from its iteration on.
  std::vector<ScheduleStage> noise{{250, 0.01}, {500, 0.05}, {1000, 0.1}, {1300, 0.2},
                                   {2000, 0.3}, {2500, 0.5}, {3300, 0.7}};
  std::uint64_t seed = 1;

  /// Update steps in an iteration.
  std::size_t steps() const { return 1; }

  void list_fields(FieldList& list) {
    list.add(iterations,
             {.key = "iterations", .help = "how long to train", .range = Range::at_least(1), .saved = false});
    list.add(batch, {.key = "batch", .help = "windows in a step", .range = Range::at_least(1)});
    list.add(prefix, {.key = "prefix", .help = "frames given", .range = Range::at_least(1)});
    list.add(future, {.key = "future", .help = "frames to predict", .range = Range::at_least(1)});
    sgd.list_fields(list);
    adam.list_fields(list);
    list.add(noise, {.key = "noise", .help = "schedule of the noise on the poses that erd and lstm_3lr see"});
    list.add(seed, {.key = "seed", .help = "of the initial weights, batches and noise"});
  }
};

/// Losses of the last iteration.
struct PredictionLosses {
  double error = 0;  ///< MSE of the predicted poses, normalised

  /// The columns of the log.
  std::vector<NamedLoss> named() const { return {{"error", error}}; }
};

/// Trains a PredictionModel: seq2seq with SGD, the others with Adam.
class PredictionTrainer : public ModelTrainer<PredictionModel, PredictionTrainOptions, PredictionLosses> {
 public:
  /// Throws Error if data or options do not fit, or if no sequence has prefix + future frames.
  PredictionTrainer(PredictionModel& model, const PredictionData& data, const PredictionTrainOptions& options)
      : ModelTrainer(model, options),
        windows_(model.context(), data, options.prefix + options.future),
        optimizer_(make_optimizer(model, options)) {
    require(data.dof == model.dof() && data.action_count == model.action_count(), "the data (", data.dof,
            " dof, ", data.action_count, " actions) do not fit the model (", model.dof(), " dof, ",
            model.action_count(), " actions)");
    const std::vector<ScheduleStage>& noise = options.noise;
    for (std::size_t i = 0; i < noise.size(); ++i)
      require(noise[i].value >= 0 && (i == 0 || noise[i - 1].iteration < noise[i].iteration), "noise stage ",
              i + 1, " (from iteration ", noise[i].iteration, " on, deviation ", noise[i].value,
              "): iterations must increase and deviations be at least 0");
  }

  std::vector<TrainedPart> parts() override {
    return {{"generator", named_parameters(model_), optimizer_.get()}};
  }

  /// The standard deviation of the input noise at an iteration.
  double noise_at(std::size_t iteration) const {
    double deviation = 0;
    for (const ScheduleStage& stage : options_.noise)
      if (iteration >= stage.iteration) deviation = stage.value;
    return deviation;
  }

  /// One update.
  void iterate() override {
    follow_schedule(options_.adam.schedule);
    const KeepPacked weights_packed;
    const auto step = static_cast<std::uint32_t>(iteration_);
    loss_ = parallel_step(*optimizer_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
              const PredictionBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
              const Var loss = model_.one_step_ahead() ? one_step_loss(batch, step, part) : copy_loss(batch);
              return {loss, {loss}};
            }).front();
    ++iteration_;
  }

  PredictionLosses losses() const override {
    require(!loss_.empty(), "no iteration has run yet");
    return {loss_.item()};
  }

 private:
  static std::unique_ptr<Optimizer> make_optimizer(PredictionModel& model, const PredictionTrainOptions& o) {
    if (model.options().predictor == Predictor::seq2seq)
      return std::make_unique<Sgd>(named_parameters(model), o.sgd);
    return std::make_unique<Adam>(named_parameters(model), o.adam);
  }

  Var frames_of(const PredictionBatch& batch, std::size_t first, std::size_t count) const {
    const std::size_t dof = model_.dof(), size = batch.windows.dim(1);
    return Var::constant(batch.windows.view(first * size * dof, {count, size, dof}));
  }

  /// MSE of the future that the model predicts from the prefix, fed with its own output.
  Var copy_loss(const PredictionBatch& batch) const {
    const Var made =
        model_.forward(frames_of(batch, 0, options_.prefix), Var::constant(batch.actions), options_.future);
    return mean(square(made - frames_of(batch, options_.prefix, options_.future)));
  }

  /// MSE of the next pose predicted at each frame of the window (teacher forcing), with noise on the input.
  Var one_step_loss(const PredictionBatch& batch, std::uint32_t step, const BatchPart& part) const {
    const std::size_t count = options_.prefix + options_.future - 1;
    Var seen = frames_of(batch, 0, count);
    if (const double deviation = noise_at(step); deviation > 0) {
      const RandomKey key{.seed = options_.seed,
                          .stream = RandomStream::noise,
                          .step = step,
                          .first_sample = static_cast<std::uint32_t>(part.first)};
      const Tensor noise = random_normal(model_.context(), key, count, part.count, model_.dof());
      seen = weighted_sum(seen, 1, Var::constant(noise), deviation);
    }
    return mean(square(model_.next_poses(seen) - frames_of(batch, 1, count)));
  }

  PredictionSampler windows_;
  std::unique_ptr<Optimizer> optimizer_;
  Var loss_;
};

/// Trains a motion-completion baseline: a whole run, see run_training().
inline RunResult train(PredictionModel& model, const PredictionData& data,
                       const PredictionTrainOptions& options, const RunOptions& run = {}) {
  PredictionTrainer trainer(model, data, options);
  return run_training(
      trainer, [&](const std::filesystem::path& path) { data.write_split(path); }, run);
}

}  // namespace motiongan
