// motiongan train attention: from clips with classes to a model that goes on from a second of motion.
#include "motiongan/train/train_attention.hpp"
#include "action_data.hpp"
#include "motiongan/train/progress.hpp"
#include "train/run_start.hpp"
#include "signals.hpp"
#include "train/training_options.hpp"

namespace motiongan::command {
namespace {

struct AttentionArgs {
  // What a run is. Kept in its checkpoint, so that --resume needs none of it.
  ActionDataArgs data;
  std::string network = "attention";
  ActionGanOptions model;
  AttentionTrainOptions training;
  // What only this start of it is.
  std::string save;
  bool resume = false;
  AttentionRunOptions run;
};

/// Options of the training against a critic, which the baseline does not have.
template <class F>
void each_of_critic(AttentionArgs& a, F&& f) {
  f("--noise", a.model.noise_dim);
  f("--attention", a.model.attention);
  f("--critic-steps", a.training.critic_steps);
  f("--generator-steps", a.training.generator_steps);
  f("--rollouts", a.training.rollouts);
  f("--lambda", a.training.lambda_gp);
  f("--weight-clip", a.training.weight_clip);
  f("--skeleton-weight", a.training.skeleton_weight);
  f("--blend-weight", a.training.blend_weight);
  f("--class-weight", a.training.class_weight);
  f("--skeleton-vectors", a.training.skeleton_vectors);
  f("--critic-classes", a.training.critic_classes);
}

template <class F>
void each_kept(AttentionArgs& a, F&& f) {
  each_kept(a.data, f);
  f("--model", a.network);
  f("--hidden", a.model.hidden);
  f("--iterations", a.training.iterations);
  f("--batch", a.training.batch);
  f("--balanced", a.training.balanced);
  f("--learning-rate", a.training.adam.learning_rate);
  f("--beta1", a.training.adam.beta1);
  f("--beta2", a.training.adam.beta2);
  f("--epsilon", a.training.adam.epsilon);
  f("--seed", a.training.seed);
  each_of_critic(a, f);
}

void check_baseline(AttentionArgs& args, const CLI::App& verb) {
  each_of_critic(args, [&](const char* name, const auto&) {
    require(verb.count(name) == 0, name,
            " is not for --model lstm: the baseline learns to copy, without a critic");
  });
}

/// What the losses are called where there is little room; one for each column of the log.
const char* short_name(std::string_view column) {
  return column == "wasserstein"      ? "W"
         : column == "penalty"        ? "gp"
         : column == "adversarial"    ? "adv"
         : column == "skeleton"       ? "skel"
         : column == "classification" ? "class"
         : column == "classifier"     ? "clf"
         : column == "accuracy"       ? "acc"
         : column == "blend"          ? "blend"
         : column == "gamma"          ? "gamma"
                                      : "error";
}

/// Trains with either kind of losses.
template <class Losses, class Options>
RunResult train_with(ActionGan& model, const motion::ActionDataset& data, const Options& options,
                     AttentionArgs& args, const RunStart& start) {
  ProgressBar bar;
  bar.start(options.iterations, start.done);
  BasicRunOptions<Losses> run;
  run.save_dir = start.folder;
  run.resume = args.resume;
  run.save_every_minutes = args.run.save_every_minutes;
  run.log_every = args.run.log_every;
  run.max_minutes = args.run.max_minutes;
  run.notes = {{"options", note_of([&](const auto& f) { each_kept(args, f); })}};
  run.should_stop = [] { return caught_signal() != 0; };
  run.report = [&](std::size_t iteration, const Losses& losses) {
    std::vector<NamedValue> values;
    for (const auto& [name, value] : columns(losses)) values.emplace_back(short_name(name), value);
    bar.update(iteration, values);
  };
  catch_signals();
  const RunResult result = train(model, data, options, run);
  bar.finish();
  return result;
}

RunResult train_either(ActionGan& model, const motion::ActionDataset& data, AttentionArgs& args,
                       const RunStart& start) {
  const AttentionTrainOptions& t = args.training;
  const std::string resuming = start.done > 0 ? fmt::format("; resuming after iteration {}", start.done) : "";
  if (model.is_baseline()) {
    fmt::print("{} iterations, batch {}{}\n", t.iterations, t.batch, resuming);
    fmt::print("Ctrl-C saves and stops. error: mean square of what is wrong with the {} frames made\n",
               model.format().frames);
    return train_with<BaselineLosses>(model, data,
                                      BaselineTrainOptions{.iterations = t.iterations,
                                                           .batch = t.batch,
                                                           .balanced = t.balanced,
                                                           .adam = t.adam,
                                                           .seed = t.seed},
                                      args, start);
  }
  fmt::print("{} iterations of {} critic steps, a classifier step and {}, batch {}{}\n", t.iterations,
             t.critic_steps, counted(t.generator_steps, "generator step"), t.batch, resuming);
  fmt::print(
      "Ctrl-C saves and stops. W: Wasserstein estimate; gp: gradient penalty; of the generator: adv, "
      "skel(eton),\n"
      "blend, class(ification); clf: the classifier's own loss; acc: share that it gets right; gamma: of "
      "attention\n");
  return train_with<AttentionLosses>(model, data, t, args, start);
}

int run_training(AttentionArgs args, const CLI::App& verb) {
  const RunStart start =
      begin_run({.folder = args.data.folder,
                 .save = args.save,
                 .procedural = args.data.procedural,
                 .resume = args.resume,
                 .builtin = "procedural-actions"},
                verb, [&](const std::string& note, const fs::path& from) {
                  require(nlohmann::json::parse(note, nullptr, false).contains("--model"), from.string(),
                          ": this run trains a DVGAN; continue it with `train dvgan --resume`");
                  take_note([&](const auto& f) { each_kept(args, f); }, verb, note, from, describes_clips);
                });
  fill_in_choices(args.data);
  args.model.seed = args.training.seed;
  if (args.network == "lstm") {
    check_baseline(args, verb);
    args.model.generator = ActionGenerator::lstm;
  }
  if (args.resume && start.done >= args.training.iterations) {
    fmt::print("{} has all its {} already; --iterations N asks for more\n", start.folder.string(),
               counted(start.done, "iteration"));
    return 0;
  }
  make_folder(start.folder);

  const Context context;
  const motion::ActionDataset data = load_data(args.data);
  print_data(data, args.data);
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
  print_fact("saved to", fmt::format("{}, every {} and at the end", start.folder.string(),
                                     duration(args.run.save_every_minutes * 60)));
  const RunResult result = train_either(model, data, args, start);
  const std::string folder = start.folder.string();
  fmt::print("{} after {} of {} iterations; saved in {}\n", result.stopped ? "stopped" : "finished",
             result.iterations, args.training.iterations, folder);
  if (result.stopped) fmt::print("continue: {} train attention --resume --save {}\n", program(), folder);
  fmt::print("generate: {} generate {} --class '{}' --seconds 10\n", program(), folder,
             data.format.classes.front());
  return caught_signal() != 0 ? 128 + caught_signal() : 0;
}

void add_model_options(CLI::App& verb, AttentionArgs& a) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group("Model");
  };
  option("--model", a.network, "attention: a second at once, against a critic; lstm: the paper's baseline")
      ->check(CLI::IsMember({"attention", "lstm"}));
  verb.add_flag("--attention,!--no-attention", a.model.attention, "self-attention in all networks [on]")
      ->group("Model");
  option("--hidden", a.model.hidden, "width of the networks")->check(positive());
  option("--noise", a.model.noise_dim, "numbers of noise beside the class; the paper: 0")
      ->check(not_negative());
  verb.add_flag("--critic-classes", a.training.critic_classes, "tell the critic the class [off]")
      ->group("Model");
}

