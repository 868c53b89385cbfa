// Captioned clips, as the verbs that train on them or measure by them are given them.
#pragma once
#include "command.hpp"
#include "motiongan/data/dataset.hpp"

namespace motiongan::command {

struct CaptionedDataArgs {
  std::string folder, captions;
  std::size_t procedural = 0;  // clips of built-in motion; 0: the folder's
  motion::DatasetOptions data;
  std::string root_rotation = "auto", first_frame = "auto";
};

/// Calls f(name, member) for all that a run's checkpoint keeps of its data, by the name of its option.
template <class F>
void each_kept_of_data(CaptionedDataArgs& a, const F& f) {
  f("FOLDER", a.folder);
  f("--captions", a.captions);
  f("--procedural", a.procedural);
  f("--frames", a.data.frames);
  f("--rate", a.data.rate);
  f("--root-position", a.data.root_position);
  f("--root-rotation", a.root_rotation);
  f("--first-frame", a.first_frame);
  f("--train-share", a.data.train_share);
  f("--split-seed", a.data.split_seed);
}

/// Whether an option goes with a folder of clips, and not with another one.
inline bool describes_captioned_clips(const std::string& name) { return name == "--captions"; }

/// Adds FOLDER and the options of the data to a verb.
void add_captioned_data_options(CLI::App& verb, CaptionedDataArgs& args);

/// Adds FOLDER and what names other test clips than those of a run.
void add_test_clip_options(CLI::App& verb, CaptionedDataArgs& args);

/// What --procedural is without a number.
void fill_in_procedural(const CLI::App& verb, CaptionedDataArgs& args);

/// Makes paths absolute, finds the captions beside the clips, and puts choices that are given as words where
/// the library has them; "auto" of the root's rotation is `root_rotation`.
void fill_in_data(CaptionedDataArgs& args, const std::string& root_rotation);

motion::Dataset load_data(const CaptionedDataArgs& args);
void print_data(const motion::Dataset& data, const CaptionedDataArgs& args);

}  // namespace motiongan::command
