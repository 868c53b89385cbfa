// The ablation study of Lin & Amer (Tables 2 and S1): generators, critics, validation, input shift and final
// cut in every combination.
#pragma once
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "motiongan/experiments/model_evaluation.hpp"
#include "motiongan/experiments/paper_tables.hpp"
#include "motiongan/metrics/mean_std.hpp"
#include "motiongan/train/dvgan_trainer.hpp"

namespace motiongan {

/// A variant in the study.
struct DvganVariant {
  GeneratorKind generator = GeneratorKind::cnn;
  CriticKind critic = CriticKind::cnn;
  Validation validation = Validation::dense;  ///< of the CNN critic; ignored for the RNN critic
  bool shift = false, cut = false;            ///< input shift and final cut

  bool operator==(const DvganVariant&) const = default;

  /// Such as "cnn-cnn-dense-shift-cut": generator, critic, the CNN critic's validation, then what is on.
  std::string name() const {
    std::string out = concat(name_of(generator), "-", name_of(critic));
    if (critic == CriticKind::cnn) out += concat("-", validation_name());
    if (shift) out += "-shift";
    if (cut) out += "-cut";
    return out;
  }
  /// "dense", "mod2" or "final"; empty for the RNN critic.
  std::string_view validation_name() const { return critic == CriticKind::rnn ? "" : name_of(validation); }

  /// `options` with this variant's generator and final cut.
  DvganOptions model(DvganOptions options) const {
    options.generator = generator;
    options.final_cut = cut;
    return options;
  }
  /// `options` with this variant's critic, validation and input shift.
  DvganTrainOptions training(DvganTrainOptions options) const {
    options.critic.critic = critic;
    if (critic == CriticKind::cnn) options.critic.validation = validation;
    options.input_shift = shift;
    return options;
  }

  /// This variant's row in one of the paper's tables; null if the table does not list it.
  const paper::GeneratorRow* find(std::span<const paper::GeneratorRow> table) const {
    for (const paper::GeneratorRow& row : table)
      if (row.generator == name_of(generator) && row.critic == name_of(critic) &&
          row.validation == validation_name() && row.shift == shift && row.cut == cut)
        return &row;
    return nullptr;
  }
};

/// The variant of a row of the paper's tables.
inline DvganVariant variant_of(const paper::GeneratorRow& row) {
  return {.generator = enum_from<GeneratorKind>(row.generator, "generator"),
          .critic = enum_from<CriticKind>(row.critic, "critic"),
          .validation = row.validation.empty() ? Validation::dense
                                               : enum_from<Validation>(row.validation, "validation"),
          .shift = row.shift,
          .cut = row.cut};
}

/// The eight rows of Table 2 in its order, then those that Table S1 adds: both generators with the RNN
/// critic.
inline std::vector<DvganVariant> paper_dvgan_variants() {
  std::vector<DvganVariant> out;
  const auto add = [&](const paper::GeneratorRow& row) {
    const DvganVariant variant = variant_of(row);
    if (std::find(out.begin(), out.end(), variant) == out.end()) out.push_back(variant);
  };
  for (const paper::GeneratorRow& row : paper::table2_cmu) add(row);
  for (const paper::GeneratorRow& row : paper::table_s1_h36m) add(row);
  return out;
}

/// All 32 combinations: two generators, four critics, with and without shift and cut.
inline std::vector<DvganVariant> all_dvgan_variants() {
  std::vector<DvganVariant> out;
  for (const GeneratorKind generator : {GeneratorKind::cnn, GeneratorKind::rnn})
    for (const auto& [critic, validation] :
         {std::pair{CriticKind::cnn, Validation::final}, std::pair{CriticKind::cnn, Validation::mod2},
          std::pair{CriticKind::cnn, Validation::dense}, std::pair{CriticKind::rnn, Validation::dense}})
      for (const bool cut : {false, true})
        for (const bool shift : {false, true}) out.push_back({generator, critic, validation, shift, cut});
  return out;
}

/// The variant with this name(). Throws Error, explaining the names, if there is none.
inline DvganVariant dvgan_variant(std::string_view name) {
  for (const DvganVariant& variant : all_dvgan_variants())
    if (variant.name() == name) return variant;
  throw Error("there is no variant called \"", name,
              "\"; a name is generator-critic (cnn or rnn), for the CNN critic -final, -mod2 or -dense, then "
              "-shift and -cut where they are on, as cnn-cnn-dense-shift-cut or rnn-rnn");
}

/// One training run of a variant, evaluated.
struct DvganRun {
  std::uint64_t seed = 0;
  std::size_t iterations = 0;
  ModelEvaluation evaluation;
};

/// All training runs of a variant.
struct DvganAblationRow {
  DvganVariant variant;
  std::vector<DvganRun> runs;  ///< one for each seed

  /// Mean and standard deviation over the runs of measure(evaluation).
  template <class Measure>
  MeanStd over_seeds(const Measure& measure) const {
    std::vector<double> values;
    for (const DvganRun& run : runs) values.push_back(measure(run.evaluation));
    return mean_spread(values);
  }
};

/// A column of the study's table: its name, and a function of a motion set's measures and its FID.
struct AblationColumn {
  std::string_view name;
  int decimals = 1;  ///< digits after the point
  double (*measure)(const MotionSetMeasures& set, double distance);
};
/// All columns, in the order of the table. Those of feet are NaN for a skeleton that has none.
inline std::span<const AblationColumn> ablation_columns() {
  using Set = const MotionSetMeasures&;
  static constexpr AblationColumn all[] = {
      {"IS", 2, [](Set s, double) { return s.inception_score; }},
      {"R@1", 1, [](Set s, double) { return s.retrieval.recall[0]; }},
      {"R@3", 1, [](Set s, double) { return s.retrieval.recall[1]; }},
      {"R@5", 1, [](Set s, double) { return s.retrieval.recall[2]; }},
      {"R@10", 1, [](Set s, double) { return s.retrieval.recall[3]; }},
      {"FID", 3, [](Set, double d) { return d; }},
      {"diversity", 3, [](Set s, double) { return s.diversity; }},
      {"multimodality", 3, [](Set s, double) { return s.multimodality; }},
      {"jerk", 1, [](Set s, double) { return s.quality.jerk; }},
      {"foot skate %", 1, [](Set s, double) { return s.quality.feet ? 100 * s.quality.feet->ratio() : NAN; }},
      {"near floor %", 1,
       [](Set s, double) { return s.quality.feet ? 100 * s.quality.feet->contact_share() : NAN; }}};
  return all;
}

/// Mean and standard deviation of the difference b - a of a measure over runs with equal seeds. Pairing
/// removes the variation between seeds that both rows share. The count is 0 if no seed is in both.
template <class Measure>
MeanStd paired_difference(const DvganAblationRow& a, const DvganAblationRow& b, const Measure& measure) {
  std::vector<double> differences;
  for (const DvganRun& x : a.runs)
    for (const DvganRun& y : b.runs)
      if (x.seed == y.seed) differences.push_back(measure(y.evaluation) - measure(x.evaluation));
  return differences.empty() ? MeanStd{} : mean_spread(differences);
}

}  // namespace motiongan
