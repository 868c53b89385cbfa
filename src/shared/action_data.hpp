// Clips with classes, as given to several verbs.
#pragma once
#include "motiongan/data/action_dataset.hpp"
#include "shared/captioned_data.hpp"

namespace motiongan::command {

struct ActionDataArgs {
  std::string folder;
  std::size_t procedural = 0;  // clips of built-in motion; 0: the folder's
  motion::ActionDatasetOptions options;

  void list_fields(FieldList& list) {
    list.add(folder, {.key = "folder",
                      .help = "folder of BVH, CSV or NPY clips (searched recursively)",
                      .option = "FOLDER"});
    list.add(procedural, {.key = "procedural",
                          .help = "instead of FOLDER: the number of clips of built-in motion, whose names "
                                  "begin with their class",
                          .type = "CLIPS"});
    options.list_fields(list);
  }
};

/// The options that describe the clips themselves, so that other clips need their own.
inline const std::vector<std::string_view> options_of_action_clips{
    "--labels", "--folders", "--pattern", "--bones", "--test-subjects", "--classes"};

/// Adds FOLDER and the options of labels and split; with `windows` also those of what a model sees.
void add_action_data_options(CLI::App& verb, ActionDataArgs& args, bool windows);

/// Finds labels.tsv in the folder if nothing else gives the classes of clips, and makes paths absolute.
void fill_in_choices(ActionDataArgs& args);

/// Takes the data of a run from its checkpoint's note, but for what the command line of `verb` gives. Throws
/// Error, ending in `remedy`, if neither says which clips.
void take_data_of_run(ActionDataArgs& args, const CLI::App& verb, const fs::path& run, const char* remedy);

/// Says what it reads.
motion::ActionDataset load_data(const ActionDataArgs& args);
void print_data(const motion::ActionDataset& data, const ActionDataArgs& args);

/// The built-in motion that --procedural asks for.
std::vector<motion::LabelledMotion> procedural_clips(const ActionDataArgs& args);

/// "'jump', 'run', 'walk'".
std::string quoted_list(const std::vector<std::string>& names);

}  // namespace motiongan::command
