// What the parts of `motiongan ablate attention` share.
#pragma once
#include "shared/command.hpp"
#include "motiongan/experiments/action_ablation.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {

/// What is trained, and for how long each.
struct AblationTraining {
  ActionGanOptions model;
  AttentionTrainOptions training;
  TrainingBudget budget;
};

/// The note of a variant's options that its checkpoint keeps.
using VariantNotes = std::function<RunNotes(const AblationVariant&)>;

/// Trains the variants that are not done yet, one after the other, each in a folder of its name in `save`.
/// One that has had a part of its budget goes on. One that diverges is told and left as it was last saved.
/// Returns whether all are done: not if a signal stopped it.
bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes);

struct AblationReport {
  EvaluationOptions evaluation;
  double unit_metres = 0;  ///< size of the file's unit; 0: not known
  bool all_must_be_there = false;
};

/// Measures the variants whose models are in `save`, prints the tables and writes angles.csv, table.csv,
/// angles.png, strip_10s.png and strip_30s.png there.
void report_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                     const std::vector<const AblationVariant*>& variants, const AblationReport& options);

}  // namespace motiongan::command
