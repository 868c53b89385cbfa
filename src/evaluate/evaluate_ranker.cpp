// motiongan evaluate ranker: how often a ranker finds the description of a held-out clip.
#include "motiongan/experiments/paper_tables.hpp"
#include "motiongan/experiments/ranker_evaluation.hpp"
#include "motiongan/formats/text_file.hpp"
#include "shared/outputs.hpp"
#include "train/ranking.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {
namespace {

struct EvaluateRankerArgs : CaptionedDataArgs {
  std::string ranker, json;
  RankerEvaluationOptions evaluation;
  std::size_t breakdown = 20;
};

std::vector<std::string> recall_cells(const Recall& recall) {
  std::vector<std::string> cells;
  for (const double r : recall) cells.push_back(fmt::format("{:.1f}", r));
  return cells;
}

std::vector<std::string> row(std::string name, const std::string& k, const Recall& recall) {
  std::vector<std::string> cells{std::move(name), k};
  for (std::string& cell : recall_cells(recall)) cells.push_back(std::move(cell));
  return cells;
}

void print_tables(const RankerEvaluation& e, const EvaluateRankerArgs& args) {
  const Retrieval& r = e.retrieval;
  const std::string k = std::to_string(r.descriptions);
  std::vector<std::vector<std::string>> rows{row("random", k, random_recall(r.descriptions)),
                                             row("most common first", k, blind_recall(e.real.right)),
                                             row("this ranker", k, r.recall),
                                             row("  mean over descriptions", k, r.by_description())};
  for (const paper::RankerRow& p : paper::table1)
    rows.push_back(row(fmt::format("paper, CMU: {}", p.name), "250", p.cmu));
  for (const paper::RankerRow& p : paper::table1)
    rows.push_back(row(fmt::format("paper, H3.6M: {}", p.name), "15", p.h36m));
  print_table({"retrieval, %", "K", "R@1", "R@3", "R@5", "R@10"}, rows, "lrrrrr");
  fmt::print(
      "The paper's rows are for other clips and captions{}: not comparable, except for the gap to random.\n",
      r.descriptions == 250 ? "" : ", and another K");
  fmt::print(
      "mean rank of the correct description {:.1f} of {}; inception score of these windows {:.2f} nats\n",
      r.mean_rank, r.descriptions, e.inception_score);
  std::vector<const Retrieval::Part*> parts;
  for (const Retrieval::Part& part : r.parts) parts.push_back(&part);
  const std::size_t shown_parts = std::min(parts.size(), args.breakdown);
  if (shown_parts == 0) return;
  rows.clear();
  for (std::size_t i = 0; i < shown_parts; ++i) {
    const Retrieval::Part& part = *parts[i];
    rows.push_back({e.real.descriptions.texts[part.description],
                    std::to_string(e.real.descriptions.clips[part.description]),
                    std::to_string(part.samples)});
    for (std::string& cell : recall_cells(part.recall)) rows.back().push_back(std::move(cell));
    rows.back().push_back(fmt::format("{:.1f}", part.mean_rank));
  }
  fmt::print("\n");
  print_table({"description", "clips", "windows", "R@1", "R@3", "R@5", "R@10", "mean rank"}, rows,
              "lrrrrrrr");
  if (shown_parts < parts.size())
    fmt::print("{} more; --breakdown {} shows all\n", parts.size() - shown_parts, parts.size());
}

void write_json(const RankerEvaluation& e, const Ranker& ranker, const fs::path& path) {
  const auto recalls = [](const Recall& recall) {
    nlohmann::json out;
    for (std::size_t i = 0; i < recall.size(); ++i) out["R@" + std::to_string(recall_ranks[i])] = recall[i];
    return out;
  };
  nlohmann::json parts = nlohmann::json::array();
  for (const Retrieval::Part& part : e.retrieval.parts)
    parts.push_back({{"description", e.real.descriptions.texts[part.description]},
                     {"clips", e.real.descriptions.clips[part.description]},
                     {"windows", part.samples},
                     {"recall", recalls(part.recall)},
                     {"mean_rank", part.mean_rank}});
  const nlohmann::json out{{"ranker", name_of(ranker.options().kind)},
                           {"hidden", ranker.options().hidden},
                           {"K", e.retrieval.descriptions},
                           {"clips", e.real.clips},
                           {"windows", e.retrieval.samples},
                           {"recall", recalls(e.retrieval.recall)},
                           {"recall_by_description", recalls(e.retrieval.by_description())},
                           {"random", recalls(random_recall(e.retrieval.descriptions))},
                           {"most_common_first", recalls(blind_recall(e.real.right))},
                           {"mean_rank", e.retrieval.mean_rank},
                           {"inception_score_nats", e.inception_score},
                           {"inception_score_exp", std::exp(e.inception_score)},
                           {"descriptions", parts}};
  make_folder_of(path);
  motion::write_text_atomically(path, out.dump(2) + "\n");
  fmt::print("wrote {}\n", shown(path));
}

int run_evaluation(EvaluateRankerArgs args, const CLI::App& verb) {
  const fs::path file = ranker_file(args.ranker), checkpoint = RunFiles{file.parent_path()}.checkpoint();
  check_output("--json", args.json, json_output, {file, args.folder, args.data.captions});
  const Context context;
  const Ranker ranker = Ranker::load(context, file);
  take_captioned_data(args, verb, checkpoint, file);
  // Windows have the ranker's format, whichever clips they come from.
  args.data.frames = ranker.format().frames;
  args.data.rate = ranker.format().rate;
  fill_in_data(args, motion::RootRotation::heading);
  const motion::Dataset data = load_data(args);
  print_data(data, args);
  print_fact("device", describe(context.device()));
  const RankerEvaluation evaluation = evaluate_ranker(ranker, data, args.evaluation);
  std::size_t strange = 0;
  for (const std::string& text : evaluation.real.descriptions.texts)
    strange += ranker.format().vocabulary.unknown_words(text).empty() ? 0 : 1;
  print_fact(
      "choices",
      fmt::format("K = {} of {}, {} windows of each{}",
                  counted(evaluation.retrieval.descriptions, "distinct description"),
                  counted(evaluation.real.clips, "test clip"), args.evaluation.windows_per_clip,
                  strange == 0 ? std::string()
                               : fmt::format("; {} have words that no training caption contains", strange)));
  fmt::print("\n");
  print_tables(evaluation, args);
  if (!args.json.empty()) write_json(evaluation, ranker, args.json);
  return 0;
}

const Verb evaluate_ranker_verb{
    "evaluate ranker", [](CLI::App& evaluate, Job& job) {
      CLI::App* verb = evaluate.add_subcommand(
          "ranker",
          "Measure how often a ranker finds the description of a held-out clip among K distinct ones\n"
          "(Lin & Amer, Table 1). Clips with equal descriptions count as correct for each other.");
      const auto args = std::make_shared<EvaluateRankerArgs>();
      EvaluateRankerArgs& a = *args;
      const auto option = [&](const char* name, auto& member, const char* text) {
        return verb->add_option(name, member, text)->capture_default_str();
      };
      verb->add_option("RANKER", a.ranker, "folder of a `train ranker` run, or a ranker file")
          ->required()
          ->type_name("");
      add_test_clip_options(*verb, a);
      option("--descriptions", a.evaluation.descriptions, "K: at most this many, the most frequent ones")
          ->check(positive());
      option("--windows", a.evaluation.windows_per_clip, "windows of each clip, evenly spaced")
          ->check(positive());
      option("--breakdown", a.breakdown, "number of descriptions to list separately, the most frequent first")
          ->check(not_negative());
      verb->add_option("--json", a.json, "also write all results as JSON")->type_name("FILE");
      verb->callback([&job, args, verb] {
        fill_in_procedural(*verb, args->procedural);
        job = [args, verb] { return run_evaluation(*args, *verb); };
      });
    }};

}  // namespace

}  // namespace motiongan::command
