// motiongan train attention: trains a model that continues a second of motion on labelled clips.
#include "motiongan/motion/position_rotations.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "shared/action_data.hpp"
#include "shared/shell.hpp"
#include "train/action_training.hpp"
#include "train/preset.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

/// The options that define a run. Its checkpoint stores them, so --resume needs none of them.
struct AttentionArgs {
  TrainingPreset preset = TrainingPreset::steady;
  ActionDataArgs data;
  ActionGanOptions model;
  AttentionTrainOptions training;
  RunArgs run;

  void list_fields(FieldList& list) {
    data.list_fields(list);
    model.list_fields(list);
    training.list_fields(list);
  }
};

/// Throws Error for options of adversarial training, which the baseline does not have.
void check_baseline(AttentionArgs& args, const CLI::App& verb) {
  FieldList all;
  args.model.list_fields(all);
  args.training.list_fields(all);
  BaselineTrainOptions baseline;
  const FieldList shared = fields_of(baseline);
  for (const Field& field : all) {
    const std::string& key = field.info.key;
    if (key == "generator" || key == "hidden" || shared.find(key) != nullptr) continue;
    const CLI::Option* const option = verb.get_option_no_throw(field.option());
    require(option == nullptr || option->count() == 0, field.option(),
            " does not apply to --model lstm: the baseline is trained without a critic");
  }
}

/// For --preview: two motions of each of the first classes, after the beginnings of clips.
Preview::Make preview_of(const Context& context, const motion::ActionDataset& data) {
  return [&](const io::SafeTensors& checkpoint) {
    const auto model = model_from<ActionGan>(context, checkpoint, "the run");
    std::vector<ActionPrior> priors;
    for (std::size_t i = 0; i < 2; ++i) priors.push_back(data.prior(data.train[i % data.train.size()], 0));
    std::vector<view::ViewedMotion> out;
    for (std::size_t c = 0; c < std::min(previewed, data.format.classes.size()); ++c)
      for (const motion::PositionClip& clip : model.generate(
               priors, ActionSchedule{{.label = c, .frames = 4 * data.format.frames}}, {.seed = 1}))
        out.push_back({data.format.classes[c], motion::motion_from_positions(clip), data.format.frames});
    return out;
  };
}

RunResult train_either(ActionGan& model, const motion::ActionDataset& data, AttentionArgs& args,
                       const RunStart& start) {
  const AttentionTrainOptions& t = args.training;
  const std::string resuming = start.done > 0 ? fmt::format("; resuming after iteration {}", start.done) : "";
  const auto write_split = [&](const fs::path& path) { data.write_split(path); };
  const std::string note = note_of(fields_of(args));
  if (model.is_baseline()) {
    fmt::print("{} iterations, batch {}{}\n", t.iterations, t.batch, resuming);
    fmt::print("Ctrl-C saves and stops. error: MSE of the {} generated frames, normalised\n",
               model.format().frames);
    BaselineTrainer trainer(model, data, AblationVariant::baseline_training(t));
    return run_shown(trainer, write_split, args.run, start, note, {{"error", "error"}}, "train attention",
                     preview_of(model.context(), data));
  }
  fmt::print("{} iterations of {} critic steps, a classifier step and {}, batch {}{}\n", t.iterations,
             t.critic_steps, counted(t.generator_steps, "generator step"), t.batch, resuming);
  fmt::print(
      "Ctrl-C saves and stops. W: Wasserstein estimate; gp: gradient penalty; adv, skel(eton), blend,\n"
      "class(ification): generator losses; clf, acc: loss and accuracy of the classifier; gamma: attention "
      "weight\n");
  AttentionTrainer trainer(model, data, t);
  return run_shown(trainer, write_split, args.run, start, note,
                   {{"wasserstein", "W"},
                    {"penalty", "gp"},
                    {"adversarial", "adv"},
                    {"skeleton", "skel"},
                    {"blend", "blend"},
                    {"classification", "class"},
                    {"classifier", "clf"},
                    {"accuracy", "acc"},
                    {"gamma", "gamma"}},
                   "train attention", preview_of(model.context(), data));
}

int train_attention(AttentionArgs args, const CLI::App& verb) {
  const RunStart start =
      begin_run(args.run, default_save(args.data.folder, "procedural-actions"),
                !args.data.folder.empty() || args.data.procedural > 0, verb,
                [&](const std::string& note, const fs::path& from) {
                  require(io::parse_object(note, from.string()).contains("--model"), from.string(),
                          ": this run trains a DVGAN; continue it with `train dvgan --resume`");
                  take_note(fields_of(args), verb, note, from, options_of_action_clips);
                });
  fill_in_choices(args.data);
  if (!args.run.resume) apply(args.preset, args.data.options, args.model, args.training, verb);
  args.model.seed = args.training.seed;
  if (args.model.generator == ActionGenerator::lstm) check_baseline(args, verb);
  args.training.adam.schedule.fix(args.training.iterations);
  if (is_done(start, args.run, args.training.iterations)) return 0;
  const RunFolder folder(args.run, start);

  const Context context;
  const motion::ActionDataset data = load_data(args.data);
  print_data(data, args.data);
  without_feet(args.training.body, data.format.skeleton(), verb);
  if (only_sized(context, data, args.model, args.training, args.run.dry_run,
                 args.training.iterations - start.done))
    return 0;
  ActionGan model(context, data.format, args.model);
  const double millions = 1e-6 * static_cast<double>(parameter_count(named_parameters(model)));
  print_fact("generator",
             fmt::format("{}, {} million parameters (width {}{})",
                         model.is_baseline()    ? "LSTM baseline"
                         : args.model.attention ? "convolutions and self-attention"
                                                : "convolutions without attention",
                         brief(millions, 3), args.model.hidden,
                         args.model.noise_dim > 0 ? fmt::format(", noise {}", args.model.noise_dim) : ""));
  print_fact("device", describe(context.device()));
  print_saved_to(start.folder, args.run.run.save_every_minutes);
  train_either(model, data, args, start);
  fmt::print("generate: {} generate {} --class {} --seconds 10\n", program(),
             shell_word(start.folder.string()), shell_quoted(data.format.classes.front()));
  return exit_status();
}

const Verb train_attention_verb{
    "train attention",
    [](CLI::App& train, Job& job) {
      CLI::App* verb = train.add_subcommand(
          "attention",
          "Train the attention WGAN-GP on labelled clips: it continues a second of motion in a given class.\n"
          "Writes generator, critic, classifier, checkpoint, log.csv and split.tsv to the --save folder. "
          "Ctrl-C\n"
          "saves and stops; --resume continues as if the run had never stopped, and needs only --save.");
      const auto args = std::make_shared<AttentionArgs>();
      AttentionArgs& a = *args;
      add_preset_option(*verb, a.preset, attention_presets);
      add_action_data_options(*verb, a.data, true);
      add_options(*verb, fields_of(a.model), "Model");
      add_options(*verb, fields_of(a.training), "Training");
      add_run_options(*verb, a.run, "save/NAME, where NAME is that of FOLDER", true);
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->data.procedural);
        job = [args, verb] { return train_attention(*args, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace
}  // namespace motiongan::command
