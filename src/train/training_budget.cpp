#include "train/training_budget.hpp"

#include <nlohmann/json.hpp>

#include "motiongan/formats/text_file.hpp"

namespace motiongan::command {
namespace {

fs::path mark_of(const fs::path& folder) { return folder / "finished.json"; }

/// Whether one limit allows no more than another; 0 is none.
bool within(double wanted, double had) { return had == 0 || (wanted > 0 && wanted <= had); }

}  // namespace

void add_budget_options(CLI::App& verb, TrainingBudget& budget, const std::string& each,
                        const std::string& group) {
  const auto option = [&](const char* name, auto& member, const std::string& text) {
    return verb.add_option(name, member, text)->capture_default_str()->group(group);
  };
  option("--minutes", budget.minutes, each + "; 0: no limit")->check(not_negative());
  option("--iterations", budget.iterations, each + "; 0: no limit. Alone, it takes the place of --minutes")
      ->check(not_negative());
  option("--save-every", budget.save_every_minutes, "minutes between two checkpoints; 0: only at the end")
      ->check(not_negative());
  option("--log-every", budget.log_every, "iterations between two rows of log.csv")->check(positive());
}

void settle_budget(const CLI::App& verb, TrainingBudget& budget) {
  if (verb.count("--iterations") > 0 && verb.count("--minutes") == 0) budget.minutes = 0;
  require(budget.minutes > 0 || budget.iterations > 0,
          "nothing says how long to train; give --minutes or --iterations");
}

std::string described(const TrainingBudget& budget) {
  if (budget.iterations == 0) return duration(60 * budget.minutes);
  return counted(budget.iterations, "iteration") +
         (budget.minutes > 0 ? " or " + duration(60 * budget.minutes) : "");
}

bool has_had(const fs::path& folder, const TrainingBudget& budget) {
  if (!fs::exists(mark_of(folder))) return false;
  const auto mark = nlohmann::json::parse(motion::read_text(mark_of(folder), "mark"), nullptr, false);
  try {
    return within(budget.minutes, mark.at("minutes").get<double>()) &&
           within(static_cast<double>(budget.iterations),
                  static_cast<double>(mark.at("iterations").get<std::size_t>()));
  } catch (const nlohmann::json::exception& error) {
    throw Error(mark_of(folder).string(), " cannot be read: ", error.what(),
                "; remove it to train the model on");
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

}  // namespace motiongan::command
