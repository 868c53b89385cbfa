// Shared by the parts of motiongan augment.
#pragma once
#include "motiongan/models/action_gan.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "shared/action_data.hpp"

namespace motiongan::command {

struct StudyArgs {
  std::size_t seeds = 3, iterations = 500, batch = 64, hidden = 256;
  double minutes = 0, learning_rate = 1e-4;
  std::string csv = "augmentation.csv";
};

void add_study_options(CLI::App& verb, StudyArgs& args);

/// Trains classifiers with and without the synthetic clips, prints their accuracy and writes the table.
/// Returns the exit status.
int run_study(const StudyArgs& args, const ActionGan& model, const motion::ActionDataset& data,
              const std::vector<SyntheticClip>& synthetic);

}  // namespace motiongan::command
