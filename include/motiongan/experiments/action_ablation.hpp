// The ablation study of Malek-Podjaski & Deligianni (Fig. 2): the full model, the model without some of its
// parts, and the LSTM baseline.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/experiments/action_evaluation.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/metrics/mean_std.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"

namespace motiongan {

/// A model of the study: which parts of the full model it has.
struct AblationVariant {
  std::string_view name;
  std::string_view title;  ///< for plots
  std::string_view paper;  ///< the paper's finding in short; its figures print no numbers
  bool attention = true, skeleton_loss = true, blend_loss = true, lstm = false;

  /// The variant's model options, from those of the full model.
  ActionGanOptions model(ActionGanOptions options) const {
    options.generator = lstm ? ActionGenerator::lstm : ActionGenerator::attention;
    options.attention = options.attention && attention;
    if (lstm) options.noise_dim = 0, options.continues = options.exact_bones = false;
    return options;
  }
  /// The variant's training options, from those of the full model.
  AttentionTrainOptions training(AttentionTrainOptions options) const {
    if (!skeleton_loss) options.skeleton_weight = 0;
    if (!blend_loss) options.blend_weight = 0;
    return options;
  }
  /// The LSTM's training options, with the same batches, iterations, Adam and seed.
  static BaselineTrainOptions baseline_training(const AttentionTrainOptions& options) {
    return {options.iterations, options.batch, options.balanced, options.adam, options.seed};
  }
};

/// All seven variants, the full model first.
inline std::span<const AblationVariant> ablation_variants() {
  static constexpr AblationVariant all[] = {
      {"full", "full", "best: lowest deviation from ground truth over time"},
      {"no_attention", "no attention", "clearly less accurate over time", false},
      {"no_blend", "no blend", "starts close, soon diverges from ground truth", true, true, false},
      {"no_skeleton", "no skeleton", "much less accurate", true, false, true},
      {"no_losses", "no losses", "worse than with the losses", true, false, false},
      {"neither", "neither", "worse than with all parts", false, false, false},
      {"lstm", "LSTM", "starts very close, then collapses to a mean pose", false, false, false, true}};
  return all;
}

/// The variant called `name`. Throws Error, listing the names, if there is none.
inline const AblationVariant& ablation_variant(std::string_view name) {
  std::string names;
  for (const AblationVariant& v : ablation_variants()) {
    if (v.name == name) return v;
    names += concat(names.empty() ? "" : ", ", v.name);
  }
  throw Error("there is no variant '", name, "'; the variants are: ", names);
}

/// One trained model of a variant, measured.
struct AblationRun {
  std::uint64_t seed = 0;
  std::size_t iterations = 0;                ///< of its training; 0: not known, or not trained
  ActionMeasures measures{};                 ///< over the frames of the paper's Fig. 2
  std::optional<ActionMeasures> long_run{};  ///< over a long rollout, if one was made
};

/// The measures of a variant: at least one run.
struct AblationResult {
  std::string name;
  std::vector<AblationRun> runs;  ///< one for each seed

  /// Mean and standard deviation of a measure over the runs.
  MeanStd over_seeds(double ActionMeasures::*what) const {
    std::vector<double> values;
    for (const AblationRun& run : runs) values.push_back(run.measures.*what);
    return mean_spread(values);
  }
  /// The same of the long rollouts; the count is 0 if there are none.
  MeanStd over_long_runs(double ActionMeasures::*what) const {
    std::vector<double> values;
    for (const AblationRun& run : runs)
      if (run.long_run) values.push_back((*run.long_run).*what);
    return values.empty() ? MeanStd{} : mean_spread(values);
  }
  /// Mean over the runs of ActionMeasures::angles.
  std::vector<double> angles() const {
    std::vector<double> out(runs.front().measures.angles.size(), 0);
    for (const AblationRun& run : runs)
      for (std::size_t f = 0; f < out.size(); ++f)
        out[f] += run.measures.angles[f] / static_cast<double>(runs.size());
    return out;
  }
};

/// Writes the mean joint angle of every frame as CSV: frame, seconds, truth (ground truth), then a column for
/// each result, the mean over its seeds. Frame 1 is the first frame after the prior.
inline void write_angles(const std::filesystem::path& path, const ActionEvaluation& evaluation,
                         std::span<const AblationResult> results) {
  std::string text = "frame,seconds,truth";
  std::vector<std::vector<double>> curves;
  for (const AblationResult& r : results) text += "," + r.name, curves.push_back(r.angles());
  text += '\n';
  for (std::size_t f = 0; f < evaluation.truth().angles.size(); ++f) {
    text += concat(f + 1, ',', static_cast<double>(f + 1) / evaluation.format().rate, ',',
                   evaluation.truth().angles[f]);
    for (const std::vector<double>& curve : curves) text += concat(',', curve[f]);
    text += '\n';
  }
  motion::write_text_atomically(path, text);
}

/// A column of the study's tables.
struct ActionColumn {
  double ActionMeasures::*measure;
  std::string_view stem;       ///< of its name
  std::string_view unit{};     ///< of a length, if lengths are in metres: "mm" or "m"
  std::string_view ending{};   ///< of its name, after the unit
  bool over_long_run = false;  ///< of the long rollout