void add_training_options(CLI::App& verb, AttentionArgs& a) {
  AttentionTrainOptions& t = a.training;
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->capture_default_str()->group("Training");
  };
  option("--iterations", t.iterations, "how long to train")->check(positive());
  option("--critic-steps", t.critic_steps, "in each iteration")->check(positive());
  option("--generator-steps", t.generator_steps, "in each iteration")->check(positive());
  option("--batch", t.batch, "windows in a step")->check(positive());
  option("--rollouts", t.rollouts, "how many times the generator goes on from its own output")
      ->check(positive());
  option("--lambda", t.lambda_gp, "weight of the gradient penalty")->check(not_negative());
  option("--weight-clip", t.weight_clip, "above 0: clip the critic's weights there, instead of the penalty")
      ->check(not_negative());
  option("--skeleton-weight", t.skeleton_weight, "of the loss of bone lengths; 0: without")
      ->check(not_negative());
  option("--blend-weight", t.blend_weight, "of the loss at the seam; 0: without")->check(not_negative());
  option("--class-weight", t.class_weight, "of the classification loss; 0: without")->check(not_negative());
  verb.add_flag("--skeleton-vectors", t.skeleton_vectors, "compare bone vectors, not their lengths [off]")
      ->group("Training");
  verb.add_flag("--balanced,!--no-balanced", t.balanced,
                "draw all classes alike, however many clips they have [on]")
      ->group("Training");
  add_adam_options(verb, t.adam, ", of all networks", "Training");
  option("--seed", t.seed, "of first weights, batches and noise")->check(not_negative());
}

}  // namespace

void add_train_attention(CLI::App& train, Job& job) {
  CLI::App* verb = train.add_subcommand(
      "attention",
      "Train the attention WGAN-GP (a second of motion and a class to the next second) on clips with "
      "classes.\n"
      "Writes generator, critic, classifier, checkpoint, log.csv and split.tsv to the --save folder. Ctrl-C "
      "saves and\n"
      "stops; --resume continues as if the run had never stopped, and needs no option but --save.");
  const auto args = std::make_shared<AttentionArgs>();
  AttentionArgs& a = *args;
  add_action_data_options(*verb, a.data, true);
  verb->add_option("--save", a.save, "folder of the run [save/NAME, NAME being the folder's]")
      ->type_name("DIR");
  verb->add_flag("--resume", a.resume,
                 "continue the run in --save; its options are those of its first start");
  add_model_options(*verb, a);
  add_training_options(*verb, a);
  add_run_options(*verb, a.run);
  verb->callback([&job, args, verb] {
    default_procedural(*verb, args->data);
    job = [args, verb] { return run_training(*args, *verb); };
  });
}

}  // namespace motiongan::command
