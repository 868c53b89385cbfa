// motiongan ablate attention: the second paper's model beside itself without each of its parts.
#include "ablate/ablate_attention.hpp"

#include "action_data.hpp"
#include "train/run_start.hpp"
#include "signals.hpp"
#include "train/training_options.hpp"

namespace motiongan::command {
namespace {

struct AblateArgs {
  ActionDataArgs data;
  AblationTraining training;
  std::string save;
  std::vector<std::string> variants;
  bool evaluate_only = false;
  double unit_metres = 0;
  EvaluationOptions evaluation;
};

/// Calls f(name, member) for all options of the training that a variant's checkpoint keeps, by the names that
/// `train attention` gives them, so that generate and info understand a variant's folder as any other run's.
template <class F>
void each_trained(ActionGanOptions& model, AttentionTrainOptions& training, F&& f) {
  f("--hidden", model.hidden);
  f("--noise", model.noise_dim);
  f("--attention", model.attention);
  f("--critic-steps", training.critic_steps);
  f("--generator-steps", training.generator_steps);
  f("--rollouts", training.rollouts);
  f("--lambda", training.lambda_gp);
  f("--weight-clip", training.weight_clip);
  f("--skeleton-weight", training.skeleton_weight);
  f("--blend-weight", training.blend_weight);
  f("--class-weight", training.class_weight);
  f("--skeleton-vectors", training.skeleton_vectors);
  f("--critic-classes", training.critic_classes);
  f("--batch", training.batch);
  f("--balanced", training.balanced);
  f("--learning-rate", training.adam.learning_rate);
  f("--beta1", training.adam.beta1);
  f("--beta2", training.adam.beta2);
  f("--epsilon", training.adam.epsilon);
  f("--seed", training.seed);
}

RunNotes notes_of(AblateArgs args, const AblationVariant& variant) {
  ActionGanOptions model = variant.model(args.training.model);
  AttentionTrainOptions training = variant.training(args.training.training);
  std::string network = variant.lstm ? "lstm" : "attention";
  return {{"options", note_of([&](const auto& f) {
             each_kept(args.data, f);
             f("--model", network);
             each_trained(model, training, f);
           })}};
}

/// Takes data and options of a comparison that is there from its first variant that says; a variant's own
/// parts and weights are those of the comparison only in `full`.
void take_options_of(AblateArgs& args, const CLI::App& verb) {
  for (const AblationVariant& variant : ablation_variants()) {
    const fs::path checkpoint = RunFiles{fs::path(args.save) / variant.name}.checkpoint();
    if (!fs::exists(checkpoint)) continue;
    const RunRecord record = read_run_record(checkpoint);
    const auto note = record.notes.find("options");
    if (note == record.notes.end()) continue;
    const ActionGanOptions model = args.training.model;
    const AttentionTrainOptions training = args.training.training;
    take_note(
        [&](const auto& f) {
          each_kept(args.data, f);
          each_trained(args.training.model, args.training.training, f);
        },
        verb, note->second, checkpoint, describes_clips);
    if (!variant.attention) args.training.model.attention = model.attention;
    if (!variant.skeleton_loss) args.training.training.skeleton_weight = training.skeleton_weight;
    if (!variant.blend_loss) args.training.training.blend_weight = training.blend_weight;
    if (variant.lstm) args.training.model.noise_dim = model.noise_dim;
    return;
  }
}

int run_ablation(AblateArgs args, const CLI::App& verb) {
  require(!(verb.count("FOLDER") && verb.count("--procedural")),
          "give a folder of clips or --procedural, not both");
  std::vector<const AblationVariant*> variants;
  for (const std::string& name : args.variants) variants.push_back(&ablation_variant(name));
  if (variants.empty())
    for (const AblationVariant& variant : ablation_variants()) variants.push_back(&variant);
  settle_budget(verb, args.training.budget);
  if (args.data.folder.empty() && args.data.procedural == 0) take_options_of(args, verb);
  require(!args.data.folder.empty() || args.data.procedural > 0,
          "there is nothing to compare on: give a folder of clips and their labels, or --procedural");
  fill_in_choices(args.data);
  args.training.model.seed = args.training.training.seed;

  const Context context;
  const motion::ActionDataset data = load_data(args.data);
  print_data(data, args.data);
  print_fact("device", describe(context.device()));
  // Windows that the test clips do not hold are refused now, not after hours of training.
  choose_windows(data, args.evaluation.frames, args.evaluation.windows, args.evaluation.seed);
  if (!args.evaluate_only) {
    print_fact("saved to", fmt::format("{}, every {} and at the end of each variant", args.save,
                                       duration(60 * args.training.budget.save_every_minutes)));
    const bool all = train_variants(context, data, args.save, variants, args.training,
                                    [&](const AblationVariant& variant) { return notes_of(args, variant); });
    if (!all) return 128 + caught_signal();
  }
  report_variants(context, data, args.save, variants,
                  {args.evaluation, args.unit_metres, args.evaluate_only && !args.variants.empty()});
  return 0;
}

void add_training_options(CLI::App& verb, AblationTraining& a) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group("Training, the same for all");
  };
  AttentionTrainOptions& t = a.training;
  add_budget_options(verb, a.budget, "for each variant", "Training, the same for all");
  option("--hidden", a.model.hidden, "width of the networks")->check(positive());
  option("--batch", t.batch, "windows in a step")->check(positive());
  option("--critic-steps", t.critic_steps, "in each iteration")->check(positive());
  option("--generator-steps", t.generator_steps, "in each iteration")->check(positive());
  option("--rollouts", t.rollouts, "how many times the generator goes on from its own output")
      ->check(positive());
  option("--lambda", t.lambda_gp, "weight of the gradient penalty")->check(not_negative());
  option("--skeleton-weight", t.skeleton_weight, "of the loss of bone lengths, where a variant has it")
      ->check(positive());
  option("--blend-weight", t.blend_weight, "of the loss at the seam, where a variant has it")
      ->check(positive());
  option("--class-weight", t.class_weight, "of the classification loss")->check(not_negative());
  add_adam_options(verb, t.adam, ", of all networks", "Training, the same for all");
  option("--seed", t.seed, "of first weights, batches and noise")->check(not_negative());
}

}  // namespace

