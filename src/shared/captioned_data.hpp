// Captioned clips, as given to the verbs that train on them or evaluate with them.
#pragma once
#include "motiongan/data/dataset.hpp"
#include "shared/options.hpp"

namespace motiongan::command {

struct CaptionedDataArgs {
  std::string folder;
  std::size_t procedural = 0;  // clips of built-in motion; 0: the folder's
  motion::DatasetOptions data;

  void list_fields(FieldList& list) {
    list.add(folder, {.key = "folder",
                      .help = "folder of motion files (searched recursively), or one clip",
                      .option = "FOLDER"});
    list.add(procedural, {.key = "procedural",
                          .help = "instead of FOLDER: number of clips of built-in motion",
                          .type = "CLIPS"});
    data.list_fields(list);
  }
};

/// Options that belong to one folder of clips; another folder needs its own.
inline const std::vector<std::string_view> options_of_captioned_clips{
    "--captions", "--up", "--scale", "--fps", "--unit-metres", "--bones", "--skeleton-of"};

/// Adds FOLDER and the options of the data to a verb.
void add_captioned_data_options(CLI::App& verb, CaptionedDataArgs& args);

/// Adds FOLDER and the options that select test clips other than a run's.
void add_test_clip_options(CLI::App& verb, CaptionedDataArgs& args);

/// Handles --procedural without a number, after the command line has been read.
void fill_in_procedural(const CLI::App& verb, std::size_t& procedural);

/// Makes paths absolute, finds the captions next to the clips, and sets the representation of the root's
/// rotation unless an option gives it.
void fill_in_data(CaptionedDataArgs& args, motion::RootRotation root_rotation);

/// Takes the data options that the command line does not give from the run's `checkpoint`. Throws Error if
/// neither names the clips; `file` is the model file, for the message.
void take_captioned_data(CaptionedDataArgs& args, const CLI::App& verb, const fs::path& checkpoint,
                         const fs::path& file);

motion::Dataset load_data(const CaptionedDataArgs& args);
void print_data(const motion::Dataset& data, const CaptionedDataArgs& args);

}  // namespace motiongan::command
