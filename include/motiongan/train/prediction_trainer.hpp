// Training the baselines of motion completion (SPEC 7.7).
#pragma once
#include <memory>

#include "motiongan/models/prediction_model.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/optim/sgd.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/prediction_windows.hpp"

namespace motiongan {

/// From `iteration` on, normal numbers of this standard deviation are added to the normalised poses that a
/// model of one step ahead sees.
struct NoiseStage {
  std::size_t iteration = 0;
  double deviation = 0;
};

/// Defaults are those of residual seq2seq, and for the noise the schedule of the published code of structural
/// RNNs (Jain et al. 2016), which trained ERD and LSTM-3LR beside its own.
struct PredictionTrainOptions {
  std::size_t iterations = 100'000;
  std::size_t batch = 16;
  std::size_t prefix = 50, future = 25;                                   ///< frames given and frames to make
  SgdOptions sgd{};                                                       ///< of seq2seq
  AdamOptions adam{.learning_rate = 1e-3, .beta1 = 0.9, .beta2 = 0.999};  ///< of the other three
  std::vector<NoiseStage> noise{{250, 0.01}, {500, 0.05}, {1000, 0.1}, {1300, 0.2},
                                {2000, 0.3}, {2500, 0.5}, {3300, 0.7}};  ///< of erd and lstm_3lr
  std::uint64_t seed = 1;
};

/// What a checkpoint keeps of them: all but `iterations`, which a resumed run may have more of.
inline nlohmann::json to_json(const PredictionTrainOptions& o) {
  nlohmann::json noise = nlohmann::json::array();
  for (const NoiseStage& stage : o.noise) noise.push_back({stage.iteration, stage.deviation});
  return {{"batch", o.batch},
          {"prefix", o.prefix},
          {"future", o.future},
          {"sgd_learning_rate", o.sgd.learning_rate},
          {"decay", o.sgd.decay},
          {"decay_every", o.sgd.decay_every},
          {"clip_norm", o.sgd.clip_norm},
          {"learning_rate", o.adam.learning_rate},
          {"beta1", o.adam.beta1},
          {"beta2", o.adam.beta2},
          {"epsilon", o.adam.epsilon},
          {"noise", noise},
          {"seed", o.seed}};
}

/// What the last iteration came to; reading it waits for the device.
struct PredictionLosses {
  double error = 0;  ///< mean square of what is wrong with the poses told, normalised
};

/// As they stand in the log.
inline std::vector<LossColumn> columns(const PredictionLosses& losses) { return {{"error", losses.error}}; }

class PredictionTrainer {
 public:
  PredictionTrainer(PredictionModel& model, const PredictionData& data, const PredictionTrainOptions& options)
      : model_(model),
        options_(checked(options)),
        windows_(model.context(), data, options.prefix + options.future),
        optimizer_(make_optimizer(model, options)) {
    require(data.dof == model.dof() && data.action_count == model.action_count(), "the data (", data.dof,
            " numbers a pose, ", data.action_count, " actions) do not fit the model (", model.dof(), ", ",
            model.action_count(), ")");
  }

  PredictionModel& model() { return model_; }
  const PredictionTrainOptions& options() const { return options_; }
  std::size_t iteration() const { return iteration_; }
  void set_iteration(std::size_t iteration) { iteration_ = iteration; }
  std::vector<TrainedPart> parts() { return {{"generator", named_parameters(model_), optimizer_.get()}}; }

  /// The deviation of the noise of an iteration.
  double noise_at(std::size_t iteration) const {
    double deviation = 0;
    for (const NoiseStage& stage : options_.noise)
      if (iteration >= stage.iteration) deviation = stage.deviation;
    return deviation;
  }

  /// One update.
  void iterate() {
    const auto step = static_cast<std::uint32_t>(iteration_);
    const PredictionBatch batch = windows_.draw(options_.seed, step, options_.batch);
    const Var loss = model_.one_step_ahead() ? one_step_loss(batch, step) : copy_loss(batch);
    optimizer_->step(grad(loss, optimizer_->parameters()));
    loss_ = loss.detach();
    ++iteration_;
  }

  PredictionLosses losses() const {
    require(!loss_.empty(), "no iteration has run yet");
    return {loss_.item()};
  }

 private:
  static PredictionTrainOptions checked(const PredictionTrainOptions& o) {
    require(o.batch > 0 && o.prefix > 0 && o.future > 0, "batch ", o.batch, ", prefix ", o.prefix,
            " and future ", o.future, " must be positive");
    require(o.iterations < (std::size_t{1} << 24), o.iterations,
            " iterations are more than the random numbers' counter holds (2^24 steps)");
    require(o.adam.learning_rate > 0, "the learning rate ", o.adam.learning_rate, " must be above 0");
    for (std::size_t i = 0; i < o.noise.size(); ++i)
      require(o.noise[i].deviation >= 0 && (i == 0 || o.noise[i - 1].iteration < o.noise[i].iteration),
              "noise stage ", i + 1, " (from iteration ", o.noise[i].iteration, " on, deviation ",
              o.noise[i].deviation, "): iterations must grow and deviations not be below 0");
    return o;
  }

  static std::unique_ptr<Optimizer> make_optimizer(PredictionModel& model, const PredictionTrainOptions& o) {
    if (model.options().predictor == Predictor::seq2seq)
      return std::make_unique<Sgd>(named_parameters(model), o.sgd);
    return std::make_unique<Adam>(named_parameters(model), o.adam);
  }

  Var frames_of(const PredictionBatch& batch, std::size_t first, std::size_t count) const {
    const std::size_t dof = model_.dof();
    return Var::constant(batch.windows.view(first * options_.batch * dof, {count, options_.batch, dof}));
  }

  /// The model goes on from the prefix by itself.
  Var copy_loss(const PredictionBatch& batch) const {
    const Var made =
        model_.make(frames_of(batch, 0, options_.prefix), Var::constant(batch.actions), options_.future);
    return mean(square(made - frames_of(batch, options_.prefix, options_.future)));
  }

  /// The model tells the pose after each one of the window, which it sees with noise.
  Var one_step_loss(const PredictionBatch& batch, std::uint32_t step) const {
    const std::size_t count = options_.prefix + options_.future - 1;
    Var seen = frames_of(batch, 0, count);
    if (const double deviation = noise_at(step); deviation > 0) {
      const RandomKey key{.seed = options_.seed, .stream = RandomStream::noise, .step = step};
      const Tensor noise = random_normal(model_.context(), key, count, options_.batch, model_.dof());
      seen = weighted_sum(seen, 1, Var::constant(noise), deviation);
    }
    return mean(square(model_.next_poses(seen) - frames_of(batch, 1, count)));
  }

  PredictionModel& model_;
  PredictionTrainOptions options_;
  PredictionSampler windows_;
  std::unique_ptr<Optimizer> optimizer_;
  Var loss_;
  std::size_t iteration_ = 0;
};

}  // namespace motiongan
