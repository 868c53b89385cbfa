// Shared by the parts of `motiongan ablate dvgan`.
#pragma once
#include "ablate/seeds.hpp"
#include "motiongan/experiments/dvgan_ablation.hpp"

namespace motiongan::command {

/// Measures the models in `save`, prints the table and writes there runs.csv (one line per run), table.csv
/// (means and standard deviations over seeds) and table.md (the same next to the paper's rows).
void report_dvgan_variants(const Context& context, const motion::Dataset& data, const Ranker& ranker,
                           const fs::path& save, const std::vector<DvganVariant>& variants,
                           const std::vector<std::uint64_t>& seeds, const ModelEvaluationOptions& options);

}  // namespace motiongan::command
