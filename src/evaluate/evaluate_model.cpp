// motiongan evaluate model: what a text-conditioned generator makes, beside the real motion of its test clips
// (the paper's Table 2), and by the measures of today.
#include "motiongan/experiments/model_evaluation.hpp"

#include "evaluate/evaluate_model.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "shared/prompt.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

struct EvaluateModelArgs : CaptionedDataArgs {
  std::string model, ranker, json;
  ModelEvaluationOptions evaluation;
};

/// How many of the data set's test clips the run in `folder` was trained on, by its list of the split;
/// nothing where there is no list.
std::optional<std::size_t> trained_on(const fs::path& folder, const motion::Dataset& data) {
  const fs::path split = RunFiles{folder}.split();
  if (!fs::is_regular_file(split)) return std::nullopt;
  std::set<std::string> trained;
  motion::for_each_tab_line(motion::read_text(split, "list of clips"), split.string(),
                            "train or test <TAB> clip id", [&](const motion::TabLine& line) {
                              if (line.before == "train") trained.emplace(line.after);
                            });
  std::size_t count = 0;
  for (const motion::DatasetClip& clip : data.test) count += trained.count(clip.id);
  return count;
}

/// Warns of what makes the figures other than they seem.
void warn_of_data(const motion::Dataset& data, const Dvgan& model, const fs::path& model_folder,
                  const Ranker& ranker, const fs::path& ranker_folder) {
  const auto warn = [&](const std::string& text) { fmt::print(stderr, "motiongan: {}\n", text); };
  const std::size_t all = data.test.size();
  const auto seen = trained_on(model_folder, data), ranked = trained_on(ranker_folder, data);
  if (seen.value_or(0) > 0)
    warn(
        fmt::format("the model was trained on {} of the {}: they are not new to it (other clips or another "
                    "split than its run's)",
                    *seen, counted(all, "test clip")));
  if (!seen) warn("there is no split.tsv beside the model: clips that it was trained on may be among these");
  if (ranked.value_or(0) > 0)
    warn(fmt::format("the ranker was trained on {} of the {}: what it says of the real motion is too good",
                     *ranked, counted(all, "test clip")));
  if (!ranked) warn("there is no split.tsv beside the ranker: it may have been trained on these clips");
  if (ranker.format().layout.root_position() && !model.format().layout.root_position())
    warn("the model makes no root position and the ranker looks at one: both sets stand still for it");
  std::size_t strange = 0;
  for (const motion::DatasetClip& clip : data.test)
    for (const std::string& caption : clip.captions)
      strange += model.format().vocabulary.unknown_words(caption).empty() ? 0 : 1;
  if (strange > 0)
    warn(fmt::format("{} of the test clips have words that no training caption of the model had",
                     counted(strange, "caption")));
}

int run_evaluation(EvaluateModelArgs args, const CLI::App& verb) {
  const fs::path file = model_file(args.model), ranked_by = ranker_file(args.ranker);
  const fs::path checkpoint = RunFiles{file.parent_path()}.checkpoint();
  const Context context;
  const Dvgan model = Dvgan::load(context, file);
  const Ranker ranker = Ranker::load(context, ranked_by);
  const motion::MotionFormat& format = model.format();
  ranker.format().require_skeleton(format.skeleton(), "the model " + file.string());
  take_captioned_data(args, verb, checkpoint, file);
  // Windows are the model's, wherever they are from.
  args.data.frames = format.frames;
  args.data.rate = format.rate;
  args.data.root_position = format.layout.root_position();
  args.data.root_rotation = format.layout.root_rotation();
  fill_in_data(args, format.layout.root_rotation());
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  format.require_skeleton(data.format.skeleton(), "the folder of clips");
  print_fact("ranker",
             fmt::format("{}, {} numbers an embedding",
                         ranker.options().kind == RankerKind::cnn ? "CNN" : "RNN", ranker.options().hidden));
  print_fact("device", describe(context.device()));
  warn_of_data(data, model, file.parent_path(), ranker, ranked_by.parent_path());

  const RealEvaluation real = evaluate_real(ranker, data, args.evaluation);
  print_fact("choices",
             fmt::format("K = {} of {}, {} made and {} real motions of each",
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

const Verb evaluate_model_verb{"evaluate model", [](CLI::App& evaluate, Job& job) {
  CLI::App* verb = evaluate.add_subcommand("model",
                                           "A text-conditioned generator on the descriptions of its test "
                                           "clips: inception score and retrieval (the\n"
                                           "paper's Table 2), FID, diversity, multimodality, foot skating, "
                                           "jerk, bones, drift; real motion beside.");
  const auto args = std::make_shared<EvaluateModelArgs>();
  EvaluateModelArgs& a = *args;
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb->add_option(name, member, text)->capture_default_str();
  };
  verb->add_option("MODEL", a.model, "model file, or the --save folder of a training")
      ->required()
      ->type_name("");
  add_test_clip_options(*verb, a);
  verb->add_option("--ranker", a.ranker, "folder of a run of `train ranker`, or a ranker's file")
      ->required()
      ->type_name("RANKER");
  option("--descriptions", a.evaluation.descriptions, "K: the most popular ones, at most")->check(positive());
  option("--samples", a.evaluation.samples, "motions of each description, made and real")
      ->check(CLI::Range(std::size_t{2}, std::size_t{1000000}))
      ->type_name("N");
  option("--seed", a.evaluation.seed, "of the motions made")->check(not_negative());
  option("--drift-seconds", a.evaluation.drift_seconds,
         "length of the motions that drift is measured on; 0: none. RNN generators only")
      ->check(not_negative());
  add_quality_options(*verb, a.evaluation.feet);
  verb->add_option("--json", a.json, "write all of it to a file")->type_name("FILE");
  verb->callback([&job, args, verb] {
    fill_in_procedural(*verb, args->procedural);
    job = [args, verb] { return run_evaluation(*args, *verb); };
  });
}};

}  // namespace

}  // namespace motiongan::command
