// motiongan generate for class-conditioned models.
#pragma once
#include "generate/directing.hpp"
#include "shared/action_data.hpp"
#include "shared/cleaning.hpp"
#include "shared/ranks.hpp"
#include "shared/retargeting.hpp"
#include "shared/weights.hpp"

namespace motiongan::command {

struct ActionGenerateArgs {
  std::vector<std::string> from;  // clips
  std::vector<double> at;         // seconds
  std::string schedule, data, attention_map;
  double seconds = 0;
  bool with_prior = true;
  motion::ClipOptions clips;  // how --from is read
  // As for text-conditioned models.
  std::string model, out, html, png, format = "bvh";
  Retargeting retargeting;
  std::size_t count = 1, frames = 0, first_sample = 0;
  std::uint64_t seed = 1;
  double rate = 0;
  Cleaning cleaning;
  Directing directing;
  Weights weights;
};

/// Adds the options that only class-conditioned models have.
void add_action_options(CLI::App& verb, ActionGenerateArgs& args);

/// The names of those options that the command line gives, separated by commas.
std::string given_action_options(const CLI::App& verb);

/// Generates with the class-conditioned model in `file`, a rank's share of it. Returns the exit status.
int generate_actions(ActionGenerateArgs args, const CLI::App& verb, const fs::path& file,
                     const Communicator* ranks);

}  // namespace motiongan::command
