// motiongan ablate: training the variants, each with the same budget.
#include <nlohmann/json.hpp>

#include "ablate.hpp"
#include "motiongan/motion/text_file.hpp"
#include "motiongan/train/progress.hpp"
#include "signals.hpp"

namespace motiongan::command {
namespace {

fs::path mark_of(const fs::path& folder) { return folder / "finished.json"; }

/// What a variant had when it was finished; nothing where it was not.
std::optional<AblationBudget> finished(const fs::path& folder) {
  if (!fs::exists(mark_of(folder))) return std::nullopt;
  const auto mark = nlohmann::json::parse(motion::read_text(mark_of(folder), "mark"), nullptr, false);
  try {
    return AblationBudget{mark.at("minutes").get<double>(), mark.at("iterations").get<std::size_t>()};
  } catch (const nlohmann::json::exception& error) {
    throw Error(mark_of(folder).string(), " cannot be read: ", error.what(),
                "; remove it to train the variant on");
  }
}

/// Whether one limit allows no more than another; 0 is none.
bool within(double wanted, double had) { return had == 0 || (wanted > 0 && wanted <= had); }

/// Seconds that a run has been trained for, up to its checkpoint: its log counts from every start anew.
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

/// As many as the random numbers' counter holds.
std::size_t most_iterations(const AttentionTrainOptions& o) {
  return (std::size_t{1} << 24) / (o.critic_steps + 1 + o.generator_steps) - 2;
}

template <class Losses>
std::vector<NamedValue> shown(const Losses& losses) {
  std::vector<NamedValue> out;
  for (const LossColumn& column : columns(losses)) out.emplace_back(column.first, column.second);
  return out;
}

/// Trains on; whether it got to its end.
template <class Losses, class Options>
bool train_one(AttentionGan& model, const motion::ActionDataset& data, const Options& options,
               BasicRunOptions<Losses> run, const AblationTraining& all, std::string_view name) {
  const RunFiles files{run.save_dir};
  std::size_t done = 0;
  double minutes = 0;
  run.resume = fs::exists(files.checkpoint());
  if (run.resume) {
    done = read_run_record(files.checkpoint()).iteration;
    minutes = seconds_trained(files, done) / 60;
  }
  const std::string budget =
      all.budget.iterations > 0
          ? counted(all.budget.iterations, "iteration") +
                (all.budget.minutes > 0 ? " or " + duration(60 * all.budget.minutes) : "")
          : duration(60 * all.budget.minutes);
  fmt::print("{}: training for {}{}\n", name, budget,
             run.resume
                 ? fmt::format("; {} after {} are done", counted(done, "iteration"), duration(60 * minutes))
                 : "");
  const bool time_is_left = all.budget.minutes == 0 || minutes < all.budget.minutes;
  if (time_is_left && done < options.iterations) {
    ProgressBar bar(0, {.label = std::string(name)});
    bar.start(all.budget.iterations, done);
    if (all.budget.minutes > 0) run.max_minutes = all.budget.minutes - minutes;
    run.save_every_minutes = all.save_every_minutes;
    run.log_every = all.log_every;
    run.should_stop = [] { return caught_signal() != 0; };
    run.report = [&](std::size_t iteration, const Losses& losses) { bar.update(iteration, shown(losses)); };
    done = train(model, data, options, run).iterations;
    bar.finish();
    if (caught_signal() != 0) {
      fmt::print("{}: stopped after {}; the same command goes on\n", name, counted(done, "iteration"));
      return false;
    }
  }
  const nlohmann::json mark{{"minutes", all.budget.minutes},
                            {"iterations", all.budget.iterations},
                            {"iterations_done", done},
                            {"seconds", seconds_trained(files, done)}};
  motion::write_text_atomically(mark_of(run.save_dir), mark.dump() + "\n");
  fmt::print("{}: finished after {}\n", name, counted(done, "iteration"));
  return true;
}

}  // namespace

bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes) {
  require(training.budget.minutes > 0 || training.budget.iterations > 0,
          "nothing says how long to train; give --minutes or --iterations");
  catch_signals();
  for (const AblationVariant* variant : variants) {
    const fs::path folder = save / variant->name;
    if (const auto had = finished(folder);
        had && within(training.budget.minutes, had->minutes) &&
        within(static_cast<double>(training.budget.iterations), static_cast<double>(had->iterations))) {
      fmt::print("{}: is trained already\n", variant->name);
      continue;
    }
    make_folder(folder);
    AttentionGan model(context, data.format, variant->model(training.model));
    AttentionTrainOptions options = variant->training(training.training);
    options.iterations =
        training.budget.iterations > 0 ? training.budget.iterations : most_iterations(training.training);
    bool ended = false;
    try {
      if (variant->lstm)
        ended = train_one(model, data, AblationVariant::baseline_training(options),
                          BaselineRunOptions{.save_dir = folder, .notes = notes(*variant)}, training,
                          variant->name);
      else
        ended =
            train_one(model, data, options, AttentionRunOptions{.save_dir = folder, .notes = notes(*variant)},
                      training, variant->name);
    } catch (const Error& error) {
      // One variant that diverges, as one without its penalty might, does not cost the others their turn.
      if (std::string_view(error.what()).find("training diverged") == std::string_view::npos) throw;
      fmt::print(stderr, "motiongan: {}: {}\n", variant->name, error.what());
      continue;
    }
    if (!ended) return false;
  }
  return true;
}

}  // namespace motiongan::command
