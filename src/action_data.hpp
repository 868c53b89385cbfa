// Clips with classes, as several verbs are told of them.
#pragma once
#include "command.hpp"
#include "motiongan/data/action_dataset.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {

struct ActionDataArgs {
  std::string folder, labels, bones, first_frame = "auto";
  std::size_t procedural = 0;  // clips of built-in motion; 0: the folder's
  motion::ActionDatasetOptions options;
};

/// Calls f(name, member) for all that a run keeps of them, by the name of the option.
template <class F>
void each_kept(ActionDataArgs& a, F&& f) {
  f("FOLDER", a.folder);
  f("--procedural", a.procedural);
  f("--labels", a.labels);
  f("--folders", a.options.folders);
  f("--pattern", a.options.pattern);
  f("--bones", a.bones);
  f("--classes", a.options.classes);
  f("--subjects", a.options.by_subject);
  f("--test-subjects", a.options.test_subjects);
  f("--train-share", a.options.train_share);
  f("--split-seed", a.options.split_seed);
  f("--first-frame", a.first_frame);
  f("--frames", a.options.frames);
  f("--rate", a.options.rate);
  f("--root", a.options.root_track);
}

/// Whether an option of that name says something of the clips themselves, so that other clips need their own.
bool describes_clips(const std::string& name);

/// Adds FOLDER and the options of labels and split; with `windows` also those of what a model sees.
void add_action_data_options(CLI::App& verb, ActionDataArgs& args, bool windows);

/// Puts --procedural without a number right, after the command line has been read.
void default_procedural(const CLI::App& verb, ActionDataArgs& args);

/// Finds labels.tsv in the folder where nothing else says which class clips are of, makes paths absolute, and
/// puts choices given as words where the library has them.
void fill_in_choices(ActionDataArgs& args);

/// Takes the data of a run from its checkpoint's note, but for what the command line of `verb` gives. Where
/// the run does not say, and nothing is given, an Error that ends in `remedy`.
void take_data_of_run(ActionDataArgs& args, const CLI::App& verb, const fs::path& run, const char* remedy);

/// Says what it reads.
motion::ActionDataset load_data(const ActionDataArgs& args);
void print_data(const motion::ActionDataset& data, const ActionDataArgs& args);

/// The built-in motion that --procedural asks for.
std::vector<motion::LabelledMotion> procedural_clips(const ActionDataArgs& args);

/// "'jump', 'run', 'walk'".
std::string quoted_list(const std::vector<std::string>& names);

}  // namespace motiongan::command
