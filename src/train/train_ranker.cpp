// motiongan train ranker: which description fits a motion.
#include "motiongan/train/progress.hpp"
#include "motiongan/train/ranker_trainer.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"
#include "signals.hpp"
#include "train/training_options.hpp"

namespace motiongan::command {
namespace {

int run_training(RankerArgs args, const CLI::App& verb) {
  const auto take = [&](const std::string& note, const fs::path& from) {
    take_note([&](const auto& f) { each_kept(args, f); }, verb, note, from, describes_captioned_clips);
  };
  if (args.save.empty() && !args.folder.empty())
    args.save = default_save(args.folder, "ranker").string() + "-ranker";
  const auto [folder, done] = begin_run({.folder = args.folder,
                                         .save = args.save,
                                         .procedural = args.procedural,
                                         .resume = args.resume,
                                         .builtin = "procedural-ranker"},
                                        verb, take);
  fill_in(args);
  if (args.resume && done >= args.training.iterations) {
    fmt::print("{} has all its {} already; --iterations N asks for more\n", folder.string(),
               counted(done, "iteration"));
    return 0;
  }
  make_folder(folder);

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  const motion::Descriptions descriptions = motion::distinct_descriptions(data.train);
  print_fact("choices", fmt::format("{} of the training clips, {} in a step (or as many as its clips have)",
                                    counted(descriptions.size(), "distinct description"),
                                    std::min(args.training.descriptions, descriptions.size())));
  Ranker ranker(context, data.format, args.model);
  const double millions = 1e-6 * static_cast<double>(parameter_count(named_parameters(ranker)));
  print_fact("ranker", fmt::format("{}, {} million parameters (width {})", args.kind == "cnn" ? "CNN" : "RNN",
                                   brief(millions, 3), args.model.hidden));
  print_fact("device", describe(context.device()));
  print_fact("saved to", fmt::format("{}, every {} and at the end", folder.string(),
                                     duration(args.run.save_every_minutes * 60)));
  fmt::print("{} iterations, batch {}{}. Ctrl-C saves and stops.\n", args.training.iterations,
             args.training.batch, done > 0 ? fmt::format("; resuming after iteration {}", done) : "");

  ProgressBar bar;
  bar.start(args.training.iterations, done);
  RankerRunOptions run = args.run;
  run.save_dir = folder;
  run.resume = args.resume;
  run.notes = {{"options", note_of([&](const auto& f) { each_kept(args, f); })}};
  run.should_stop = [] { return caught_signal() != 0; };
  run.report = [&](std::size_t iteration, const RankerLosses& losses) {
    bar.update(iteration, {{"loss", losses.loss}, {"R@1", 100 * losses.recall1}});
  };
  catch_signals();
  const RunResult result = train(ranker, data, args.training, run);
  bar.finish();
  fmt::print("{} after {} of {} iterations; saved in {}\n", result.stopped ? "stopped" : "finished",
             result.iterations, args.training.iterations, folder.string());
  if (result.stopped)
    fmt::print("continue: {} train ranker --resume --save {}\n", program(), folder.string());
  fmt::print("measure: {} evaluate ranker {}\n", program(), folder.string());
  return caught_signal() != 0 ? 128 + caught_signal() : 0;
}

}  // namespace

void add_train_ranker(CLI::App& train, Job& job) {
  CLI::App* verb = train.add_subcommand(
      "ranker",
      "Train a ranker: how well a description fits a motion. What a DVGAN is measured by.\n"
      "Writes ranker, checkpoint, log.csv and split.tsv to the --save folder. Ctrl-C saves and stops; "
      "--resume\ncontinues as if the run had never stopped, and needs no option but --save.");
  const auto args = std::make_shared<RankerArgs>();
  RankerArgs& a = *args;
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb->add_option(name, member, text)->capture_default_str();
  };
  add_captioned_data_options(*verb, a);
  verb->add_option("--save", a.save, "folder of the run [save/NAME-ranker, NAME being the folder's]")
      ->type_name("DIR");
  verb->add_flag("--resume", a.resume,
                 "continue the run in --save; its options are those of its first start");
  option("--ranker", a.kind, "rnn: mean pose and mean motion; cnn: the CNN critic's trunk")
      ->check(CLI::IsMember({"cnn", "rnn"}))
      ->group("Model");
  option("--hidden", a.model.hidden, "width of the network, and of the embedding")
      ->check(positive())
      ->group("Model");
  option("--taps", a.model.taps, "of the CNN's convolutions")->check(CLI::IsMember({3, 5}))->group("Model");
  RankerTrainOptions& t = a.training;
  option("--iterations", t.iterations, "how long to train")->check(positive())->group("Training");
  option("--batch", t.batch, "motions in a step")->check(positive())->group("Training");
  option("--descriptions", t.descriptions, "to choose among in a step, at most")
      ->check(positive())
      ->group("Training");
  add_adam_options(*verb, t.adam, "", "Training");
  option("--seed", t.seed, "of first weights and batches")->check(not_negative())->group("Training");
  add_run_options(*verb, a.run);
  verb->callback([&job, args, verb] {
    fill_in_procedural(*verb, *args);
    job = [args, verb] { return run_training(*args, *verb); };
  });
}

}  // namespace motiongan::command
