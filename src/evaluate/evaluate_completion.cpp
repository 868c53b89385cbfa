// motiongan evaluate completion: completion error (Lin & Amer, Table 3).
#include "evaluate/evaluate_completion.hpp"

#include "shared/signals.hpp"
#include "train/training_size.hpp"

namespace motiongan::command {

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

fs::path folder_of(const CompletionArgs& args, const std::string& model) {
  return fs::path(args.save) / model;
}

namespace {

const std::vector<std::string>& known_models() {
  static const std::vector<std::string> all = CompletionArgs{}.models;
  return all;
}

int evaluate_completion(CompletionArgs args, const CLI::App& verb) {
  SharedRuns runs;
  std::vector<std::string> trained;
  for (const std::string& model : args.models) {
    require(std::find(known_models().begin(), known_models().end(), model) != known_models().end(),
            "--models ", model, ": expected some of ", listed(known_models()));
    require(std::count(args.models.begin(), args.models.end(), model) == 1, "--models names ", model,
            " twice");
    if (model != "zero") trained.push_back(model);
  }
  require(trained.empty() || !args.save.empty(), "--save DIR is needed for ", listed(trained),
          ", to store the trained models; --models zero alone needs none");
  // --minutes alone is the whole budget.
  if (args.minutes > 0) {
    if (verb.count("--iterations") == 0) args.predictors.iterations = 0;
    if (verb.count("--dvgan-iterations") == 0) args.dvgan.iterations = 0;
    args.predictors.minutes = args.dvgan.minutes = args.minutes;
  }
  motion::ExpmapSelection selection{args.actions, args.train_actions, {}};
  if (args.layout != "auto")
    selection.layout = args.layout == "h36m" ? motion::ExpmapLayout::h36m : motion::ExpmapLayout::cmu;
  fmt::print("reading {}\n", shown(args.folder));
  const CompletionData data(motion::read_expmap_collection(args.folder, selection));
  std::size_t frames = 0;
  for (const CompletionClip& clip : data.train()) frames += clip.frames;
  print_fact("layout", fmt::format("{}: {} columns, {} of which vary", name_of(data.layout()), data.columns(),
                                   data.dof()));
  print_fact("training", fmt::format("{}, {} frames at {} per second", counted(data.train().size(), "file"),
                                     frames, brief(data.rate())));
  print_fact("tests", fmt::format("{} for each of {}: {}", CompletionProtocol::tests,
                                  counted(data.actions().size(), "action"), listed(data.actions())));
  const Context context;
  if (!trained.empty()) print_fact("device", describe(context.device()));
  if (!args.evaluate_only && !trained.empty()) {
    if (!args.dry_run) print_fact("saved to", args.save);
    const bool ended = train_completion_models(context, data, args, verb, runs);
    if (!runs.all_ended(ended)) return 128 + caught_signal();
    if (args.dry_run) return 0;
  }
  if (!runs.is_first()) return 0;
  report_completion(context, data, args);
  return 0;
}

void add_model_options(CLI::App& verb, CompletionArgs& a) {
  const char* group = "Training";
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group(group);
  };
  option("--iterations", a.predictors.iterations, "training iterations of each model but dvgan")
      ->check(positive());
  option("--dvgan-iterations", a.dvgan.iterations, "training iterations of dvgan")->check(positive());
  option("--minutes", a.minutes,
         "training time of each model; the whole budget if no iterations are given; 0: no limit")
      ->check(not_negative());
  FieldList shared, predictors, dvgan;
  shared.add(a.seed, {.key = "seed", .help = "seed of the initial weights, batches and noise"});
  a.list_predictor_fields(predictors);
  a.list_dvgan_fields(dvgan);
  add_options(verb, shared, group);
  option("--save-every", a.save_every_minutes, "minutes between two checkpoints; 0: only at the end")
      ->check(not_negative());
  option("--log-every", a.log_every, "iterations between two rows of log.csv")->check(positive());
  add_options(verb, predictors, "lstm, seq2seq, erd, lstm-3lr");
  add_options(verb, dvgan, "dvgan");
}

const Verb evaluate_completion_verb{
    "evaluate completion",
    [](CLI::App& evaluate, Job& job) {
      CLI::App* verb = evaluate.add_subcommand(
          "completion",
          "Measure the completion error against the ground truth, as in the motion-prediction papers: train\n"
          "the baselines and dvgan on text files of exponential maps, each in a folder of --save, then "
          "print\n"
          "and write the tables. Ctrl-C saves and stops; the same command continues, and trains nothing "
          "twice.");
      const auto args = std::make_shared<CompletionArgs>();
      CompletionArgs& a = *args;
      verb->add_option("FOLDER", a.folder, "folder with S1, S5, ... (Human3.6M) or train and test (CMU)")
          ->required()
          ->type_name("");
      verb->add_option("--layout", a.layout, "h36m or cmu; auto: by the folder names")
          ->capture_default_str()
          ->check(CLI::IsMember({"auto", "h36m", "cmu"}));
      verb->add_option("--actions", a.actions, "actions to test [all that have test files]")
          ->delimiter(',')
          ->type_name("A,B");
      verb->add_option("--train-actions", a.train_actions,
                       "actions to train on [all that have training files]")
          ->delimiter(',')
          ->type_name("A,B");
      verb->add_option("--models", a.models, "rows of the tables")
          ->delimiter(',')
          ->type_name("A,B")
          ->default_str(listed(known_models()));
      verb->add_option("--save", a.save, "folder of the trained models and of the tables")->type_name("DIR");
      verb->add_flag("--evaluate-only", a.evaluate_only, "train nothing; evaluate the existing models");
      add_dry_run(*verb, a.dry_run);
      verb->add_option("--samples", a.samples, "completions that dvgan generates for each test")
          ->capture_default_str()
          ->check(CLI::Range(1, 65535));
      add_model_options(*verb, a);
      verb->callback(
          [&job, args, verb] { job = [args, verb] { return evaluate_completion(*args, *verb); }; });
    },
    Verb::Runs::on_ranks};

}  // namespace

}  // namespace motiongan::command
