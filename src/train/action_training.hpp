// Building the action models and their trainers, for `train attention` and `ablate attention`.
#pragma once
#include "motiongan/experiments/action_ablation.hpp"
#include "train/training_size.hpp"

namespace motiongan::command {

/// As only_sized(), for either model.
inline bool only_sized(const Context& context, const motion::ActionDataset& data,
                       const ActionGanOptions& options, const AttentionTrainOptions& training, bool dry_run,
                       std::size_t iterations) {
  const std::string lower = size_options(training.batch, options.hidden);
  if (options.generator == ActionGenerator::lstm)
    return only_sized(context, AblationVariant::baseline_training(training), lower, dry_run, iterations,
                      [&](const Context& in, const BaselineTrainOptions& trial, const TrainerUse& use) {
                        ActionGan model(in, data.format, options);
                        BaselineTrainer trainer(model, data, trial);
                        use(trainer);
                      });
  return only_sized(context, training, lower, dry_run, iterations,
                    [&](const Context& in, const AttentionTrainOptions& trial, const TrainerUse& use) {
                      ActionGan model(in, data.format, options);
                      AttentionTrainer trainer(model, data, trial);
                      use(trainer);
                    });
}

}  // namespace motiongan::command
