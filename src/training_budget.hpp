// How long each of several models is trained, and which of them have had it: what keeps a second call from
// training anything twice.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>

#include "command.hpp"
#include "motiongan/motion/text_file.hpp"
#include "motiongan/train/csv_log.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {

/// Of one model, in all its runs; 0: no limit.
struct TrainingBudget {
  double minutes = 0;
  std::size_t iterations = 0;

  /// Whether it allows no more than another.
  bool within(const TrainingBudget& other) const {
    const auto less = [](double wanted, double had) { return had == 0 || (wanted > 0 && wanted <= had); };
    return less(minutes, other.minutes) &&
           less(static_cast<double>(iterations), static_cast<double>(other.iterations));
  }

  /// "500 iterations or 20 min".
  std::string text() const {
    if (iterations == 0) return duration(60 * minutes);
    return counted(iterations, "iteration") + (minutes > 0 ? " or " + duration(60 * minutes) : "");
  }
};

inline fs::path budget_mark(const fs::path& folder) { return folder / "finished.json"; }

/// The budget that a model had when it was finished; nothing where it was not.
inline std::optional<TrainingBudget> finished_budget(const fs::path& folder) {
  const fs::path path = budget_mark(folder);
  if (!fs::exists(path)) return std::nullopt;
  const auto mark = nlohmann::json::parse(motion::read_text(path, "mark"), nullptr, false);
  try {
    return TrainingBudget{mark.at("minutes").get<double>(), mark.at("iterations").get<std::size_t>()};
  } catch (const nlohmann::json::exception& error) {
    throw Error(path.string(), " cannot be read: ", error.what(), "; remove it to train the model on");
  }
}

/// Seconds that a run has been trained for, up to its checkpoint: its log counts from every start anew.
inline double seconds_trained(const RunFiles& files, std::size_t iterations) {
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

/// Writes down that the model in the folder has had its budget.
inline void mark_finished(const fs::path& folder, const TrainingBudget& budget, std::size_t iterations) {
  const nlohmann::json mark{{"minutes", budget.minutes},
                            {"iterations", budget.iterations},
                            {"iterations_done", iterations},
                            {"seconds", seconds_trained(RunFiles{folder}, iterations)}};
  motion::write_text_atomically(budget_mark(folder), mark.dump() + "\n");
}

}  // namespace motiongan::command