  std::string name(bool metres) const {
    return concat(stem, metres && !unit.empty() ? concat("_", unit) : std::string(), ending);
  }
  /// What a measure is multiplied by: short lengths are written in millimetres.
  double factor(bool metres) const { return metres && unit == "mm" ? 1000 : 1; }
};
/// All columns, in the order of the tables.
inline std::span<const ActionColumn> action_columns() {
  using M = ActionMeasures;
  static constexpr ActionColumn all[] = {{&M::curve_error, "curve_error_deg"},
                                         {&M::curve_error_first, "curve_error_first_second_deg"},
                                         {&M::curve_error_last, "curve_error_last_second_deg"},
                                         {&M::window_error, "window_error_deg"},
                                         {&M::window_error_deviation, "window_error_deviation_deg"},
                                         {&M::bone_error, "bone_error_percent"},
                                         {&M::seam, "seam", "mm"},
                                         {&M::seam_body, "seam_body", "mm"},
                                         {&M::first_seam, "first_seam", "mm"},
                                         {&M::step, "step", "mm"},
                                         {&M::speed, "speed", "m", "_per_s"},
                                         {&M::distance, "distance", "m"},
                                         {&M::bone_error, "bone_error_percent", "", "_long", true},
                                         {&M::seam, "seam", "mm", "_long", true},
                                         {&M::step, "step", "mm", "_long", true},
                                         {&M::speed, "speed", "m", "_per_s_long", true},
                                         {&M::distance, "distance", "m", "_long", true},
                                         {&M::broken, "broken_share", "", "_long", true}};
  return all;
}

/// Writes the measures as CSV, a row for each result, ground truth first: means over the seeds. `metres`:
/// lengths are in metres; short lengths are then written in millimetres. Columns that end in `_long` belong
/// to the long rollout.
inline void write_table(const std::filesystem::path& path, const ActionEvaluation& evaluation,
                        std::span<const AblationResult> results, bool metres) {
  std::string text = "variant,iterations";
  for (const ActionColumn& column : action_columns()) text += "," + column.name(metres);
  text += ",seeds\n";
  const auto row = [&](const AblationResult& r) {
    const std::size_t iterations = r.runs.front().iterations;
    text += concat(r.name, ',', iterations > 0 ? concat(iterations) : std::string());
    for (const ActionColumn& column : action_columns()) {
      const MeanStd m =
          column.over_long_run ? r.over_long_runs(column.measure) : r.over_seeds(column.measure);
      text += ',';
      if (m.count > 0) text += concat(column.factor(metres) * m.mean);
    }
    text += concat(',', r.runs.size(), '\n');
  };
  row({"truth", {{.measures = evaluation.truth()}}});
  for (const AblationResult& r : results) row(r);
  motion::write_text_atomically(path, text);
}

/// Writes the measures of every run as CSV: variant, seed, iterations, then the columns of write_table().
inline void write_runs(const std::filesystem::path& path, std::span<const AblationResult> results,
                       bool metres) {
  std::string text = "variant,seed,iterations";
  for (const ActionColumn& column : action_columns()) text += "," + column.name(metres);
  text += '\n';
  for (const AblationResult& r : results)
    for (const AblationRun& run : r.runs) {
      text += concat(r.name, ',', run.seed, ',', run.iterations);
      for (const ActionColumn& column : action_columns()) {
        text += ',';
        if (column.over_long_run && !run.long_run) continue;
        const ActionMeasures& m = column.over_long_run ? *run.long_run : run.measures;
        text += concat(column.factor(metres) * m.*column.measure);
      }
      text += '\n';
    }
  motion::write_text_atomically(path, text);
}

/// Whether results support a claim.
enum class Verdict {
  yes,
  no,
  even  ///< the two numbers are within 10% of each other, or with several seeds within two standard errors
};

/// A claim of the paper about a part of its model, and whether the results support it.
struct AblationClaim {
  std::string claim;     ///< such as "attention: closer to the ground-truth curve"
  std::string evidence;  ///< the numbers compared
  Verdict verdict = Verdict::no;
};

namespace action_ablation_detail {

/// Three significant digits, which is what a few seeds are good for.
inline std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// "full 3.2, lstm 1.8 degrees"; with several seeds "full 3.2 ± 0.4, lstm 1.8 ± 0.2 degrees, 3.1 standard
/// errors apart".
inline AblationClaim compare(std::string claim, const AblationResult& with, const AblationResult& without,
                             double ActionMeasures::*what, const char* unit, double factor) {
  const MeanStd a = with.over_seeds(what), b = without.over_seeds(what);
  const auto text = [&](const AblationResult& r, const MeanStd& m) {
    return concat(r.name, " ", rounded(factor * m.mean),
                  m.count > 1 ? " ± " + rounded(factor * m.spread) : std::string());
  };
  std::string evidence = concat(text(with, a), ", ", text(without, b), unit);
  bool even = std::max(a.mean, b.mean) <= 1.1 * std::min(a.mean, b.mean);
  if (a.count > 1 && b.count > 1) {
    const double error = std::sqrt(a.spread * a.spread / static_cast<double>(a.count) +
                                   b.spread * b.spread / static_cast<double>(b.count));
    const double apart = std::abs(a.mean - b.mean);
    even = even || apart < 2 * error;
    if (error > 0) evidence += concat(", ", rounded(apart / error), " standard errors apart");
  }
  return {std::move(claim), std::move(evidence),
          even              ? Verdict::even
          : a.mean < b.mean ? Verdict::yes
                            : Verdict::no};
}

}  // namespace action_ablation_detail

/// Checks the paper's claims about the variants among the results. A single training run per variant is weak
/// evidence: where two numbers are close, another seed may reverse them. `metres`: as in write_table().
inline std::vector<AblationClaim> judge_claims(std::span<const AblationResult> results, bool metres) {
  const auto find = [&](std::string_view name) -> const AblationResult* {
    for (const AblationResult& r : results)
      if (r.name == name) return &r;
    return nullptr;
  };
  std::vector<AblationClaim> out;
  const auto less = [&](std::string claim, const char* with, const char* without,
                        double ActionMeasures::*what, const char* unit, double factor = 1) {
    const AblationResult *a = find(with), *b = find(without);
    if (a != nullptr && b != nullptr)
      out.push_back(action_ablation_detail::compare(std::move(claim), *a, *b, what, unit, factor));
  };
  less("attention: closer to the ground-truth curve", "full", "no_attention", &ActionMeasures::curve_error,
       " degrees");
  less("blend loss: closer to the ground-truth curve", "full", "no_blend", &ActionMeasures::curve_error,
       " degrees");
  less("skeleton loss: closer to the ground-truth curve", "full", "no_skeleton", &ActionMeasures::curve_error,
       " degrees");
  less("both losses: closer to the ground-truth curve", "full", "no_losses", &ActionMeasures::curve_error,
       " degrees");
  less("closer to the ground-truth curve than the LSTM", "full", "lstm", &ActionMeasures::curve_error,
       " degrees");
  less("skeleton loss: smaller bone-length error", "full", "no_skeleton", &ActionMeasures::bone_error, "%");
  less("blend loss: smaller jumps at the seams", "full", "no_blend", &ActionMeasures::seam_body,
       metres ? " mm" : "", metres ? 1000 : 1);
  if (const AblationResult* lstm = find("lstm")) {
    const auto rounded = action_ablation_detail::rounded;
    const double early = lstm->over_seeds(&ActionMeasures::curve_error_first).mean,
                 late = lstm->over_seeds(&ActionMeasures::curve_error_last).mean;
    const std::vector<double> angles = lstm->angles();
    out.push_back(
        {"LSTM: its error grows over time and its mean angle falls",
         concat("error ", rounded(early), " degrees in the first second, ", rounded(late),
                " in the last; mean angle ", rounded(angles.front()), " to ", rounded(angles.back())),
         early < late && angles.back() < angles.front() ? Verdict::yes : Verdict::no});
  }
  return out;
}

}  // namespace motiongan
