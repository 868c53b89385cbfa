// Training the models of the second paper from start to end.
#pragma once
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan {

using AttentionRunOptions = BasicRunOptions<AttentionLosses>;
using BaselineRunOptions = BasicRunOptions<BaselineLosses>;

/// Trains until options.iterations are done, time is up or should_stop() says so; then saves. The log's
/// columns are those of AttentionLosses.
inline RunResult train(ActionGan& model, const motion::ActionDataset& data,
                       const AttentionTrainOptions& options, const AttentionRunOptions& run = {}) {
  AttentionTrainer trainer(model, data, options);
  return detail::run_training(trainer, data, options.iterations, run);
}

/// The same for a model whose generator is the LSTM baseline; the log has its mean square error.
inline RunResult train(ActionGan& model, const motion::ActionDataset& data,
                       const BaselineTrainOptions& options, const BaselineRunOptions& run = {}) {
  BaselineTrainer trainer(model, data, options);
  return detail::run_training(trainer, data, options.iterations, run);
}

}  // namespace motiongan
