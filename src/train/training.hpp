// A training run as the command keeps it: what train and demo share.
#pragma once
#include "captioned_data.hpp"
#include "motiongan/train/train.hpp"
#include "signals.hpp"

namespace motiongan::command {

struct TrainArgs : CaptionedDataArgs {
  // What a run is. Kept in its checkpoint, so that --resume needs none of it.
  std::string generator = "cnn", critic = "cnn";
  bool final_cut = true;
  std::string validation = "dense", level_weights = "exp", diff_input = "hidden";
  DvganOptions model;
  DvganTrainOptions training;
  // What only this start of it is.
  std::string save;
  bool resume = false;
  RunOptions run;
};

/// Adds to a verb the options of model and training that are not parts of the paper's comparison.
void add_shared_dvgan_options(CLI::App& verb, TrainArgs& args);

/// What is kept of the options, for a note in the checkpoint.
std::string options_as_note(TrainArgs& args);

/// Takes from a run's note what the command line of `verb` does not give; `from` is the checkpoint.
void take_from_note(TrainArgs& args, const CLI::App& verb, const std::string& note, const fs::path& from);

/// Gives options of a new run that depend on its generator, and were left open, their values.
void choose_defaults(TrainArgs& args, bool final_cut_given);

/// Puts the choices that are given as words, and what follows from other options, where the library has them.
/// Refuses windows that the networks cannot have.
void fill_in_choices(TrainArgs& args);

void print_model(Dvgan& model);

}  // namespace motiongan::command
