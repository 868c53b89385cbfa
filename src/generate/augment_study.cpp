// motiongan augment --study: whether synthetic clips help a classifier.
#include "generate/augment.hpp"
#include "motiongan/experiments/augmentation_study.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/train/progress.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

/// Mean and spread over the seeds of one number of the rows, in percent.
template <class Get>
std::string mean_text(const std::vector<AugmentationStudyRow>& rows, const Get& get) {
  std::vector<double> values;
  for (const AugmentationStudyRow& row : rows) values.push_back(100 * get(row));
  const MeanStd of = mean_spread(values);
  return fmt::format("{:.1f} +- {:.1f}", of.mean, of.spread);
}

void print_rows(const std::vector<AugmentationStudyRow>& rows) {
  using Row = AugmentationStudyRow;
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100 * share); };
  std::vector<std::vector<std::string>> table;
  for (const Row& row : rows)
    table.push_back({std::to_string(row.seed), percent(row.real.windows), percent(row.augmented.windows),
                     percent(row.real.clips), percent(row.augmented.clips)});
  table.push_back({"mean +- spread", mean_text(rows, [](const Row& r) { return r.real.windows; }),
                   mean_text(rows, [](const Row& r) { return r.augmented.windows; }),
                   mean_text(rows, [](const Row& r) { return r.real.clips; }),
                   mean_text(rows, [](const Row& r) { return r.augmented.clips; })});
  table.push_back({"gain", "",
                   mean_text(rows, [](const Row& r) { return r.augmented.windows - r.real.windows; }), "",
                   mean_text(rows, [](const Row& r) { return r.augmented.clips - r.real.clips; })});
  print_table({"seed", "seconds: real", "real + synthetic", "clips: real", "real + synthetic"}, table,
              "lrrrr", "  ");
}

std::string as_csv(const std::vector<AugmentationStudyRow>& rows) {
  std::string out = "seed,windows_real,windows_augmented,clips_real,clips_augmented\n";
  for (const AugmentationStudyRow& r : rows)
    out += fmt::format("{},{},{},{},{}\n", r.seed, r.real.windows, r.augmented.windows, r.real.clips,
                       r.augmented.clips);
  return out;
}

}  // namespace

void add_study_options(CLI::App& verb, StudyArgs& a) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group("Study");
  };
  option("--seeds", a.seeds, "number of times both classifiers are trained")->check(positive());
  option("--iterations", a.iterations, "steps of each classifier")->check(positive());
  option("--minutes", a.minutes, "time limit for each classifier; 0: none")->check(not_negative());
  option("--batch", a.batch, "windows per step")->check(positive());
  option("--hidden", a.hidden, "width of the classifier")->check(positive());
  option("--learning-rate", a.learning_rate, "learning rate of Adam")->check(positive());
  option("--csv", a.csv, "table to write")->type_name("FILE");
}

int run_study(const StudyArgs& args, const ActionGan& model, const motion::ActionDataset& data,
              const std::vector<SyntheticClip>& synthetic) {
  require(!data.test.empty(), "the study needs test clips, but none are held out for testing");
  AugmentationStudyOptions options{.seeds = args.seeds,
                                   .iterations = args.iterations,
                                   .max_minutes = args.minutes,
                                   .batch = args.batch,
                                   .hidden = args.hidden};
  options.adam.learning_rate = args.learning_rate;
  fmt::print("study: {} x 2 classifiers of {} steps; accuracy on {} held out\n", args.seeds, args.iterations,
             counted(data.test.size(), "clip"));
  const std::size_t total = 2 * args.seeds * args.iterations;
  ProgressBar bar(total, {.label = "step"});
  bar.start(total);
  options.report = [&](std::size_t step, double loss) { bar.update(step, {{"loss", loss}}); };
  options.should_stop = [] { return stop_requested(); };
  catch_signals();
  const std::vector<AugmentationStudyRow> rows =
      study_augmentation(model.context(), data, as_clips_of(data, model, synthetic), options);
  bar.finish();
  if (!rows.empty()) {
    fmt::print("accuracy in percent (spread: standard deviation over {})\n", counted(rows.size(), "seed"));
    print_rows(rows);
    make_folder_of(args.csv);
    motion::write_text_atomically(args.csv, as_csv(rows));
    fmt::print("wrote {}\n", args.csv);
  }
  return caught_signal() != 0 ? 128 + caught_signal() : 0;
}

}  // namespace motiongan::command
