// motiongan ablate dvgan: generators, critics, validation, shift and cut, trained alike and measured by a
// ranker.
#include "ablate/ablate_dvgan.hpp"

#include "ablate/ablate_attention.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"
#include "train/training.hpp"
#include "train/training_budget.hpp"

namespace motiongan::command {
namespace {

struct AblateDvganArgs : TrainArgs {
  TrainingBudget budget{.minutes = 0, .iterations = 300};
  std::vector<std::string> variants;
  std::size_t seeds = 3;
  std::string ranker;
  RankerArgs ranking;  // of the ranker that is trained where none is given
  bool evaluate_only = false;
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

/// The options of one training, by the names that `train dvgan` gives them, so that generate, info and
/// --resume understand its folder as any other run's.
TrainArgs training_of(const TrainArgs& all, const DvganVariant& variant, std::uint64_t seed) {
  TrainArgs args = all;
  args.generator = variant.generator == GeneratorKind::cnn ? "cnn" : "rnn";
  args.critic = variant.critic == CriticKind::cnn ? "cnn" : "rnn";
  if (variant.critic == CriticKind::cnn) args.validation = variant.validation_name();
  args.final_cut = variant.cut;
  args.training.input_shift = variant.shift;
  args.training.seed = seed;
  fill_in_choices(args);
  return args;
}

/// Takes data and options of a comparison that is there from its first training that says.
void take_options_of(AblateDvganArgs& args, const CLI::App& verb, const std::vector<DvganVariant>& variants,
                     const std::vector<std::uint64_t>& seeds) {
  for (const DvganVariant& variant : variants)
    for (const std::uint64_t seed : seeds) {
      const fs::path checkpoint = RunFiles{folder_of(args.save, variant, seed)}.checkpoint();
      if (!fs::exists(checkpoint)) continue;
      const RunRecord record = read_run_record(checkpoint);
      const auto note = record.notes.find("options");
      if (note == record.notes.end()) continue;
      take_from_note(args, verb, note->second, checkpoint);
      return;
    }
}

/// Whether all were trained; not if a signal stopped it.
bool train_variants(const Context& context, const motion::Dataset& data, const AblateDvganArgs& all,
                    const std::vector<DvganVariant>& variants, const std::vector<std::uint64_t>& seeds) {
  // Seed by seed: a comparison that is stopped early has all variants with fewer seeds.
  for (const std::uint64_t seed : seeds)
    for (const DvganVariant& variant : variants) {
      const fs::path folder = folder_of(all.save, variant, seed);
      const std::string name = variant.name() + " " + folder.filename().string();
      if (has_had(folder, all.budget)) {
        fmt::print("{}: is trained already\n", name);
        continue;
      }
      make_folder(folder);
      TrainArgs args = training_of(all, variant, seed);
      args.training.iterations = all.budget.iterations > 0
                                     ? all.budget.iterations
                                     : (std::size_t{1} << 24) / (args.training.critic_steps + 1) - 2;
      Dvgan model(context, data.format, args.model);
      const bool ended = unless_diverged(name, [&] {
        return train_within(model, data, args.training,
                            RunOptions{.save_dir = folder, .notes = {{"options", options_as_note(args)}}},
                            all.budget, name);
      });
      if (!ended) return false;
    }
  return true;
}

/// The ranker that was given, or that of the comparison, trained where it is not there yet. Null if a signal
/// stopped it.
std::optional<Ranker> get_ranker(const Context& context, const motion::Dataset& data, AblateDvganArgs& args) {
  if (!args.ranker.empty()) return Ranker::load(context, ranker_file(args.ranker));
  RankerArgs& ranking = args.ranking;
  const CaptionedDataArgs& same_data = args;
  static_cast<CaptionedDataArgs&>(ranking) = same_data;
  fill_in(ranking);
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
  const RunNotes notes{{"options", note_of([&](const auto& f) { each_kept(ranking, f); })}};
  if (!train_within(*ranker, data, ranking.training, RankerRunOptions{.save_dir = folder, .notes = notes},
                    budget, "ranker"))
    return std::nullopt;
  return Ranker::load(context, ranker_file(folder));
}

int run_ablation(AblateDvganArgs args, const CLI::App& verb) {
  require(!(verb.count("FOLDER") && verb.count("--procedural")),
          "give a folder of clips or --procedural, not both");
  settle_budget(verb, args.budget);
  const std::vector<DvganVariant> variants = asked_variants(args.variants);
  std::vector<std::uint64_t> seeds;
  for (std::size_t i = 0; i < args.seeds; ++i) seeds.push_back(args.training.seed + i);
  if (args.folder.empty() && args.procedural == 0) take_options_of(args, verb, variants, seeds);
  require(!args.folder.empty() || args.procedural > 0,
          "there is nothing to compare on: give a folder of BVH clips, or --procedural");
  // One form of the data for all of them.
  fill_in_data(args, "heading");
  for (const DvganVariant& variant : variants) training_of(args, variant, seeds.front());  // refuses early

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  require(!data.test.empty(), "no clip is kept for testing; lower --train-share");
  print_fact("device", describe(context.device()));
  print_fact("variants", fmt::format("{}, {} each", variants.size(), counted(seeds.size(), "seed")));
  if (!args.evaluate_only) {
    print_fact("saved to", fmt::format("{}, every {} and at the end of each training", args.save,
                                       duration(60 * args.budget.save_every_minutes)));
    catch_signals();
  }
  const std::optional<Ranker> ranker = get_ranker(context, data, args);
  const bool trained = ranker && (args.evaluate_only || train_variants(context, data, args, variants, seeds));
  if (!trained) return 128 + caught_signal();
  report_dvgan_variants(context, data, *ranker, args.save, variants, seeds, args.evaluation);
  return 0;
}

}  // namespace

void add_ablate_dvgan(CLI::App& ablate, Job& job) {
  CLI::App* verb = ablate.add_subcommand(
      "dvgan",
      "Train generators and critics, with and without dense validation, input shift and final cut, each as "
      "long\nand with several seeds, and measure what they make by a ranker: the paper's Tables 2 and S1, on "
      "your clips.\nEvery training has a folder of its own in --save, VARIANT/seed-N. Ctrl-C saves and "
      "stops; the same command goes on,\nand trains nothing twice.");
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
  verb->add_option("--seeds", a.seeds, "trainings of each variant")->check(positive())->capture_default_str();
  verb->add_option("--seed", a.training.seed, "the first of them")
      ->check(not_negative())
      ->capture_default_str();
  verb->add_flag("--evaluate-only", a.evaluate_only, "train nothing; take the models that are there");
  add_budget_options(*verb, a.budget, "for each training", "Training");
  add_shared_dvgan_options(*verb, a);
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb->add_option(name, member, text)->capture_default_str()->group("Evaluation");
  };
  verb->add_option("--ranker", a.ranker, "folder of a run of `train ranker` [one is trained in --save]")
      ->type_name("DIR")
      ->group("Evaluation");
  option("--ranker-kind", a.ranking.kind, "of the one that is trained")->check(CLI::IsMember({"cnn", "rnn"}));
  option("--ranker-hidden", a.ranking.model.hidden, "its width")->check(positive());
  option("--ranker-iterations", a.ranking.training.iterations, "how long it is trained")->check(positive());
  option("--descriptions", a.evaluation.descriptions, "K: the most popular ones of the test clips, at most")
      ->check(positive());
  option("--samples", a.evaluation.samples, "motions of each description, made and real")
      ->check(CLI::Range(std::size_t{2}, std::size_t{1'000'000}));
  option("--evaluation-seed", a.evaluation.seed, "of the motions made")->check(not_negative());
  verb->callback([&job, args, verb] {
    fill_in_procedural(*verb, *args);
    job = [args, verb] { return run_ablation(*args, *verb); };
  });
}

}  // namespace motiongan::command
