// motiongan evaluate completion: training the models of the table.
#include "evaluate/evaluate_completion.hpp"
#include "motiongan/train/prediction_trainer.hpp"
#include "shared/signals.hpp"
#include "train/run_start.hpp"
#include "train/training.hpp"

namespace motiongan::command {
namespace {

/// The training data as text, stored in the checkpoint to detect other data.
std::string data_note(const CompletionData& data) {
  nlohmann::json clips = nlohmann::json::array();
  for (const CompletionClip& clip : data.train()) clips.push_back({clip.id, clip.frames});
  return nlohmann::json{{"layout", name_of(data.layout())},
                        {"columns", data.columns()},
                        {"classes", data.classes()},
                        {"clips", clips}}
      .dump();
}

/// Takes options that the command line does not give from the existing run. Throws Error if others differ.
void take_run(CompletionArgs& args, bool dvgan, const CLI::App& verb, const fs::path& checkpoint) {
  const std::string note = options_note(checkpoint);
  require(!note.empty(), checkpoint.string(),
          " was not written by this command: it stores no options; choose another --save");
  const FieldList fields = args.kept_fields(dvgan);
  take_note(fields, verb, note, checkpoint);
  const nlohmann::json then = io::parse_object(note, checkpoint.string()),
                       now = nlohmann::json::parse(note_of(fields));
  for (const auto& [name, value] : now.items())
    require(!then.contains(name) || then.at(name) == value, checkpoint.string(), " was trained with ", name,
            " ", then.value(name, nlohmann::json()).dump(), ", now it is ", value.dump(),
            "; give the same, or choose another --save");
}

TrainingBudget budget_of(const CompletionArgs& args, bool dvgan) {
  TrainingBudget budget = dvgan ? args.dvgan : args.predictors;
  budget.save_every_minutes = args.save_every_minutes;
  budget.log_every = args.log_every;
  return budget;
}

RunNotes notes_of(CompletionArgs args, bool dvgan, const CompletionData& data) {
  return {{"options", note_of(args.kept_fields(dvgan))}, {"data", data_note(data)}};
}

bool train_dvgan(const Context& context, const CompletionData& data, const CompletionArgs& args,
                 const fs::path& folder) {
  const motion::Dataset windows = completion_dataset(data, args.dvgan_frames, args.dvgan_stride);
  if (!windows.skipped.empty()) {
    std::vector<std::string> ids;
    for (const motion::SkippedClip& clip : windows.skipped) ids.push_back(clip.id);
    fmt::print("dvgan: left out {} too short for a window of {} frames: {}\n", counted(ids.size(), "file"),
               args.dvgan_frames, listed(ids));
  }
  DvganTrainOptions options;
  options.critic_steps = args.critic_steps;
  options.iterations = iterations_of(args.dvgan, options.steps());
  options.batch = args.dvgan_batch;
  options.critic.critic = args.critic;
  options.completion_share = args.completion_share;
  options.seed = args.seed;
  if (options.critic.critic == CriticKind::cnn) levels_of(args.dvgan_frames);
  const DvganOptions network{.generator = GeneratorKind::rnn, .hidden = args.dvgan_hidden, .seed = args.seed};
  const std::string lower =
      concat("--dvgan-batch (now ", args.dvgan_batch, ") or --dvgan-hidden (now ", args.dvgan_hidden, ")");
  if (only_sized(context, options, lower, args.dry_run, args.dvgan.iterations, builder(windows, network)))
    return true;
  Dvgan model(context, windows.format, network);
  DvganTrainer trainer(model, windows, options);
  return train_within(
      trainer, [&](const fs::path& path) { windows.write_split(path); },
      {.save_dir = folder, .notes = notes_of(args, true, data)}, budget_of(args, true), "dvgan");
}

bool train_predictor(const Context& context, const CompletionData& data, const CompletionArgs& args,
                     const fs::path& folder, const std::string& name) {
  std::string kind = name;
  std::replace(kind.begin(), kind.end(), '-', '_');
  PredictionTrainOptions options;
  options.iterations = iterations_of(args.predictors, options.steps());
  options.batch = args.batch;
  options.prefix = CompletionProtocol::prefix;
  options.future = CompletionProtocol::future;
  options.seed = args.seed;
  const PredictionFormat format{data.dof(), data.classes().size()};
  const PredictionOptions network{
      .predictor = enum_from<Predictor>(kind, "--models"), .hidden = args.hidden, .seed = args.seed};
  const PredictionData sequences = prediction_data(data);
  const auto build = [&](const Context& in, const PredictionTrainOptions& trial, const TrainerUse& use) {
    PredictionModel model(in, format, network);
    PredictionTrainer trainer(model, sequences, trial);
    use(trainer);
  };
  const std::size_t width = args.hidden > 0 ? args.hidden : usual_hidden(network.predictor);
  if (only_sized(context, options, size_options(args.batch, width), args.dry_run, args.predictors.iterations,
                 build))
    return true;
  PredictionModel model(context, format, network);
  PredictionTrainer trainer(model, sequences, options);
  return train_within(
      trainer, [&](const fs::path& path) { sequences.write_split(path); },
      {.save_dir = folder, .notes = notes_of(args, false, data)}, budget_of(args, false), name);
}

}  // namespace

void require_same_data(const CompletionData& data, const fs::path& checkpoint) {
  const RunRecord record = read_run_record(checkpoint);
  const auto note = record.notes.find("data");
  require(note != record.notes.end() && note->second == data_note(data), checkpoint.string(),
          " was trained on other files, or on other actions of them; give the original folder and "
          "--train-actions, or another --save");
}

bool train_completion_models(const Context& context, const CompletionData& data, const CompletionArgs& asked,
                             const CLI::App& verb, SharedRuns& runs) {
  catch_signals();
  for (const std::string& model : asked.models) {
    if (model == "zero" || (!asked.dry_run && !runs.takes_next())) continue;
    const bool dvgan = model == "dvgan";
    const fs::path folder = folder_of(asked, model), checkpoint = RunFiles{folder}.checkpoint();
    CompletionArgs args = asked;
    if (args.dvgan_frames == 0) args.dvgan_frames = data.layout() == motion::ExpmapLayout::cmu ? 32 : 64;
    if (fs::exists(checkpoint)) {
      take_run(args, dvgan, verb, checkpoint);
      require_same_data(data, checkpoint);
      if (has_had(folder, budget_of(args, dvgan))) {
        fmt::print("{}: already trained\n", model);
        continue;
      }
    }
    if (args.dry_run)
      fmt::print("{}\n", model);
    else
      make_folder(folder);
    const bool ended = unless_diverged(model, [&] {
      return dvgan ? train_dvgan(context, data, args, folder)
                   : train_predictor(context, data, args, folder, model);
    });
    if (!ended) return false;
  }
  return true;
}

}  // namespace motiongan::command
