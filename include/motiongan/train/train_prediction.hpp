// Training the baselines of motion completion from start to end.
#pragma once
#include "motiongan/train/prediction_trainer.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan {

using PredictionRunOptions = BasicRunOptions<PredictionLosses>;

/// Trains until options.iterations are done, time is up or should_stop() says so; then saves. The log has the
/// mean square error.
inline RunResult train(PredictionModel& model, const PredictionData& data,
                       const PredictionTrainOptions& options, const PredictionRunOptions& run = {}) {
  PredictionTrainer trainer(model, data, options);
  return detail::run_training(trainer, data, options.iterations, run);
}

}  // namespace motiongan
