// motiongan evaluate model: compares a text-conditioned generator with the real motion of its test clips
// (Lin & Amer, Table 2, and current metrics).
#include "motiongan/experiments/model_evaluation.hpp"

#include "evaluate/evaluate_model.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "shared/cleaning.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/weights.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

struct EvaluateModelArgs : CaptionedDataArgs {
  std::string model, ranker, json;
  ModelEvaluationOptions evaluation;
  Weights weights;
  Cleaning cleaning;
};

/// How many of the test clips the run in `folder` was trained on, by its split.tsv; nothing if there is none.
std::optional<std::size_t> trained_on(const fs::path& folder, const motion::Dataset& data) {
  const fs::path split = RunFiles{folder}.split();
  if (!fs::is_regular_file(split)) return std::nullopt;
  std::set<std::string> trained;
  motion::for_each_tab_line(motion::read_text(split, "list of clips", motion::largest_list_file),
                            split.string(), "train or test <TAB> clip id", [&](const motion::TabLine& line) {
                              if (line.before == "train") trained.emplace(line.after);
                            });
  std::size_t count = 0;
  for (const motion::DatasetClip& clip : data.test) count += trained.count(clip.id);
  return count;
}

/// Warns of anything that distorts the figures.
void warn_of_data(const motion::Dataset& data, const Dvgan& model, const fs::path& model_folder,
                  const Ranker& ranker, const fs::path& ranker_folder) {
  const auto warn = [&](const std::string& text) { fmt::print(stderr, "motiongan: {}\n", text); };
  const std::size_t all = data.test.size();
  const auto seen = trained_on(model_folder, data), ranked = trained_on(ranker_folder, data);
  if (seen.value_or(0) > 0)
    warn(
        fmt::format("the model was trained on {} of the {}: its figures are too good (the clips or the split "
                    "are not those of its run)",
                    *seen, counted(all, "test clip")));
  if (!seen) warn("there is no split.tsv next to the model: it may have been trained on these clips");
  if (ranked.value_or(0) > 0)
    warn(fmt::format("the ranker was trained on {} of the {}: its figures for real motion are too good",
                     *ranked, counted(all, "test clip")));
  if (!ranked) warn("there is no split.tsv next to the ranker: it may have been trained on these clips");
  if (ranker.format().layout.root_position() && !model.format().layout.root_position())
    warn("the model generates no root position but the ranker uses one: it sees both sets stay in place");
  std::size_t strange = 0;
  for (const motion::DatasetClip& clip : data.test)
    for (const std::string& caption : clip.captions)
      strange += model.format().vocabulary.unknown_words(caption).empty() ? 0 : 1;
  if (strange > 0)
    warn(fmt::format("{} of the test clips have words that the model's training captions did not contain",
                     counted(strange, "caption")));
}

int run_evaluation(EvaluateModelArgs args, const CLI::App& verb) {
  const fs::path file = model_file(args.model), ranked_by = ranker_file(args.ranker);
  check_output("--json", args.json, json_output, {file, ranked_by, args.folder, args.data.captions});
  const fs::path checkpoint = RunFiles{file.parent_path()}.checkpoint();
  const Context context;
  const Dvgan model = load_with<Dvgan>(context, file, args.model, args.weights);
  const Ranker ranker = Ranker::load(context, ranked_by);
  const motion::MotionFormat& format = model.format();
  ranker.format().require_skeleton(format.skeleton(), "the model " + file.string());
  take_captioned_data(args, verb, checkpoint, file);
  // Windows have the model's format, whichever clips they come from.
  args.data.frames = format.frames;
  args.data.rate = format.rate;
  args.data.root_position = format.layout.root_position();
  args.data.root_rotation = format.layout.root_rotation();
  fill_in_data(args, format.layout.root_rotation());
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  format.require_skeleton(data.format.skeleton(), "the folder of clips");
  print_fact("ranker",
             fmt::format("{}, embedding of {} dimensions",
                         ranker.options().kind == RankerKind::cnn ? "CNN" : "RNN", ranker.options().hidden));
  print_fact("device", describe(context.device()));
  warn_of_data(data, model, file.parent_path(), ranker, ranked_by.parent_path());

  args.cleaning.options.unit_metres = args.evaluation.feet.unit_metres;
  args.cleaning.options.foot_joints = args.evaluation.feet.feet;
  if (args.cleaning.on())
    args.evaluation.finish = [&](motion::Motion motion) { return args.cleaning.apply(std::move(motion)); };
  const RealEvaluation real = evaluate_real(ranker, data, args.evaluation);
  print_fact("choices",
             fmt::format("K = {} of {}, {} generated and {} real motions of each",
                         counted(real.descriptions.size(), "distinct description"),
                         counted(real.clips, "test clip"), args.evaluation.samples, args.evaluation.samples));
  const ModelEvaluation made = evaluate_model(model, ranker, real, args.evaluation);
  fmt::print("\n");
  print_model_evaluation(model.is_recurrent() ? "rnn" : "cnn", made, real, args.evaluation);
  if (!args.json.empty()) {
    make_folder_of(args.json);
    motion::write_text_atomically(args.json, model_evaluation_json(made, real).dump(2) + "\n");
    fmt::print("wrote {}\n", shown(args.json));
  }
  return 0;
}

const Verb evaluate_model_verb{
    "evaluate model", [](CLI::App& evaluate, Job& job) {
      CLI::App* verb =
          evaluate.add_subcommand("model",
                                  "Evaluate a text-conditioned generator on the descriptions of its "
                                  "test clips, next to real motion: inception\n"
                                  "score and retrieval (Lin & Amer, Table 2), FID, diversity, "
                                  "multimodality, foot skating, jerk, bones, drift.");
      const auto args = std::make_shared<EvaluateModelArgs>();
      EvaluateModelArgs& a = *args;
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text)->capture_default_str();
      };
      verb->add_option("MODEL", a.model, model_help)->required()->type_name("");
      add_test_clip_options(*verb, a);
      verb->add_option("--ranker", a.ranker, "folder of a `train ranker` run, or a ranker file")
          ->required()
          ->type_name("RANKER");
      option("--descriptions", a.evaluation.descriptions, "K: at most this many, the most frequent ones")
          ->check(positive());
      option("--samples", a.evaluation.samples, "motions of each description, generated and real")
          ->check(CLI::Range(std::size_t{2}, std::size_t{1000000}))
          ->type_name("N");
      option("--seed", a.evaluation.seed, "seed of the generated motions")->check(not_negative());
      option("--drift-seconds", a.evaluation.drift_seconds,
             "length of the motions that drift is measured on (RNN generators only); 0: no drift")
          ->check(not_negative());
      add_quality_options(*verb, a.evaluation.feet);
      add_weights_option(*verb, a.weights);
      add_clean_choice(*verb, a.cleaning);
      verb->add_option("--json", a.json, "also write all results as JSON")->type_name("FILE");
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->procedural);
        job = [args, verb] { return run_evaluation(*args, *verb); };
      });
    }};

}  // namespace

}  // namespace motiongan::command
