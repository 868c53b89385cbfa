// Shared by the parts of `motiongan ablate attention`.
#pragma once
#include "ablate/seeds.hpp"
#include "motiongan/experiments/action_ablation.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "shared/command.hpp"
#include "shared/ranks.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {

/// What is trained, with which seeds, and for how long.
struct AblationTraining {
  ActionGanOptions model;
  AttentionTrainOptions training;
  TrainingBudget budget;
  std::vector<std::uint64_t> seeds;
  bool dry_run = false;
};

/// The options of both with a seed.
inline AblationTraining with_seed(AblationTraining training, std::uint64_t seed) {
  training.model.seed = training.training.seed = seed;
  return training;
}

/// Makes the notes that a run's checkpoint stores: its options.
using VariantNotes = std::function<RunNotes(const AblationVariant&, std::uint64_t seed)>;

/// A run of a variant. Earlier versions trained one seed, in save/NAME itself.
inline fs::path run_folder(const fs::path& save, const AblationVariant& variant, std::uint64_t seed,
                           std::uint64_t first_seed) {
  const fs::path earlier = save / variant.name;
  return seed == first_seed && fs::exists(RunFiles{earlier}.checkpoint())
             ? earlier
             : folder_of(save, variant.name, seed);
}

/// Throws Error unless all variants fit the machine; with --dry-run prints what each takes and returns true.
bool only_sized(const Context& context, const motion::ActionDataset& data,
                const std::vector<const AblationVariant*>& variants, const AblationTraining& training);

/// Trains the runs that have not used up their budget, one after the other, each in its run_folder(); one
/// that has used part of it continues. If one diverges, that is printed and it stays as it was last saved.
/// Ranks train different runs. Returns false if a signal stopped it.
bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes, SharedRuns& runs);

struct AblationReport {
  EvaluationOptions evaluation;
  double unit_metres = 0;          ///< metres per unit of the clips; 0: unknown
  bool all_must_be_there = false;  ///< of at least one seed
};

/// Measures the variants whose models are in `save`, prints the tables and writes angles.csv, runs.csv,
/// table.csv, angles.png, strip_10s.png and strip_30s.png there. The strips show the first seed.
void report_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                     const std::vector<const AblationVariant*>& variants,
                     const std::vector<std::uint64_t>& seeds, const AblationReport& options);

}  // namespace motiongan::command
