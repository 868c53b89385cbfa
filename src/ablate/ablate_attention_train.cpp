// motiongan ablate attention: trains the variants, all with the same budget.
#include "ablate/ablate_attention.hpp"
#include "shared/signals.hpp"
#include "train/action_training.hpp"

namespace motiongan::command {

bool only_sized(const Context& context, const motion::ActionDataset& data,
                const std::vector<const AblationVariant*>& variants, const AblationTraining& training) {
  for (const AblationVariant* variant : variants) {
    AttentionTrainOptions options = variant->training(training.training);
    options.iterations = iterations_of(training.budget, options.steps());
    if (training.dry_run) fmt::print("{}\n", variant->name);
    only_sized(context, data, variant->model(training.model), options, training.dry_run,
               training.budget.iterations);
  }
  return training.dry_run;
}

bool train_variants(const Context& context, const motion::ActionDataset& data, const fs::path& save,
                    const std::vector<const AblationVariant*>& variants, const AblationTraining& training,
                    const VariantNotes& notes, SharedRuns& runs) {
  catch_signals();
  // Seed by seed, so that a comparison stopped early has all variants, with fewer seeds.
  for (const std::uint64_t seed : training.seeds)
    for (const AblationVariant* variant : variants) {
      if (!runs.takes_next()) continue;
      const AblationTraining seeded = with_seed(training, seed);
      const std::string name = concat(variant->name, " seed-", seed);
      const fs::path folder = run_folder(save, *variant, seed, training.seeds.front());
      if (has_had(folder, training.budget)) {
        fmt::print("{}: already trained\n", name);
        continue;
      }
      make_folder(folder);
      ActionGan model(context, data.format, variant->model(seeded.model));
      AttentionTrainOptions options = variant->training(seeded.training);
      options.iterations = iterations_of(training.budget, options.steps());
      const auto write_split = [&](const fs::path& path) { data.write_split(path); };
      const bool ended = unless_diverged(name, [&] {
        const auto trainer = variant->lstm
                                 ? std::unique_ptr<Trainer>(new BaselineTrainer(
                                       model, data, AblationVariant::baseline_training(options)))
                                 : std::unique_ptr<Trainer>(new AttentionTrainer(model, data, options));
        return train_within(*trainer, write_split, {.save_dir = folder, .notes = notes(*variant, seed)},
                            training.budget, name);
      });
      if (!ended) return false;
    }
  return true;
}

}  // namespace motiongan::command
