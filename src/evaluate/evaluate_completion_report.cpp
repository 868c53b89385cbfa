// motiongan evaluate completion: the tables.
#include "evaluate/evaluate_completion.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::command {
namespace {

/// The rows of the models in args.save, and of zero velocity, in the order of args.models.
std::vector<CompletionRow> measure(const Context& context, const CompletionData& data,
                                   const CompletionArgs& args) {
  std::vector<CompletionRow> rows;
  for (const std::string& model : args.models) {
    if (model == "zero") {
      rows.push_back({"zero velocity", zero_velocity_errors(data), false, 0});
      continue;
    }
    const RunFiles files{folder_of(args, model)};
    if (!fs::exists(files.generator())) {
      fmt::print("{}: there is no trained model in {}; its row is left out\n", model, shown(files.folder));
      continue;
    }
    require_same_data(data, files.checkpoint());
    const std::size_t iterations = read_run_record(files.checkpoint()).iteration;
    if (model == "dvgan") {
      const Dvgan dvgan = Dvgan::load(context, files.generator());
      const auto stride = static_cast<std::size_t>(std::lround(data.rate() / dvgan.format().rate));
      const SampledErrors errors = dvgan_errors(dvgan, data, stride, args.samples, args.seed);
      rows.push_back({fmt::format("dvgan; mean of {}", args.samples), errors.mean, false, iterations});
      if (args.samples > 1)
        rows.push_back({fmt::format("dvgan; best of {}", args.samples), errors.best, false, iterations});
    } else {
      const PredictionModel predictor = PredictionModel::load(context, files.generator());
      rows.push_back({model, prediction_errors(predictor, data), false, iterations});
    }
  }
  return rows;
}

void print_errors(const CompletionTable& table, const std::string& title,
                  const std::function<CompletionErrors(const CompletionRow&)>& errors_of) {
  std::vector<std::string> head{"ms"};
  for (const int ms : CompletionProtocol::milliseconds) head.push_back(fmt::format("{}", ms));
  std::vector<std::vector<std::string>> rows;
  if (table.times_differ()) {
    rows.push_back({"true ms"});
    for (const double ms : table.true_milliseconds) rows.back().push_back(fmt::format("{:.0f}", ms));
  }
  for (const CompletionRow& row : table.rows) {
    const CompletionErrors errors = errors_of(row);
    if (std::all_of(errors.begin(), errors.end(), [](double e) { return std::isnan(e); })) continue;
    rows.push_back({row.name + (row.published ? " (published)" : "")});
    for (const double error : errors) rows.back().push_back(error_text(error));
  }
  fmt::print("\n{}\n", title);
  print_table(head, rows, "l" + std::string(head.size() - 1, 'r'), "  ");
}

/// Notes on how to read the numbers.
std::vector<std::string> notes_on(const CompletionData& data, const CompletionArgs& args,
                                  const CompletionTable& table) {
  std::vector<std::string> notes{
      "Root of the sum of squared differences of Euler angles (radians, without the root), mean over 8 tests "
      "of each action; lower is better. 50 frames are given, 25 predicted."};
  std::vector<std::string> trained, untrained;
  for (const CompletionRow& row : table.rows)
    if (row.iterations > 0 && row.name.find("best of") == std::string::npos)
      trained.push_back(fmt::format("{} {}", row.name.substr(0, row.name.find(';')), row.iterations));
  if (!trained.empty()) notes.push_back("Training iterations: " + listed(trained) + ".");
  for (std::size_t a = 0; a < data.actions().size(); ++a)
    if (data.train_count(a) == 0) untrained.push_back(data.actions()[a]);
  if (!untrained.empty() && table.rows.size() > 1)
    notes.push_back("Not trained on, because there are no training files: " + listed(untrained) + ".");
  if (table.times_differ())
    notes.push_back(
        "80 to 1000 ms are the literature's names for these frames, which assume 25 frames per second; these "
        "files have 60, so the true times are shorter.");
  if (data.layout() == motion::ExpmapLayout::cmu)
    notes.push_back(
        "The paper's Table 3 is for Human3.6M: other clips at another rate. Its rows are left out because "
        "they are not comparable.");
  for (const std::string& model : args.models)
    if (model == "dvgan" && args.samples > 1)
      notes.push_back(fmt::format(
          "dvgan; best of {} takes the best sample at each time, selected by the ground truth: it shows how "
          "near the samples come, and is not a prediction. A dash marks a time that is no frame of the "
          "model.",
          args.samples));
  return notes;
}

}  // namespace

void report_completion(const Context& context, const CompletionData& data, const CompletionArgs& args) {
  CompletionTable table(data);
  table.rows = measure(context, data, args);
  if (data.layout() == motion::ExpmapLayout::h36m)
    for (CompletionRow& row : published_completion_rows(data.actions())) table.rows.push_back(std::move(row));
  require(!table.rows.empty(), "there is nothing to measure: no model in ", args.save, " is trained");
  for (std::size_t a = 0; a < data.actions().size(); ++a)
    print_errors(table,
                 fmt::format("{} ({})", data.actions()[a], counted(data.train_count(a), "training file")),
                 [&](const CompletionRow& row) { return row.by_action[a]; });
  if (data.actions().size() > 1)
    print_errors(table, fmt::format("mean of {} actions", data.actions().size()), mean_over_actions);
  fmt::print("\n");
  const std::vector<std::string> notes = notes_on(data, args, table);
  for (const std::string& note : notes) fmt::print("{}\n", note);
  if (args.save.empty()) return;
  const fs::path save = args.save;
  make_folder(save);
  motion::write_text_atomically(save / "table.csv", completion_csv(table));
  motion::write_text_atomically(save / "table.md", completion_markdown(table, notes));
  motion::write_text_atomically(save / "table.json", completion_json(table).dump(2) + "\n");
  fmt::print("wrote {}, table.md and table.json\n", shown(save / "table.csv"));
}

}  // namespace motiongan::command
