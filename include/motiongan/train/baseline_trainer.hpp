// Training the second paper's LSTM baseline (SPEC 5): it copies the second that follows a prior.
#pragma once
#include "motiongan/models/action_gan.hpp"
#include "motiongan/train/action_windows.hpp"
#include "motiongan/train/checkpoint.hpp"

namespace motiongan {

struct BaselineTrainOptions {
  std::size_t iterations = 20'000;
  std::size_t batch = 64;
  bool balanced = true;  ///< draw classes alike, however many clips they have
  AdamOptions adam{};
  std::uint64_t seed = 1;
};

/// What a checkpoint keeps of them: all but `iterations`, which a resumed run may have more of.
inline nlohmann::json to_json(const BaselineTrainOptions& o) {
  return {{"batch", o.batch},      {"balanced", o.balanced}, {"learning_rate", o.adam.learning_rate},
          {"beta1", o.adam.beta1}, {"beta2", o.adam.beta2},  {"epsilon", o.adam.epsilon},
          {"seed", o.seed}};
}

/// What the last iteration came to; reading it waits for the device.
struct BaselineLosses {
  double error = 0;  ///< mean square of what is wrong with the T frames made, normalised
};

/// As they stand in the log.
inline std::vector<LossColumn> columns(const BaselineLosses& losses) { return {{"error", losses.error}}; }

/// Trains an ActionGan whose generator is the LSTM.
class BaselineTrainer {
 public:
  BaselineTrainer(ActionGan& model, const motion::ActionDataset& data, const BaselineTrainOptions& options)
      : model_(model),
        options_(options),
        windows_(model.context(), data, data.train, options.balanced),
        adam_(named_parameters(model), options.adam) {
    model.baseline();  // refuses the attention model
    require(options.batch > 0, "batch must be positive");
    require(data.format.dof() == model.format().dof() && data.format.frames == model.format().frames &&
                data.format.classes == model.format().classes,
            "the data set (", data.format.dof(), " dof, ", data.format.frames, " frames, ",
            data.format.classes.size(), " classes) does not fit the model (", model.format().dof(), ", ",
            model.format().frames, ", ", model.format().classes.size(), ")");
    require(options.iterations < (std::size_t{1} << 24), options.iterations,
            " iterations are more than the random numbers' counter holds (2^24 steps)");
  }

  ActionGan& model() { return model_; }
  const BaselineTrainOptions& options() const { return options_; }
  std::size_t iteration() const { return iteration_; }
  void set_iteration(std::size_t iteration) { iteration_ = iteration; }
  std::vector<TrainedPart> parts() { return {{"generator", named_parameters(model_), &adam_}}; }

  /// One update.
  void iterate() {
    const ActionBatch batch =
        windows_.draw(options_.seed, static_cast<std::uint32_t>(iteration_), options_.batch);
    const Var made = model_.make(Var::constant(batch.prior), Var::constant(batch.classes));
    const Var loss = mean(square(made - Var::constant(batch.future)));
    adam_.step(grad(loss, adam_.parameters()));
    loss_ = loss.detach();
    ++iteration_;
  }

  BaselineLosses losses() const {
    require(!loss_.empty(), "no iteration has run yet");
    return {loss_.item()};
  }

 private:
  ActionGan& model_;
  BaselineTrainOptions options_;
  ActionSampler windows_;
  Adam adam_;
  Var loss_;
  std::size_t iteration_ = 0;
};

}  // namespace motiongan
