// motiongan ablate attention: trains the attention model with and without each of its parts, and compares.
#include "ablate/ablate_attention.hpp"

#include "shared/action_data.hpp"
#include "shared/signals.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

struct AblateArgs {
  ActionDataArgs data;
  AblationTraining training;
  std::size_t seeds = 1;
  std::string save;
  std::vector<std::string> variants;
  bool evaluate_only = false;
  EvaluationOptions evaluation;
};

/// The options stored in a run's checkpoint, named as in `train attention`, so that generate and info read
/// its folder like that of any other run.
FieldList kept_fields(ActionDataArgs& data, ActionGanOptions& model, AttentionTrainOptions& training) {
  FieldList list;
  data.list_fields(list);
  model.list_fields(list);
  training.list_fields(list);
  return list;
}

RunNotes notes_of(AblateArgs args, const AblationVariant& variant, std::uint64_t seed) {
  const AblationTraining seeded = with_seed(args.training, seed);
  ActionGanOptions model = variant.model(seeded.model);
  AttentionTrainOptions training = variant.training(seeded.training);
  return {{"options", note_of(kept_fields(args.data, model, training))}};
}

/// Takes data and options from the first run of an existing comparison that stores them, except for the parts
/// and weights that its variant changes.
void take_options_of(AblateArgs& args, const CLI::App& verb) {
  AttentionTrainOptions& training = args.training.training;
  for (const AblationVariant& variant : ablation_variants())
    for (const std::uint64_t seed : seeds_from(training.seed, args.seeds)) {
      const fs::path folder = run_folder(args.save, variant, seed, training.seed);
      const fs::path checkpoint = RunFiles{folder}.checkpoint();
      if (!fs::exists(checkpoint)) continue;
      const std::string note = options_note(checkpoint);
      if (note.empty()) continue;
      const ActionGanOptions model = args.training.model;
      const AttentionTrainOptions asked = training;
      take_note(kept_fields(args.data, args.training.model, training), verb, note, checkpoint,
                options_of_action_clips);
      args.training.model.generator = model.generator;
      training.iterations = asked.iterations;
      // The one seed of an earlier version is the first.
      if (folder.filename() != fs::path(variant.name)) training.seed = asked.seed;
      if (!variant.attention) args.training.model.attention = model.attention;
      if (!variant.skeleton_loss) training.skeleton_weight = asked.skeleton_weight;
      if (!variant.blend_loss) training.blend_weight = asked.blend_weight;
      if (variant.lstm) args.training.model.noise_dim = model.noise_dim;
      return;
    }
}

int run_ablation(AblateArgs args, const CLI::App& verb) {
  SharedRuns runs;
  require_one_source(verb);
  std::vector<const AblationVariant*> variants;
  for (const std::string& name : args.variants) variants.push_back(&ablation_variant(name));
  if (variants.empty())
    for (const AblationVariant& variant : ablation_variants()) variants.push_back(&variant);
  settle_budget(verb, args.training.budget);
  if (args.data.folder.empty() && args.data.procedural == 0) take_options_of(args, verb);
  require(!args.data.folder.empty() || args.data.procedural > 0,
          "there is nothing to compare on: give a folder of clips and their labels, or --procedural");
  fill_in_choices(args.data);
  args.training.seeds = seeds_from(args.training.training.seed, args.seeds);

  const Context context;
  const motion::ActionDataset data = load_data(args.data);
  print_data(data, args.data);
  print_fact("device", describe(context.device()));
  // Fails now, not after hours of training, if no test clip is long enough for a window.
  choose_windows(data, args.evaluation.frames, args.evaluation.windows, args.evaluation.seed);
  if (!args.evaluate_only) {
    if (only_sized(context, data, variants, args.training)) return 0;
    print_saved_to(args.save, args.training.budget.save_every_minutes);
    const bool all = train_variants(
        context, data, args.save, variants, args.training,
        [&](const AblationVariant& variant, std::uint64_t seed) { return notes_of(args, variant, seed); },
        runs);
    if (!runs.all_ended(all)) return 128 + caught_signal();
  }
  if (!runs.is_first()) return 0;
  report_variants(context, data, args.save, variants, args.training.seeds,
                  {args.evaluation, args.data.options.clips.unit_metres / args.data.options.clips.scale,
                   args.evaluate_only && !args.variants.empty()});
  return 0;
}

void add_training_options(CLI::App& verb, AblationTraining& a) {
  const char* group = "Training, the same for all";
  add_budget_options(verb, a.budget, "for each variant", group);
  add_options(verb, fields_of(a.model), group, {.only = {"hidden", "continues", "exact_bones"}});
  add_options(
      verb, fields_of(a.training), group,
      {.without = {"iterations", "seed", "weight_clip", "skeleton_vectors", "critic_classes", "balanced"}});
  // A loss that a variant leaves out must be on in the others.
  for (const char* name : {"--skeleton-weight", "--blend-weight"}) verb.get_option(name)->check(positive());
}

const Verb ablate_attention_verb{
    "ablate attention",
    [](CLI::App& ablate, Job& job) {
      CLI::App* verb = ablate.add_subcommand(
          "attention",
          "Train the attention WGAN-GP, its variants without attention, blend loss or skeleton loss, and "
          "the\n"
          "LSTM baseline, all with the same budget, and measure them on test clips: table.csv, runs.csv,\n"
          "angles.csv, angles.png and strips of poses in --save. Every run has its own folder there,\n"
          "VARIANT/seed-N. Ctrl-C saves and stops; the same command continues, and trains nothing twice.");
      const auto args = std::make_shared<AblateArgs>();
      AblateArgs& a = *args;
      a.training.budget.minutes = 20;
      add_action_data_options(*verb, a.data, true);
      verb->add_option("--save", a.save, "folder of the comparison")->required()->type_name("DIR");
      std::string names;
      for (const AblationVariant& v : ablation_variants()) names += concat(names.empty() ? "" : ", ", v.name);
      verb->add_option("--variants", a.variants, "variants to train and measure [all]: " + names)
          ->delimiter(',')
          ->type_name("A,B");
      add_seed_options(*verb, a.seeds, a.training.training.seed);
      verb->add_flag("--evaluate-only", a.evaluate_only, "train nothing; measure the existing models");
      add_dry_run(*verb, a.training.dry_run);
      add_training_options(*verb, a.training);
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text)->capture_default_str()->group("Evaluation");
      };
      option("--windows", a.evaluation.windows, "at most this many priors, cycling through the classes")
          ->check(positive());
      option("--future", a.evaluation.frames, "frames after each prior that are compared; the paper: 70")
          ->check(positive());
      option("--window-seed", a.evaluation.seed, "seed that selects the windows")->check(not_negative());
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->data.procedural);
        job = [args, verb] { return run_ablation(*args, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace

}  // namespace motiongan::command
