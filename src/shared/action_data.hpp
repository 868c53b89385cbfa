// Options and loading of labelled clips, shared by several verbs.
#pragma once
#include "motiongan/data/action_dataset.hpp"
#include "shared/captioned_data.hpp"

namespace motiongan::command {

struct ActionDataArgs {
  std::string folder;
  std::size_t procedural = 0;  // clips of built-in motion; 0: the folder's
  motion::ActionDatasetOptions options;

  void list_fields(FieldList& list) {
    list.add(folder,
             {.key = "folder", .help = "folder of motion files (searched recursively)", .option = "FOLDER"});
    list.add(procedural, {.key = "procedural",
                          .help = "instead of FOLDER: number of clips of built-in motion, labelled by action",
                          .type = "CLIPS"});
    options.list_fields(list);
  }
};

/// Options that describe the clips themselves; other clips need their own.
inline const std::vector<std::string_view> options_of_action_clips{
    "--labels", "--folders", "--pattern", "--bones",       "--test-subjects", "--classes",
    "--up",     "--scale",   "--fps",     "--unit-metres", "--skeleton-of"};

/// Adds FOLDER and the options of labels and split; with `windows`, also --frames, --rate and --root.
void add_action_data_options(CLI::App& verb, ActionDataArgs& args, bool windows);

/// Uses labels.tsv in the folder if no option gives the labels, and makes paths absolute. Throws Error if
/// --procedural is combined with options of labels or bones.
void fill_in_choices(ActionDataArgs& args);

/// Takes the data options that the command line of `verb` does not give from the checkpoint of `run`. Throws
/// Error, ending in `remedy`, if neither names the clips.
void take_data_of_run(ActionDataArgs& args, const CLI::App& verb, const fs::path& run, const char* remedy);

/// Loads the clips and prints their source.
motion::ActionDataset load_data(const ActionDataArgs& args);
void print_data(const motion::ActionDataset& data, const ActionDataArgs& args);

/// The built-in motion that --procedural asks for.
std::vector<motion::LabelledMotion> procedural_clips(const ActionDataArgs& args);

/// "'jump', 'run', 'walk'".
std::string quoted_list(const std::vector<std::string>& names);

}  // namespace motiongan::command
