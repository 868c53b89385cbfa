#include "train/training_budget.hpp"

#include <nlohmann/json.hpp>

#include "motiongan/formats/text_file.hpp"
#include "motiongan/io/fields_json.hpp"
#include "motiongan/train/progress.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

fs::path mark_of(const fs::path& folder) { return folder / "finished.json"; }

/// Whether the limit `wanted` is at most `had`; 0: no limit.
bool within(double wanted, double had) { return had == 0 || (wanted > 0 && wanted <= had); }

}  // namespace

void add_budget_options(CLI::App& verb, TrainingBudget& budget, const std::string& each,
                        const std::string& group) {
  const auto option = [&](const char* name, auto& member, const std::string& text) {
    return verb.add_option(name, member, text)->capture_default_str()->group(group);
  };
  option("--minutes", budget.minutes, "training time " + each + "; 0: no limit")->check(not_negative());
  option("--iterations", budget.iterations,
         "training iterations " + each + "; 0: no limit. Given alone, they replace --minutes")
      ->check(not_negative());
  option("--save-every", budget.save_every_minutes, "minutes between two checkpoints; 0: only at the end")
      ->check(not_negative());
  option("--log-every", budget.log_every, "iterations between two rows of log.csv")->check(positive());
}

void settle_budget(const CLI::App& verb, TrainingBudget& budget) {
  if (verb.count("--iterations") > 0 && verb.count("--minutes") == 0) budget.minutes = 0;
  require(budget.minutes > 0 || budget.iterations > 0,
          "there is no limit on the training; give --minutes or --iterations");
}

std::string described(const TrainingBudget& budget) {
  if (budget.iterations == 0) return duration(60 * budget.minutes);
  return counted(budget.iterations, "iteration") +
         (budget.minutes > 0 ? " or " + duration(60 * budget.minutes) : "");
}

bool has_had(const fs::path& folder, const TrainingBudget& budget) {
  if (!fs::exists(mark_of(folder))) return false;
  const auto mark = io::parse_json(motion::read_text(mark_of(folder), "record of a finished run"));
  try {
    return within(budget.minutes, mark.at("minutes").get<double>()) &&
           within(static_cast<double>(budget.iterations),
                  static_cast<double>(mark.at("iterations").get<std::size_t>()));
  } catch (const nlohmann::json::exception& error) {
    throw Error(mark_of(folder).string(), " cannot be read: ", error.what(),
                "; remove it to continue the training");
  }
}

void mark_finished(const fs::path& folder, const TrainingBudget& budget, std::size_t iterations_done) {
  const nlohmann::json mark{{"minutes", budget.minutes},
                            {"iterations", budget.iterations},
                            {"iterations_done", iterations_done},
                            {"seconds", seconds_trained(RunFiles{folder}, iterations_done)}};
  motion::write_text_atomically(mark_of(folder), mark.dump() + "\n");
}

double seconds_trained(const RunFiles& files, std::size_t iterations) {
  if (!fs::exists(files.log())) return 0;
  const CsvTable log = read_csv_log(files.log());
  const std::vector<double> rows = log.column("iteration"), seconds = log.column("seconds");
  double sum = 0, last = 0;
  for (std::size_t i = 0; i < rows.size() && rows[i] <= static_cast<double>(iterations); ++i) {
    if (seconds[i] < last) sum += last;
    last = seconds[i];
  }
  return sum + last;
}

std::size_t iterations_of(const TrainingBudget& budget, std::size_t steps) {
  return budget.iterations > 0 ? budget.iterations : max_iterations(steps);
}

bool train_within(Trainer& trainer, const std::function<void(const fs::path&)>& write_split, RunOptions run,
                  const TrainingBudget& budget, const std::string& name) {
  const RunFiles files{run.save_dir};
  make_folder(run.save_dir);
  run.lock = std::make_shared<const io::FolderLock>(run.save_dir);
  std::size_t done = 0;
  double minutes = 0;
  run.resume = fs::exists(files.checkpoint());
  if (run.resume) {
    done = read_run_record(files.checkpoint()).iteration;
    minutes = seconds_trained(files, done) / 60;
  }
  fmt::print("{}: training for {}{}\n", name, described(budget),
             run.resume
                 ? fmt::format("; {} ({}) already done", counted(done, "iteration"), duration(60 * minutes))
                 : "");
  const bool time_is_left = budget.minutes == 0 || minutes < budget.minutes;
  if (time_is_left && done < trainer.iterations()) {
    ProgressBar bar(0, {.label = name});
    bar.start(budget.iterations, done);
    if (budget.minutes > 0) run.max_minutes = budget.minutes - minutes;
    run.save_every_minutes = budget.save_every_minutes;
    run.log_every = budget.log_every;
    run.interrupted = [] { return stop_requested(); };
    run.warn = [&](const std::string& text) { bar.note("warning: " + text); };
    run.report = [&](std::size_t iteration, std::span<const NamedLoss> losses) {
      std::vector<NamedValue> values;
      for (const NamedLoss& loss : losses) values.emplace_back(loss.name, loss.value);
      bar.update(iteration, values);
    };
    done = run_training(trainer, write_split, run).iterations;
    bar.finish();
    if (caught_signal() != 0) {
      fmt::print("{}: stopped after {}; the same command continues\n", name, counted(done, "iteration"));
      return false;
    }
  }
  mark_finished(run.save_dir, budget, done);
  fmt::print("{}: finished after {}\n", name, counted(done, "iteration"));
  return true;
}

bool unless_diverged(const std::string& name, const std::function<bool()>& train) {
  try {
    return train();
  } catch (const DivergedError& error) {
    fmt::print(stderr, "motiongan: {}: {}\n", name, error.what());
    return true;
  }
}

}  // namespace motiongan::command
