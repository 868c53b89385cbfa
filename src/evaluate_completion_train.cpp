// motiongan evaluate completion: training the models of the table.
#include "evaluate_completion.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/train/train.hpp"
#include "motiongan/train/train_prediction.hpp"
#include "run_start.hpp"
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

template <class Losses>
std::vector<NamedValue> shown(const Losses& losses) {
  std::vector<NamedValue> out;
  for (const LossColumn& column : columns(losses)) out.emplace_back(column.first, column.second);
  return out;
}

/// Trains on; whether it got to its end.
template <class Losses, class Model, class Data, class Options>
bool train_one(Model& model, const Data& data, Options options, BasicRunOptions<Losses> run,
               const TrainingBudget& budget, const CompletionArgs& args, const std::string& name) {
  const RunFiles files{run.save_dir};
  std::size_t done = 0;
  double minutes = 0;
  run.resume = fs::exists(files.checkpoint());
  if (run.resume) {
    done = read_run_record(files.checkpoint()).iteration;
    minutes = seconds_trained(files, done) / 60;
  }
  fmt::print("{}: training for {}{}\n", name, budget.text(),
             run.resume
                 ? fmt::format("; {} after {} are done", counted(done, "iteration"), duration(60 * minutes))
                 : "");
  std::fflush(stdout);
  if ((budget.minutes == 0 || minutes < budget.minutes) && done < options.iterations) {
    ProgressBar bar(0, {.label = name});
    bar.start(budget.iterations, done);
    if (budget.minutes > 0) run.max_minutes = budget.minutes - minutes;
    run.save_every_minutes = args.save_every_minutes;
    run.log_every = args.log_every;
    run.should_stop = [] { return caught_signal() != 0; };
    run.report = [&](std::size_t iteration, const Losses& losses) { bar.update(iteration, shown(losses)); };
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
  options.critic.critic = args.critic == "rnn" ? Critic::rnn : Critic::cnn;
  options.completion_share = args.completion_share;
  options.seed = args.seed;
  if (options.critic.critic == Critic::cnn) levels_of(args.dvgan_frames);
  Dvgan model(context, windows.format,
              {.generator = Generator::rnn, .hidden = args.dvgan_hidden, .seed = args.seed});
  return train_one(model, windows, options,
                   RunOptions{.save_dir = folder, .notes = notes_of(args, true, data)}, args.dvgan, args,
                   "dvgan");
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
  return train_one(model, prediction_data(data), options,
                   PredictionRunOptions{.save_dir = folder, .notes = notes_of(args, false, data)},
                   args.predictors, args, name);
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
      const auto had = finished_budget(folder);
      if (had && (dvgan ? args.dvgan : args.predictors).within(*had)) {
        fmt::print("{}: is trained already\n", model);
        continue;
      }
    }
    make_folder(folder);
    try {
      const bool ended = dvgan ? train_dvgan(context, data, args, folder)
                               : train_predictor(context, data, args, folder, model);
      if (!ended) return false;
    } catch (const Error& error) {
      // A baseline that diverges does not cost the others their turn.
      if (std::string_view(error.what()).find("training diverged") == std::string_view::npos) throw;
      fmt::print(stderr, "motiongan: {}: {}\n", model, error.what());
    }
  }
  return true;
}

}  // namespace motiongan::command
