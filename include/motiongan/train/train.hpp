// Training a DVGAN from start to end.
#pragma once
#include "motiongan/train/dvgan_trainer.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan {

using RunOptions = BasicRunOptions<DvganLosses>;

/// Trains until options.iterations are done, time is up or should_stop() says so; then saves.
/// Columns of the log: iteration, seconds (of this run), iterations_per_second, wasserstein, penalty,
/// generator_loss.
inline RunResult train(Dvgan& model, const motion::Dataset& data, const DvganTrainOptions& options,
                       const RunOptions& run = {}) {
  DvganTrainer trainer(model, data, options);
  return detail::run_training(trainer, data, options.iterations, run);
}

}  // namespace motiongan
