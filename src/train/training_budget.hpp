// Training many models for the same time or the same number of iterations, so that a comparison that is
// stopped goes on and trains nothing twice.
#pragma once
#include <optional>

#include "shared/options.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {

/// How long each model is trained.
struct TrainingBudget {
  double minutes = 0;             ///< 0: no limit
  std::size_t iterations = 0;     ///< 0: no limit
  double save_every_minutes = 5;  ///< of training
  std::size_t log_every = 10;
};

/// Adds --minutes, --iterations, --save-every and --log-every to a verb; `each` is "for each variant".
void add_budget_options(CLI::App& verb, TrainingBudget& budget, const std::string& each,
                        const std::string& group);

/// Takes --iterations alone for the whole budget. Error for a budget without any limit.
void settle_budget(const CLI::App& verb, TrainingBudget& budget);

/// "20 min", "300 iterations", "300 iterations or 20 min".
std::string described(const TrainingBudget& budget);

/// Whether the run in a folder was finished with this budget or a larger one.
bool has_had(const fs::path& folder, const TrainingBudget& budget);

/// Writes that it was.
void mark_finished(const fs::path& folder, const TrainingBudget& budget, std::size_t iterations_done);

/// Seconds that a run has been trained for, up to its checkpoint: its log counts from every start anew.
double seconds_trained(const RunFiles& files, std::size_t iterations);

/// The iterations that a training of such steps may have: those of the budget, or as many as there can be.
std::size_t iterations_of(const TrainingBudget& budget, std::size_t steps);

/// Trains the run in run.save_dir on until its budget is used up. Returns whether it got there, which it did
/// not if a signal stopped it.
bool train_within(Trainer& trainer, const std::function<void(const fs::path&)>& write_split, RunOptions run,
                  const TrainingBudget& budget, const std::string& name);

/// The same for a run that may diverge, as one without its penalty might: that is reported and does not cost
/// the others their turn; the run stays as it was last saved.
bool unless_diverged(const std::string& name, const std::function<bool()>& train);

}  // namespace motiongan::command
