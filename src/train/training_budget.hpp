// Trains several models with the same budget of time or iterations. A comparison that was stopped continues
// and trains nothing twice.
#pragma once
#include <optional>

#include "motiongan/train/run.hpp"
#include "shared/options.hpp"

namespace motiongan::command {

/// How long each model is trained.
struct TrainingBudget {
  double minutes = 0;             ///< 0: no limit
  std::size_t iterations = 0;     ///< 0: no limit
  double save_every_minutes = 5;  ///< minutes of training between two checkpoints
  std::size_t log_every = 10;
};

/// Adds --minutes, --iterations, --save-every and --log-every to a verb; `each` completes their help, e.g.
/// "for each variant".
void add_budget_options(CLI::App& verb, TrainingBudget& budget, const std::string& each,
                        const std::string& group);

/// If --iterations is given without --minutes, it is the whole budget. Throws Error if there is no limit.
void settle_budget(const CLI::App& verb, TrainingBudget& budget);

/// "20 min", "300 iterations", "300 iterations or 20 min".
std::string described(const TrainingBudget& budget);

/// Whether the run in a folder was finished with this budget or a larger one.
bool has_had(const fs::path& folder, const TrainingBudget& budget);

/// Records that it was.
void mark_finished(const fs::path& folder, const TrainingBudget& budget, std::size_t iterations_done);

/// Seconds of training up to iteration `iterations`, summed over all starts of the run: the log restarts its
/// seconds at each.
double seconds_trained(const RunFiles& files, std::size_t iterations);

/// The iterations of the budget, or else the largest number possible with `steps` steps each.
std::size_t iterations_of(const TrainingBudget& budget, std::size_t steps);

/// Trains or continues the run in run.save_dir until its budget is used up. Returns false if a signal stopped
/// it first.
bool train_within(Trainer& trainer, const std::function<void(const fs::path&)>& write_split, RunOptions run,
                  const TrainingBudget& budget, const std::string& name);

/// Calls `train` and returns its result. If training diverges, as it may without the gradient penalty, prints
/// that and returns true, so that the other runs still get their turn; the run stays as it was last saved.
bool unless_diverged(const std::string& name, const std::function<bool()>& train);

}  // namespace motiongan::command