void add_ablate(CLI::App& app, Job& job) {
  CLI::App* ablate = app.add_subcommand("ablate", "Compare a model with itself without each of its parts");
  ablate->require_subcommand(1);
  add_ablate_dvgan(*ablate, job);
  CLI::App* verb = ablate->add_subcommand(
      "attention",
      "Train the attention WGAN-GP, the same without attention, blend loss, skeleton loss, and the LSTM, "
      "each as "
      "long,\n"
      "and measure what they make of test clips: table.csv, angles.csv, angles.png and strips of poses in "
      "--save.\n"
      "Every variant has a folder of its name there. Ctrl-C saves and stops; the same command goes on, and "
      "trains nothing twice.");
  const auto args = std::make_shared<AblateArgs>();
  AblateArgs& a = *args;
  a.training.budget.minutes = 20;
  add_action_data_options(*verb, a.data, true);
  verb->add_option("--save", a.save, "folder of the comparison")->required()->type_name("DIR");
  std::string names;
  for (const AblationVariant& v : ablation_variants()) names += concat(names.empty() ? "" : ", ", v.name);
  verb->add_option("--variants", a.variants, "only these [all]: " + names)->delimiter(',')->type_name("A,B");
  verb->add_flag("--evaluate-only", a.evaluate_only, "train nothing; take the models that are there");
  add_training_options(*verb, a.training);
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb->add_option(name, member, text)->capture_default_str()->group("Evaluation");
  };
  option("--windows", a.evaluation.windows, "at most so many priors, all classes in turn")->check(positive());
  option("--future", a.evaluation.frames, "frames after each prior that are compared; the paper: 70")
      ->check(positive());
  option("--window-seed", a.evaluation.seed, "which windows")->check(not_negative());
  verb->add_option("--unit-metres", a.unit_metres,
                   "size of the clips' unit: lengths are given in metres (CMU 0.05644, Bandai-Namco 0.01)")
      ->check(positive())
      ->group("Evaluation");
  verb->callback([&job, args, verb] {
    default_procedural(*verb, args->data);
    job = [args, verb] { return run_ablation(*args, *verb); };
  });
}

}  // namespace motiongan::command
