// motiongan ablate: training the variants, each with the same budget.
#include "ablate/ablate_attention.hpp"
#include "signals.hpp"

namespace motiongan::command {
namespace {

/// As many as the random numbers' counter holds.
std::size_t most_iterations(const AttentionTrainOptions& o) {
  return (std::size_t{1} << 24) / (o.critic_steps + 1 + o.generator_steps) - 2;
}

}  // namespace

bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes) {
  catch_signals();
  for (const AblationVariant* variant : variants) {
    const fs::path folder = save / variant->name;
    if (has_had(folder, training.budget)) {
      fmt::print("{}: is trained already\n", variant->name);
      continue;
    }
    make_folder(folder);
    ActionGan model(context, data.format, variant->model(training.model));
    AttentionTrainOptions options = variant->training(training.training);
    options.iterations =
        training.budget.iterations > 0 ? training.budget.iterations : most_iterations(training.training);
    const bool ended = unless_diverged(variant->name, [&] {
      if (variant->lstm)
        return train_within(model, data, AblationVariant::baseline_training(options),
                            BaselineRunOptions{.save_dir = folder, .notes = notes(*variant)}, training.budget,
                            variant->name);
      return train_within(model, data, options,
                          AttentionRunOptions{.save_dir = folder, .notes = notes(*variant)}, training.budget,
                          variant->name);
    });
    if (!ended) return false;
  }
  return true;
}

}  // namespace motiongan::command
