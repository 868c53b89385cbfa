// motiongan evaluate completion: training the models of the table.
#include "evaluate/evaluate_completion.hpp"
#include "motiongan/train/train.hpp"
#include "motiongan/train/train_prediction.hpp"
#include "train/run_start.hpp"
#include "signals.hpp"

namespace motiongan::command {
namespace {

/// Calls f(name, member) for all options that a model's checkpoint keeps.
template <class F>
void each_kept(CompletionArgs& a, bool dvgan, F&& f) {
  f("--seed", a.seed);
  if (dvgan) {
    f("--dvgan-hidden", a.dvgan_hidden);
    f("--dvgan-batch", a.dvgan_batch);
    f("--dvgan-frames", a.dvgan_frames);
    f("--dvgan-stride", a.dvgan_stride);
    f("--critic", a.critic);
    f("--critic-steps", a.critic_steps);
    f("--completion-share", a.completion_share);
  } else {
    f("--hidden", a.hidden);
    f("--batch", a.batch);
  }
}

/// What the model is trained on, to tell other files from these.
std::string data_note(const CompletionData& data) {
  nlohmann::json clips = nlohmann::json::array();
  for (const CompletionClip& clip : data.train()) clips.push_back({clip.id, clip.frames});
  return nlohmann::json{{"layout", name_of(data.layout())},
                        {"columns", data.columns()},
                        {"classes", data.classes()},
                        {"clips", clips}}
      .dump();
}

/// Takes what the command line does not give from the run that is there; refuses what differs from it.
void take_run(CompletionArgs& args, bool dvgan, const CLI::App& verb, const fs::path& checkpoint) {
  const RunRecord record = read_run_record(checkpoint);
  const auto found = record.notes.find("options");
  require(found != record.notes.end(), checkpoint.string(),
          " is of another command: it does not say its options; choose another --save");
  const auto each = [&](const auto& f) { each_kept(args, dvgan, f); };
  take_note(each, verb, found->second, checkpoint, [](const std::string&) { return false; });
  const auto then = nlohmann::json::parse(found->second), now = nlohmann::json::parse(note_of(each));
  for (const auto& [name, value] : now.items())
    require(!then.contains(name) || then.at(name) == value, checkpoint.string(), " was trained with ", name,
            " ", then.value(name, nlohmann::json()).dump(), ", now ", value.dump(),
            " is asked; give the same, or choose another --save");
}

TrainingBudget budget_of(const CompletionArgs& args, bool dvgan) {
  TrainingBudget budget = dvgan ? args.dvgan : args.predictors;
  budget.save_every_minutes = args.save_every_minutes;
  budget.log_every = args.log_every;
  return budget;
}

RunNotes notes_of(CompletionArgs args, bool dvgan, const CompletionData& data) {
  return {{"options", note_of([&](const auto& f) { each_kept(args, dvgan, f); })}, {"data", data_note(data)}};
}

bool train_dvgan(const Context& context, const CompletionData& data, const CompletionArgs& args,
                 const fs::path& folder) {
  const motion::Dataset windows = completion_dataset(data, args.dvgan_frames, args.dvgan_stride);
  if (!windows.skipped.empty()) {
    std::vector<std::string> ids;
    for (const motion::SkippedClip& clip : windows.skipped) ids.push_back(clip.id);
    fmt::print("dvgan: {} too short for its windows of {} frames and left out: {}\n",
               counted(ids.size(), "file"), args.dvgan_frames, listed(ids));
  }
  DvganTrainOptions options;
  options.iterations = args.dvgan.iterations > 0 ? args.dvgan.iterations
                                                 : (std::size_t{1} << 24) / (args.critic_steps + 1) - 2;
  options.critic_steps = args.critic_steps;
  options.batch = args.dvgan_batch;
  options.critic.critic = args.critic == "rnn" ? CriticKind::rnn : CriticKind::cnn;
  options.completion_share = args.completion_share;
  options.seed = args.seed;
  if (options.critic.critic == CriticKind::cnn) levels_of(args.dvgan_frames);
  Dvgan model(context, windows.format,
              {.generator = GeneratorKind::rnn, .hidden = args.dvgan_hidden, .seed = args.seed});
  return train_within(model, windows, options,
                      RunOptions{.save_dir = folder, .notes = notes_of(args, true, data)},
                      budget_of(args, true), "dvgan");
}

bool train_predictor(const Context& context, const CompletionData& data, const CompletionArgs& args,
                     const fs::path& folder, const std::string& name) {
  std::string kind = name;
  std::replace(kind.begin(), kind.end(), '-', '_');
  PredictionTrainOptions options;
  options.iterations = args.predictors.iterations > 0 ? args.predictors.iterations : (1u << 24) - 1;
  options.batch = args.batch;
  options.prefix = CompletionProtocol::prefix;
  options.future = CompletionProtocol::future;
  options.seed = args.seed;
  PredictionModel model(context, data.dof(), data.classes().size(),
                        {.predictor = predictor_from(kind), .hidden = args.hidden, .seed = args.seed});
  return train_within(model, prediction_data(data), options,
                      PredictionRunOptions{.save_dir = folder, .notes = notes_of(args, false, data)},
                      budget_of(args, false), name);
}

}  // namespace

void require_same_data(const CompletionData& data, const fs::path& checkpoint) {
  const RunRecord record = read_run_record(checkpoint);
  const auto note = record.notes.find("data");
  require(note != record.notes.end() && note->second == data_note(data), checkpoint.string(),
          " was trained on other files, or on other actions of them; give the folder and the --train-actions "
          "of its first start, or another --save");
}

bool train_completion_models(const Context& context, const CompletionData& data, const CompletionArgs& asked,
                             const CLI::App& verb) {
  catch_signals();
  for (const std::string& model : asked.models) {
    if (model == "zero") continue;
    const bool dvgan = model == "dvgan";
    const fs::path folder = folder_of(asked, model), checkpoint = RunFiles{folder}.checkpoint();
    CompletionArgs args = asked;
    if (args.dvgan_frames == 0) args.dvgan_frames = data.layout() == motion::ExpmapLayout::cmu ? 32 : 64;
    if (fs::exists(checkpoint)) {
      take_run(args, dvgan, verb, checkpoint);
      require_same_data(data, checkpoint);
      if (has_had(folder, budget_of(args, dvgan))) {
        fmt::print("{}: is trained already\n", model);
        continue;
      }
    }
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
