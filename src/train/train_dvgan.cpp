// motiongan train dvgan: from clips and captions to a model.
#include "motiongan/train/progress.hpp"
#include "train/run_start.hpp"
#include "train/training.hpp"
#include "train/training_options.hpp"

namespace motiongan::command {
namespace {

int run_training(TrainArgs args, const CLI::App& verb) {
  choose_defaults(args, verb.count("--final-cut") > 0);  // a run that is resumed has its own
  const auto take = [&](const std::string& note, const fs::path& from) {
    take_from_note(args, verb, note, from);
  };
  const auto [folder, done] = begin_run(
      {.folder = args.folder, .save = args.save, .procedural = args.procedural, .resume = args.resume}, verb,
      take);
  fill_in_choices(args);
  if (args.resume && done >= args.training.iterations) {
    fmt::print("{} has all its {} already; --iterations N asks for more\n", folder.string(),
               counted(done, "iteration"));
    return 0;
  }
  make_folder(folder);

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  Dvgan model(context, data.format, args.model);
  print_model(model);
  print_fact("saved to", fmt::format("{}, every {} and at the end", folder.string(),
                                     duration(args.run.save_every_minutes * 60)));
  fmt::print("{} iterations of {} critic steps and a generator step, batch {}{}\n", args.training.iterations,
             args.training.critic_steps, args.training.batch,
             done > 0 ? fmt::format("; resuming after iteration {}", done) : "");
  fmt::print("Ctrl-C saves and stops. The Wasserstein estimate should rise quickly, then fall slowly.\n");

  ProgressBar bar;
  bar.start(args.training.iterations, done);
  RunOptions run = args.run;
  run.save_dir = folder;
  run.resume = args.resume;
  run.notes = {{"options", options_as_note(args)}};
  run.should_stop = [] { return caught_signal() != 0; };
  run.report = [&](std::size_t iteration, const DvganLosses& losses) {
    bar.update(iteration, {{"wasserstein", losses.wasserstein}, {"penalty", losses.penalty}});
  };
  catch_signals();
  const RunResult result = train(model, data, args.training, run);
  bar.finish();
  fmt::print("{} after {} of {} iterations; saved in {}\n", result.stopped ? "stopped" : "finished",
             result.iterations, args.training.iterations, folder.string());
  if (result.stopped) fmt::print("continue: {} train dvgan --resume --save {}\n", program(), folder.string());
  fmt::print("generate: {} generate {} --text \"{}\"\n", program(), folder.string(),
             data.train.front().captions.front());
  return caught_signal() != 0 ? 128 + caught_signal() : 0;
}

}  // namespace

void add_train_dvgan(CLI::App& train, Job& job) {
  CLI::App* verb = train.add_subcommand(
      "dvgan",
      "Train a DVGAN (text to motion) on a folder of BVH clips.\n"
      "Writes generator, critic, checkpoint, log.csv and split.tsv to the --save folder. Ctrl-C saves and "
      "stops;\n"
      "--resume continues as if the run had never stopped, and needs no option but --save.");
  const auto args = std::make_shared<TrainArgs>();
  TrainArgs& a = *args;
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb->add_option(name, member, text)->capture_default_str();
  };
  add_captioned_data_options(*verb, a);
  verb->add_option("--save", a.save, "folder of the run [save/NAME, NAME being the folder's]")
      ->type_name("DIR");
  verb->add_flag("--resume", a.resume,
                 "continue the run in --save; its options are those of its first start");

  option("--generator", a.generator,
         "cnn: a window at once, coarse to fine; rnn: frame by frame, for as long as one likes")
      ->check(CLI::IsMember({"cnn", "rnn"}))
      ->group("Model");
  option("--critic", a.critic, "cnn: judges every time scale; rnn: poses and their changes")
      ->check(CLI::IsMember({"cnn", "rnn"}))
      ->group("Model");
  verb->add_flag("--final-cut,!--no-final-cut", a.final_cut,
                 "generate twice the frames and cut [on for the CNN generator]")
      ->group("Model");
  option("--validation", a.validation, "time scales that the critic judges: all, every second, the last")
      ->check(CLI::IsMember({"dense", "mod2", "final"}))
      ->group("Model");
  add_shared_dvgan_options(*verb, a);
  option("--iterations", a.training.iterations, "how long to train")->check(positive())->group("Training");
  verb->add_flag("--shift,!--no-shift", a.training.input_shift,
                 "shift motions in time before the critic [on]")
      ->group("Training");
  option("--completions", a.training.completion_share,
         "share of the steps in which the RNN generator goes on from real first frames; the paper: 0")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("SHARE")
      ->group("Training");
  option("--seed", a.training.seed, "of first weights, batches and noise")
      ->check(not_negative())
      ->group("Training");

  add_run_options(*verb, a.run);
  verb->callback([&job, args, verb] {
    fill_in_procedural(*verb, *args);
    job = [args, verb] { return run_training(*args, *verb); };
  });
}

}  // namespace motiongan::command
