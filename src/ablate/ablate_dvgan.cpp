// motiongan ablate dvgan: trains variants of generator, critic, validation, shift and cut alike, and measures
// them with a ranker.
#include "ablate/ablate_dvgan.hpp"

#include "shared/ranks.hpp"
#include "shared/signals.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"
#include "train/training.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {
namespace {

struct AblateDvganArgs : DvganArgs {
  std::string save;
  TrainingBudget budget{.minutes = 0, .iterations = 300};
  std::vector<std::string> variants;
  std::size_t seeds = 3;
  std::string ranker;
  RankerArgs ranking;  // options of the ranker that is trained if none is given
  bool evaluate_only = false, dry_run = false;
  ModelEvaluationOptions evaluation;
};

std::vector<DvganVariant> asked_variants(const std::vector<std::string>& names) {
  std::vector<DvganVariant> out;
  const auto add = [&](const DvganVariant& v) {
    if (std::find(out.begin(), out.end(), v) == out.end()) out.push_back(v);
  };
  for (const std::string& name : names) {
    if (name == "paper")
      for (const DvganVariant& v : paper_dvgan_variants()) add(v);
    else if (name == "all")
      for (const DvganVariant& v : all_dvgan_variants()) add(v);
    else
      add(dvgan_variant(name));
  }
  return out;
}

/// The options of one run, named as in `train dvgan`, so that generate, info and --resume read its folder
/// like that of any other run.
DvganArgs training_of(const DvganArgs& all, const DvganVariant& variant, std::uint64_t seed) {
  DvganArgs args = all;
  args.model = variant.model(args.model);
  args.training = variant.training(args.training);
  args.training.seed = seed;
  fill_in_choices(args);
  return args;
}

/// Takes data and options from the first run of an existing comparison that stores them.
void take_options_of(AblateDvganArgs& args, const CLI::App& verb, const std::vector<DvganVariant>& variants,
                     const std::vector<std::uint64_t>& seeds) {
  for (const DvganVariant& variant : variants)
    for (const std::uint64_t seed : seeds) {
      const fs::path checkpoint = RunFiles{folder_of(args.save, variant.name(), seed)}.checkpoint();
      if (!fs::exists(checkpoint)) continue;
      const std::string note = options_note(checkpoint);
      if (note.empty()) continue;
      const std::size_t iterations = args.training.iterations;
      const std::uint64_t first_seed = args.training.seed;
      DvganArgs& kept = args;
      take_note(fields_of(kept), verb, note, checkpoint, options_of_captioned_clips);
      args.training.iterations = iterations;
      args.training.seed = first_seed;
      return;
    }
}

/// Throws Error unless the ranker and all variants fit the machine; with --dry-run prints what each takes and
/// returns true.
bool only_sized(const Context& context, const motion::Dataset& data, const AblateDvganArgs& args,
                const std::vector<DvganVariant>& variants) {
  const RankerArgs& ranking = args.ranking;
  if (args.ranker.empty()) {
    if (args.dry_run) fmt::print("ranker\n");
    only_sized(context, ranking.training,
               size_options(ranking.training.batch, ranking.model.hidden, "--ranker-hidden"), args.dry_run,
               ranking.training.iterations, builder(data, ranking.model));
  }
  for (const DvganVariant& variant : variants) {
    DvganArgs run = training_of(args, variant, args.training.seed);
    run.training.iterations = iterations_of(args.budget, run.training.steps());
    if (args.dry_run) fmt::print("{}\n", variant.name());
    only_sized(context, run.training, size_options(run.training.batch, run.model.hidden), args.dry_run,
               args.budget.iterations, builder(data, run.model));
  }
  return args.dry_run;
}

/// Ranks train different runs. Returns false if a signal stopped it.
bool train_variants(const Context& context, const motion::Dataset& data, const AblateDvganArgs& all,
                    const std::vector<DvganVariant>& variants, const std::vector<std::uint64_t>& seeds,
                    SharedRuns& runs) {
  // Seed by seed, so that a comparison stopped early has all variants, with fewer seeds.
  for (const std::uint64_t seed : seeds)
    for (const DvganVariant& variant : variants) {
      if (!runs.takes_next()) continue;
      const fs::path folder = folder_of(all.save, variant.name(), seed);
      const std::string name = variant.name() + " " + folder.filename().string();
      if (has_had(folder, all.budget)) {
        fmt::print("{}: already trained\n", name);
        continue;
      }
      make_folder(folder);
      DvganArgs args = training_of(all, variant, seed);
      args.training.iterations = iterations_of(all.budget, args.training.steps());
      Dvgan model(context, data.format, args.model);
      const bool ended = unless_diverged(name, [&] {
        DvganTrainer trainer(model, data, args.training);
        return train_within(
            trainer, [&](const fs::path& path) { data.write_split(path); },
            {.save_dir = folder, .notes = {{"options", note_of(fields_of(args))}}}, all.budget, name);
      });
      if (!ended) return false;
    }
  return true;
}

/// The ranker of --ranker, or that of the comparison, which is trained first if missing. Nothing if a signal
/// stopped it.
std::optional<Ranker> get_ranker(const Context& context, const motion::Dataset& data, AblateDvganArgs& args) {
  if (!args.ranker.empty()) return Ranker::load(context, ranker_file(args.ranker));
  RankerArgs& ranking = args.ranking;
  const CaptionedDataArgs& same_data = args;
  static_cast<CaptionedDataArgs&>(ranking) = same_data;
  fill_in_choices(ranking);
  const fs::path folder = fs::path(args.save) / "ranker";
  const TrainingBudget budget{.minutes = 0,
                              .iterations = ranking.training.iterations,
                              .save_every_minutes = args.budget.save_every_minutes,
                              .log_every = args.budget.log_every};
  if (has_had(folder, budget)) return Ranker::load(context, ranker_file(folder));
  require(!args.evaluate_only, folder.string(),
          " holds no ranker to measure with; give --ranker, or leave out --evaluate-only");
  make_folder(folder);
  std::optional<Ranker> ranker(std::in_place, context, data.format, ranking.model);
  RankerTrainer trainer(*ranker, data, ranking.training);
  if (!train_within(
          trainer, [&](const fs::path& path) { data.write_split(path); },
          {.save_dir = folder, .notes = {{"options", note_of(fields_of(ranking))}}}, budget, "ranker"))
    return std::nullopt;
  return Ranker::load(context, ranker_file(folder));
}

int run_ablation(AblateDvganArgs args, const CLI::App& verb) {
  SharedRuns runs;
  require_one_source(verb);
  settle_budget(verb, args.budget);
  const std::vector<DvganVariant> variants = asked_variants(args.variants);
  const std::vector<std::uint64_t> seeds = seeds_from(args.training.seed, args.seeds);
  if (args.folder.empty() && args.procedural == 0) take_options_of(args, verb, variants, seeds);
  require(!args.folder.empty() || args.procedural > 0,
          "there is nothing to compare on: give a folder of BVH clips, or --procedural");
  // All variants use the same representation of the root's rotation.
  fill_in_data(args, motion::RootRotation::heading);
  for (const DvganVariant& variant : variants) training_of(args, variant, seeds.front());  // throws early

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  require(!data.test.empty(), "no clip is held out for testing; lower --train-share");
  print_fact("device", describe(context.device()));
  print_fact("variants", fmt::format("{}, {} each", variants.size(), counted(seeds.size(), "seed")));
  if (!args.evaluate_only) {
    if (only_sized(context, data, args, variants)) return 0;
    print_saved_to(args.save, args.budget.save_every_minutes);
    catch_signals();
  }
  // The first rank alone measures, and needs a ranker.
  std::optional<Ranker> ranker;
  if (runs.is_first()) ranker = get_ranker(context, data, args);
  const bool trained = (ranker || !runs.is_first()) &&
                       (args.evaluate_only || train_variants(context, data, args, variants, seeds, runs));
  if (!runs.all_ended(trained)) return 128 + caught_signal();
  if (!runs.is_first()) return 0;
  report_dvgan_variants(context, data, *ranker, args.save, variants, seeds, args.evaluation);
  return 0;
}

const Verb ablate_dvgan_verb{
    "ablate dvgan",
    [](CLI::App& ablate, Job& job) {
      CLI::App* verb = ablate.add_subcommand("dvgan",
                                             "Train generators and critics with and without dense "
                                             "validation, input shift and final cut, all with "
                                             "the\nsame budget and several seeds, and measure them with a "
                                             "ranker: Lin & Amer, Tables 2 and S1, on "
                                             "your clips.\nEvery run has its own folder in --save, "
                                             "VARIANT/seed-N. Ctrl-C saves and stops; the same "
                                             "command continues,\nand trains nothing twice.");
      const auto args = std::make_shared<AblateDvganArgs>();
      AblateDvganArgs& a = *args;
      a.variants = {"paper"};
      a.ranking.model.hidden = 256;
      a.ranking.training.iterations = 600;
      add_captioned_data_options(*verb, a);
      verb->add_option("--save", a.save, "folder of the comparison")->required()->type_name("DIR");
      verb->add_option("--variants", a.variants,
                       "paper: the ten rows of Tables 2 and S1; all: the 32 combinations; or names such as "
                       "cnn-cnn-dense-shift-cut, rnn-rnn")
          ->delimiter(',')
          ->capture_default_str()
          ->type_name("A,B");
      add_seed_options(*verb, a.seeds, a.training.seed);
      verb->add_flag("--evaluate-only", a.evaluate_only, "train nothing; measure the existing models");
      add_dry_run(*verb, a.dry_run);
      add_budget_options(*verb, a.budget, "for each run", "Training");
      add_options(*verb, fields_of(a.model), "Model", {.only = {"hidden", "taps"}});
      add_options(
          *verb, fields_of(a.training), "Training",
          {.without = {"iterations", "seed", "critic", "validation", "input_shift", "completion_share"}});
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text)->capture_default_str()->group("Evaluation");
      };
      verb->add_option("--ranker", a.ranker, "folder of a `train ranker` run [one is trained in --save]")
          ->type_name("DIR")
          ->group("Evaluation");
      verb->add_option_function<std::string>(
              "--ranker-kind",
              [&a](const std::string& name) {
                a.ranking.model.kind = enum_from<RankerKind>(name, "--ranker-kind");
              },
              "kind of the ranker that is trained")
          ->check(CLI::IsMember({"cnn", "rnn"}))
          ->default_str(name_of(a.ranking.model.kind))
          ->group("Evaluation");
      option("--ranker-hidden", a.ranking.model.hidden, "width of that ranker")->check(positive());
      option("--ranker-iterations", a.ranking.training.iterations, "training iterations of that ranker")
          ->check(positive());
      option("--descriptions", a.evaluation.descriptions,
             "K: at most this many, the most frequent ones of the test clips")
          ->check(positive());
      option("--samples", a.evaluation.samples, "motions of each description, generated and real")
          ->check(CLI::Range(std::size_t{2}, std::size_t{1'000'000}));
      option("--evaluation-seed", a.evaluation.seed, "seed of the generated motions")->check(not_negative());
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->procedural);
        job = [args, verb] { return run_ablation(*args, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace

}  // namespace motiongan::command
