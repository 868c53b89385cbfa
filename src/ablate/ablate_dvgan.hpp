// What the parts of `motiongan ablate dvgan` share.
#pragma once
#include "shared/command.hpp"
#include "motiongan/experiments/dvgan_ablation.hpp"

namespace motiongan::command {

/// Folder of a variant's training with a seed.
inline fs::path folder_of(const fs::path& save, const DvganVariant& variant, std::uint64_t seed) {
  return save / variant.name() / concat("seed-", seed);
}

/// Measures the models that are in `save`, prints the table and writes runs.csv (one line a training),
/// table.csv (means and spreads) and table.md (the same, the paper's rows beside) there.
void report_dvgan_variants(const Context& context, const motion::Dataset& data, const Ranker& ranker,
                           const fs::path& save, const std::vector<DvganVariant>& variants,
                           const std::vector<std::uint64_t>& seeds, const ModelEvaluationOptions& options);

}  // namespace motiongan::command
