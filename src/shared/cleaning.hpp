// --clean: the clean-up of what a verb writes.
#pragma once
#include "motiongan/motion/clean.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

struct Cleaning {
  std::vector<std::string> parts;  ///< feet, smooth
  motion::CleanOptions options;

  bool on() const { return !parts.empty(); }

  /// What is to be cleaned up; the first `given` frames stay as they are.
  motion::CleanOptions settings(std::size_t given = 0) const;

  /// The motion cleaned up, if anything is to be; the first `given` frames stay as they are.
  motion::Motion apply(motion::Motion motion, std::size_t given = 0) const;
};

/// Adds --clean and --cutoff; `without` says, for --help, what is done without it.
void add_clean_choice(CLI::App& verb, Cleaning& cleaning, const std::string& without = "nothing");

/// Adds these, and --unit-metres and --feet.
void add_clean_options(CLI::App& verb, Cleaning& cleaning, const std::string& without = "nothing");

}  // namespace motiongan::command
