// motiongan train ranker: trains a ranker, which scores how well a description fits a motion.
#include "shared/shell.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

struct TrainRankerArgs : RankerArgs {
  RunArgs run;
};

int train_ranker(TrainRankerArgs args, const CLI::App& verb) {
  RankerArgs& kept = args;
  const fs::path save = args.folder.empty() ? fs::path("save/procedural-ranker")
                                            : fs::path(default_save(args.folder, "").string() + "-ranker");
  const RunStart start = begin_run(args.run, save, !args.folder.empty() || args.procedural > 0, verb,
                                   [&](const std::string& note, const fs::path& from) {
                                     take_note(fields_of(kept), verb, note, from, options_of_captioned_clips);
                                   });
  fill_in_choices(args);
  if (is_done(start, args.run, args.training.iterations)) return 0;
  const RunFolder folder(args.run, start);

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  const motion::Descriptions descriptions = motion::distinct_descriptions(data.train);
  print_fact("choices", fmt::format("{} of the training clips, {} per step (more if its clips have more)",
                                    counted(descriptions.size(), "distinct description"),
                                    std::min(args.training.descriptions, descriptions.size())));
  if (only_sized(context, args.training, size_options(args.training.batch, args.model.hidden),
                 args.run.dry_run, args.training.iterations - start.done, builder(data, args.model)))
    return 0;
  Ranker ranker(context, data.format, args.model);
  const double millions = 1e-6 * static_cast<double>(parameter_count(named_parameters(ranker)));
  print_fact("ranker", fmt::format("{}, {} million parameters (width {})",
                                   args.model.kind == RankerKind::cnn ? "CNN" : "RNN", brief(millions, 3),
                                   args.model.hidden));
  print_fact("device", describe(context.device()));
  print_saved_to(start.folder, args.run.run.save_every_minutes);
  fmt::print("{} iterations, batch {}{}. Ctrl-C saves and stops.\n", args.training.iterations,
             args.training.batch,
             start.done > 0 ? fmt::format("; resuming after iteration {}", start.done) : "");

  RankerTrainer trainer(ranker, data, args.training);
  run_shown(
      trainer, [&](const fs::path& path) { data.write_split(path); }, args.run, start,
      note_of(fields_of(kept)), {{"loss", "loss"}, {"recall1", "R@1"}}, "train ranker");
  fmt::print("evaluate: {} evaluate ranker {}\n", program(), shell_word(start.folder.string()));
  return exit_status();
}

const Verb train_ranker_verb{
    "train ranker",
    [](CLI::App& train, Job& job) {
      CLI::App* verb = train.add_subcommand(
          "ranker",
          "Train a ranker, which scores how well a description fits a motion and is used to evaluate "
          "DVGANs.\n"
          "Writes ranker, checkpoint, log.csv and split.tsv to the --save folder. Ctrl-C saves and stops; "
          "--resume\ncontinues as if the run had never stopped, and needs only --save.");
      const auto args = std::make_shared<TrainRankerArgs>();
      TrainRankerArgs& a = *args;
      add_captioned_data_options(*verb, a);
      add_options(*verb, fields_of(a.model), "Model");
      add_options(*verb, fields_of(a.training), "Training");
      add_run_options(*verb, a.run, "save/NAME-ranker, where NAME is that of FOLDER", false);
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->procedural);
        job = [args, verb] { return train_ranker(*args, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace
}  // namespace motiongan::command
