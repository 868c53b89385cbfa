// Training many models for the same time or the same number of iterations, so that a comparison that is
// stopped goes on and trains nothing twice.
#pragma once
#include <optional>

#include "command.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/train/run.hpp"
#include "signals.hpp"

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

namespace budget_detail {
template <class Losses>
std::vector<NamedValue> shown(const Losses& losses) {
  std::vector<NamedValue> out;
  for (const LossColumn& column : columns(losses)) out.emplace_back(column.first, column.second);
  return out;
}
}  // namespace budget_detail

/// Trains the run in run.save_dir on until its budget is used up; whether it got there, which it did not if a
/// signal stopped it.
template <class Losses, class Model, class Data, class Options>
bool train_within(Model& model, const Data& data, const Options& options, BasicRunOptions<Losses> run,
                  const TrainingBudget& budget, std::string_view name) {
  const RunFiles files{run.save_dir};
  std::size_t done = 0;
  double minutes = 0;
  run.resume = fs::exists(files.checkpoint());
  if (run.resume) {
    done = read_run_record(files.checkpoint()).iteration;
    minutes = seconds_trained(files, done) / 60;
  }
  fmt::print("{}: training for {}{}\n", name, described(budget),
             run.resume
                 ? fmt::format("; {} after {} are done", counted(done, "iteration"), duration(60 * minutes))
                 : "");
  const bool time_is_left = budget.minutes == 0 || minutes < budget.minutes;
  if (time_is_left && done < options.iterations) {
    ProgressBar bar(0, {.label = std::string(name)});
    bar.start(budget.iterations, done);
    if (budget.minutes > 0) run.max_minutes = budget.minutes - minutes;
    run.save_every_minutes = budget.save_every_minutes;
    run.log_every = budget.log_every;
    run.should_stop = [] { return caught_signal() != 0; };
    run.report = [&](std::size_t iteration, const Losses& losses) {
      bar.update(iteration, budget_detail::shown(losses));
    };
    done = train(model, data, options, run).iterations;
    bar.finish();
    if (caught_signal() != 0) {
      fmt::print("{}: stopped after {}; the same command goes on\n", name, counted(done, "iteration"));
      return false;
    }
  }
  mark_finished(run.save_dir, budget, done);
  fmt::print("{}: finished after {}\n", name, counted(done, "iteration"));
  return true;
}

/// The same, but a run that diverges, as one without its penalty might, is told and does not cost the others
/// their turn: it stays as it was last saved.
template <class Train>
bool unless_diverged(std::string_view name, const Train& train) {
  try {
    return train();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find("training diverged") == std::string_view::npos) throw;
    fmt::print(stderr, "motiongan: {}: {}\n", name, error.what());
    return true;
  }
}

}  // namespace motiongan::command
