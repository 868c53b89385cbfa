// The tables of `motiongan evaluate model`.
#include "evaluate/evaluate_model.hpp"
#include "motiongan/experiments/paper_tables.hpp"

namespace motiongan::command {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::vector<std::string> table2_row(std::string name, const std::string& k, double nats,
                                    const Recall& recall) {
  std::vector<std::string> cells{std::move(name), k, cell(nats, 2), cell(std::exp(nats), 1)};
  for (const double r : recall) cells.push_back(cell(r, 1));
  return cells;
}

std::string name_of(const paper::GeneratorRow& p) {
  if (p.critic.empty()) return std::string(p.generator);
  return fmt::format("{}, {} critic {}{}{}", p.generator, p.critic, p.validation, p.shift ? " + shift" : "",
                     p.cut ? " + cut" : "");
}

void print_table2(std::string_view generator, const ModelEvaluation& made, const RealEvaluation& real) {
  const MotionSetMeasures &m = made.measures, &r = real.measures;
  const std::string k = std::to_string(m.retrieval.descriptions);
  const double none = std::numeric_limits<double>::quiet_NaN();
  Rows rows{table2_row("random", k, none, random_recall(m.retrieval.descriptions)),
            table2_row("this model", k, m.inception_score, m.retrieval.recall),
            table2_row("real motion", k, r.inception_score, r.retrieval.recall)};
  const auto add = [&](const char* data, const char* paper_k, const paper::GeneratorRow& p) {
    rows.push_back(
        table2_row(fmt::format("paper, {}: {}", data, name_of(p)), paper_k, p.inception_score, p.recall));
  };
  const auto add_all = [&](const char* data, const char* paper_k, const auto& table,
                           const paper::GeneratorRow& real_row) {
    for (const paper::GeneratorRow& p : table)
      if (p.generator == generator) add(data, paper_k, p);
    add(data, paper_k, real_row);
  };
  add_all("CMU", "250", paper::table2_cmu, paper::real_cmu);
  add_all("H3.6M", "15", paper::table2_h36m, paper::real_h36m);
  print_table({"", "K", "IS, nats", "exp", "R@1 %", "R@3 %", "R@5 %", "R@10 %"}, rows, "lrrrrrrr");
  fmt::print("The paper's rows are for other clips, captions and rankers{}: not comparable.\n",
             m.retrieval.descriptions == 250 ? "" : ", and another K");
}

std::string biased_note(const FrechetDistance& d) {
  return d.biased() ? fmt::format(
                          "FID is computed from {} and {} motions, too few for {} dimensions: it is biased, "
                          "so compare "
                          "it only with values from as many motions\n",
                          d.samples1, d.samples2, d.dimensions)
                    : std::string();
}

void print_drift(const DriftSummary& d) {
  const auto values = [](const char* name, const DriftRow& row) {
    return std::vector<std::string>{name, cell(row.mean, 2), cell(row.spread, 2), cell(row.speed, 2),
                                    std::isnan(row.outside) ? "-" : cell(100 * row.outside, 1)};
  };
  fmt::print("\ndrift over {}, in standard deviations of the training data:\n", duration(d.seconds));
  print_table({"", "mean", "spread", "speed /s", "outside %"},
              {values("first tenth", d.first), values("last tenth", d.last)}, "lrrrr", "  ");
}

nlohmann::json recall_json(const Recall& recall) {
  nlohmann::json out;
  for (std::size_t i = 0; i < recall.size(); ++i) out["R@" + std::to_string(recall_ranks[i])] = recall[i];
  return out;
}

nlohmann::json set_json(const MotionSetMeasures& m) {
  return {{"motions", m.motions},
          {"inception_score_nats", m.inception_score},
          {"inception_score_exp", std::exp(m.inception_score)},
          {"recall", recall_json(m.retrieval.recall)},
          {"mean_rank", m.retrieval.mean_rank},
          {"diversity", m.diversity},
          {"multimodality", m.multimodality},
          {"quality", quality_json(m.quality)}};
}

nlohmann::json distance_json(const FrechetDistance& d) {
  return {{"fid", d.distance},
          {"of_means", d.means},
          {"samples", {d.samples1, d.samples2}},
          {"dimensions", d.dimensions},
          {"biased", d.biased()}};
}

nlohmann::json drift_json(const DriftRow& row) {
  nlohmann::json out{{"mean", row.mean}, {"spread", row.spread}, {"speed", row.speed}};
  if (!std::isnan(row.outside)) out["outside"] = row.outside;
  return out;
}

}  // namespace

void print_model_evaluation(std::string_view generator, const ModelEvaluation& made,
                            const RealEvaluation& real, const ModelEvaluationOptions& options) {
  const MotionSetMeasures &m = made.measures, &r = real.measures;
  print_table2(generator, made, real);
  Rows rows{{"FID *", cell(made.distance.distance, 4),
             real.training ? cell(real.training->distance, 4) + " **" : "-"},
            {"diversity *", cell(m.diversity, 4), cell(r.diversity, 4)},
            {"multimodality *", cell(m.multimodality, 4), cell(r.multimodality, 4)}};
  for (auto& row : quality_rows(m.quality, r.quality)) rows.push_back(std::move(row));
  fmt::print("\n");
  print_table({"", "this model", "real motion"}, rows, "lrr");
  fmt::print("*  in the ranker's embedding (unit length): not comparable between rankers\n");
  if (real.training)
    fmt::print("** training clips against test clips, for the {} that both have\n",
               counted(real.training_descriptions, "description"));
  fmt::print("{}", biased_note(made.distance));
  print_quality_notes(r.quality, options.feet);
  if (m.quality.bone_error < 1e-3) fmt::print("bone lengths are constant because joints only rotate\n");
  if (made.drift) print_drift(*made.drift);
}

nlohmann::json model_evaluation_json(const ModelEvaluation& made, const RealEvaluation& real) {
  nlohmann::json out{{"K", real.descriptions.size()},
                     {"test_clips", real.clips},
                     {"random", recall_json(random_recall(real.descriptions.size()))},
                     {"model", set_json(made.measures)},
                     {"real", set_json(real.measures)}};
  out["model"]["distance_from_real"] = distance_json(made.distance);
  if (real.training) {
    out["real"]["training_from_test"] = distance_json(*real.training);
    out["real"]["training_from_test"]["descriptions"] = real.training_descriptions;
  }
  if (made.drift)
    out["model"]["drift"] = {{"seconds", made.drift->seconds},
                             {"whole", drift_json(made.drift->whole)},
                             {"first_tenth", drift_json(made.drift->first)},
                             {"last_tenth", drift_json(made.drift->last)}};
  nlohmann::json parts = nlohmann::json::array();
  for (const Retrieval::Part& part : made.measures.retrieval.parts)
    parts.push_back({{"description", real.descriptions.texts[part.description]},
                     {"recall", recall_json(part.recall)},
                     {"mean_rank", part.mean_rank}});
  out["model"]["descriptions"] = std::move(parts);
  return out;
}

}  // namespace motiongan::command
