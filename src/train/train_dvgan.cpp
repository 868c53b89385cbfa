// motiongan train dvgan: trains a text-to-motion model on captioned clips.
#include "motiongan/data/descriptions.hpp"
#include "shared/shell.hpp"
#include "train/preset.hpp"

namespace motiongan::command {
namespace {

struct TrainDvganArgs : DvganArgs {
  RunArgs run;
  TrainingPreset preset = TrainingPreset::steady;
};

int train_dvgan(TrainDvganArgs args, const CLI::App& verb) {
  DvganArgs& kept = args;
  const RunStart start = begin_run(args.run, default_save(args.folder, "procedural"),
                                   !args.folder.empty() || args.procedural > 0, verb,
                                   [&](const std::string& note, const fs::path& from) {
                                     take_note(fields_of(kept), verb, note, from, options_of_captioned_clips);
                                   });
  if (!args.run.resume) apply(args.preset, args, verb);
  fill_in_choices(args);
  if (is_done(start, args.run, args.training.iterations)) return 0;
  const RunFolder folder(args.run, start);

  const Context context;
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  without_feet(args.training.body, data.format.skeleton(), verb);
  if (only_sized(context, args.training, size_options(args.training.batch, args.model.hidden),
                 args.run.dry_run, args.training.iterations - start.done, builder(data, args.model)))
    return 0;
  Dvgan model(context, data.format, args.model);
  print_model(model);
  print_saved_to(start.folder, args.run.run.save_every_minutes);
  fmt::print("{} iterations of {} critic steps and a generator step, batch {}{}\n", args.training.iterations,
             args.training.critic_steps, args.training.batch,
             start.done > 0 ? fmt::format("; resuming after iteration {}", start.done) : "");
  fmt::print("Ctrl-C saves and stops. The Wasserstein estimate should rise quickly, then fall slowly.\n");

  const motion::Descriptions prompts = motion::distinct_descriptions(data.train).most_popular(previewed);
  DvganTrainer trainer(model, data, args.training);
  run_shown(
      trainer, [&](const fs::path& path) { data.write_split(path); }, args.run, start,
      note_of(fields_of(kept)), {{"wasserstein", "wasserstein"}, {"penalty", "penalty"}}, "train dvgan",
      [&](const io::SafeTensors& checkpoint) {
        const auto now = model_from<Dvgan>(context, checkpoint, "the run");
        std::vector<view::ViewedMotion> out;
        for (const std::string& text : prompts.texts)
          for (motion::Motion& motion : now.generate(text, {.count = 2, .seed = 1}))
            out.push_back({text, std::move(motion)});
        return out;
      });
  fmt::print("generate: {} generate {} --text {}\n", program(), shell_word(start.folder.string()),
             shell_quoted(data.train.front().captions.front()));
  return exit_status();
}

const Verb train_dvgan_verb{
    "train dvgan",
    [](CLI::App& train, Job& job) {
      CLI::App* verb =
          train.add_subcommand("dvgan",
                               "Train a DVGAN (text to motion) on a folder of BVH clips with captions.\n"
                               "Writes generator, critic, checkpoint, log.csv and split.tsv to the --save "
                               "folder. Ctrl-C saves and "
                               "stops;\n"
                               "--resume continues as if the run had never stopped, and needs only --save.");
      const auto args = std::make_shared<TrainDvganArgs>();
      TrainDvganArgs& a = *args;
      add_captioned_data_options(*verb, a);
      add_options(*verb, fields_of(a.model), "Model");
      add_options(*verb, fields_of(a.training), "Training");
      add_preset_option(*verb, args->preset, dvgan_presets);
      add_run_options(*verb, a.run, "save/NAME, where NAME is that of FOLDER", true);
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->procedural);
        job = [args, verb] { return train_dvgan(*args, *verb); };
      });
    },
    Verb::Runs::on_ranks};

}  // namespace
}  // namespace motiongan::command
