// Shared by the parts of `motiongan ablate attention`.
#pragma once
#include "motiongan/experiments/action_ablation.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "shared/command.hpp"
#include "shared/ranks.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {

/// What is trained, and for how long.
struct AblationTraining {
  ActionGanOptions model;
  AttentionTrainOptions training;
  TrainingBudget budget;
  bool dry_run = false;
};

/// Makes the notes that a variant's checkpoint stores: its options.
using VariantNotes = std::function<RunNotes(const AblationVariant&)>;

/// Throws Error unless all variants fit the machine; with --dry-run prints what each takes and returns true.
bool only_sized(const Context& context, const motion::ActionDataset& data,
                const std::vector<const AblationVariant*>& variants, const AblationTraining& training);

/// Trains the variants that have not used up their budget, one after the other, each in save/NAME; one that
/// has used part of it continues. If one diverges, that is printed and it stays as it was last saved. Ranks
/// train different variants. Returns false if a signal stopped it.
bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes, SharedRuns& runs);

struct AblationReport {
  EvaluationOptions evaluation;
  double unit_metres = 0;  ///< metres per unit of the clips; 0: unknown
  bool all_must_be_there = false;
};

/// Measures the variants whose models are in `save`, prints the tables and writes angles.csv, table.csv,
/// angles.png, strip_10s.png and strip_30s.png there.
void report_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                     const std::vector<const AblationVariant*>& variants, const AblationReport& options);

}  // namespace motiongan::command
