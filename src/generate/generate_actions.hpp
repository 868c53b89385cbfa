// motiongan generate, for a model of classes.
#pragma once
#include "shared/action_data.hpp"

namespace motiongan::command {

struct ActionGenerateArgs {
  std::vector<std::string> from;  // clips
  std::vector<double> at;         // seconds
  std::string schedule, format = "bvh", data, bones, attention_map;
  double seconds = 0;
  bool with_prior = true;
  // As for texts.
  std::string model, out, html, png;
  std::size_t count = 1, frames = 0, first_sample = 0;
  std::uint64_t seed = 1;
  double rate = 0;
};

/// Adds the options that only a model of classes has.
void add_action_options(CLI::App& verb, ActionGenerateArgs& args);

/// The names of those that `verb` was given.
std::string given_action_options(const CLI::App& verb);

/// `file` holds an attention model.
int generate_actions(const ActionGenerateArgs& args, const CLI::App& verb, const fs::path& file);

}  // namespace motiongan::command
