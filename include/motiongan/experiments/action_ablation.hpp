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

/// The measures of one variant.
struct AblationResult {
  std::string name;
  ActionMeasures measures;                   ///< over the frames of the paper's Fig. 2
  std::optional<ActionMeasures> long_run{};  ///< over a long rollout, if one was made
  std::size_t iterations = 0;                ///< of its training; 0: not known, or not trained
};

/// Writes the mean joint angle of every frame as CSV: frame, seconds, truth (ground truth), then a column for
/// each result. Frame 1 is the first frame after the prior.
inline void write_angles(const std::filesystem::path& path, const ActionEvaluation& evaluation,
                         std::span<const AblationResult> results) {
  std::string text = "frame,seconds,truth";
  for (const AblationResult& r : results) text += "," + r.name;
  text += '\n';
  for (std::size_t f = 0; f < evaluation.truth().angles.size(); ++f) {
    text += concat(f + 1, ',', static_cast<double>(f + 1) / evaluation.format().rate, ',',
                   evaluation.truth().angles[f]);
    for (const AblationResult& r : results) text += concat(',', r.measures.angles[f]);
    text += '\n';
  }
  motion::write_text_atomically(path, text);
}

/// Writes the measures as CSV, a row for each result, ground truth first. `metres`: lengths are in metres;
/// short lengths are then written in millimetres. Columns that end in `_long` belong to the long rollout.
inline void write_table(const std::filesystem::path& path, const ActionEvaluation& evaluation,
                        std::span<const AblationResult> results, bool metres) {
  const char* const small = metres ? "_mm" : "";
  const char* const large = metres ? "_m" : "";
  const double factor = metres ? 1000 : 1;
  std::string text = concat(
      "variant,iterations,curve_error_deg,curve_error_first_second_deg,curve_error_last_second_deg,"
      "window_error_deg,window_error_deviation_deg,bone_error_percent,seam",
      small, ",seam_body", small, ",first_seam", small, ",step", small, ",speed", large, "_per_s,distance",
      large, ",bone_error_percent_long,seam", small, "_long,step", small, "_long,speed", large,
      "_per_s_long,distance", large, "_long,broken_share_long\n");
  const auto row = [&](const AblationResult& r) {
    const ActionMeasures& m = r.measures;
    text +=
        concat(r.name, ',', r.iterations > 0 ? concat(r.iterations) : std::string(), ',', m.curve_error, ',',
               m.curve_error_first, ',', m.curve_error_last, ',', m.window_error, ',',
               m.window_error_deviation, ',', m.bone_error, ',', factor * m.seam, ',', factor * m.seam_body,
               ',', factor * m.first_seam, ',', factor * m.step, ',', m.speed, ',', m.distance);
    if (const auto& l = r.long_run)
      text += concat(',', l->bone_error, ',', factor * l->seam, ',', factor * l->step, ',', l->speed, ',',
                     l->distance, ',', l->broken, '\n');
    else
      text += ",,,,,,\n";
  };
  row({"truth", evaluation.truth()});
  for (const AblationResult& r : results) row(r);
  motion::write_text_atomically(path, text);
}

/// Whether results support a claim.
enum class Verdict {
  yes,
  no,
  even  ///< the two numbers are within 10% of each other
};

/// A claim of the paper about a part of its model, and whether the results support it.
struct AblationClaim {
  std::string claim;     ///< such as "attention: closer to the ground-truth curve"
  std::string evidence;  ///< the numbers compared
  Verdict verdict = Verdict::no;
};

/// Checks the paper's claims about the variants among the results. A single training run per variant is weak
/// evidence: where two numbers are close, another seed may reverse them. `metres`: as in write_table().
inline std::vector<AblationClaim> judge_claims(std::span<const AblationResult> results, bool metres) {
  const auto find = [&](std::string_view name) -> const ActionMeasures* {
    for (const AblationResult& r : results)
      if (r.name == name) return &r.measures;
    return nullptr;
  };
  std::vector<AblationClaim> out;
  const auto rounded = [](double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", v);
    return std::string(text);
  };
  const auto less = [&](std::string claim, const char* with, const char* without,
                        double ActionMeasures::*what, const char* unit, double factor = 1) {
    const ActionMeasures *a = find(with), *b = find(without);
    if (a == nullptr || b == nullptr) return;
    out.push_back(
        {std::move(claim),
         concat(with, " ", rounded(factor * a->*what), ", ", without, " ", rounded(factor * b->*what), unit),
         std::max(a->*what, b->*what) <= 1.1 * std::min(a->*what, b->*what) ? Verdict::even
         : a->*what < b->*what                                              ? Verdict::yes
                                                                            : Verdict::no});
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
  if (const ActionMeasures* lstm = find("lstm")) {
    const double first = lstm->angles.front(), last = lstm->angles.back();
    out.push_back(
        {"LSTM: its error grows over time and its mean angle falls",
         concat("error ", rounded(lstm->curve_error_first), " degrees in the first second, ",
                rounded(lstm->curve_error_last), " in the last; mean angle ", rounded(first), " to ",
                rounded(last)),
         lstm->curve_error_first < lstm->curve_error_last && last < first ? Verdict::yes : Verdict::no});
  }
  return out;
}

}  // namespace motiongan
