// Options of a Dataset.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "motiongan/data/pose.hpp"
#include "motiongan/formats/clip_options.hpp"

namespace motiongan::motion {

/// Options of a Dataset.
struct DatasetOptions {
  std::size_t frames = 32;  ///< N, frames of a window
  double rate = 4.0;        ///< frames per second of a window
  /// Caption file (.csv, .json, or lines of `clip id <TAB> description`) or folder of .txt files. Empty: the
  /// .txt files beside the clips, else captions from names.
  std::filesystem::path captions{};
  bool root_position = true;  ///< whether the root's position is part of a pose
  /// expmap as in the papers, velocity for long motion; not set: heading.
  std::optional<RootRotation> root_rotation = {};
  double train_share = 0.67;     ///< fraction of the clips; the rest is for testing
  std::uint64_t split_seed = 1;  ///< decides which clips are for testing
  bool mirror = false;           ///< train on the mirror image of every training clip too
  double stretch = 0;     ///< above 0: train on every training clip also 1 + stretch and 1 - stretch as fast
  bool balanced = false;  ///< draw every description equally often, instead of every clip
  ClipOptions clips{};    ///< how the files are read

  /// The form of the root, with the default resolved.
  RootRotation rotation() const { return root_rotation.value_or(RootRotation::heading); }

  void list_fields(FieldList& list) {
    list.add(captions, {.key = "captions",
                        .help = "captions.tsv (lines `clip id <TAB> description`), .csv or .json, or a "
                                "folder of .txt files [captions.tsv, .csv or .json in FOLDER, else .txt "
                                "files beside the clips, else file names]",
                        .type = "FILE"});
    list.add(frames, {.key = "frames",
                      .help = "frames of a motion; a power of two where a network is a CNN",
                      .range = Range::at_least(1)});
    list.add(rate, {.key = "rate", .help = "frames per second", .range = Range::above(0)});
    list.add(root_position,
             {.key = "root_position", .help = "learn the position of the root, not only its rotation"});
    list.add(root_rotation, {.key = "root_rotation",
                             .help = "heading: position and yaw, every motion starts facing the same way; "
                                     "velocity: steps and turns, for motion of any length; support: as "
                                     "velocity, of the joint that bears the body, so that feet stand; "
                                     "expmap: as the papers; auto: velocity for an RNN generator, else "
                                     "heading"});
    clips.list_fields(list);
    list.add(train_share, {.key = "train_share",
                           .help = "fraction of the clips to train on; the rest is held out for testing",
                           .range = Range::between(0, 1)});
    list.add(split_seed, {.key = "split_seed", .help = "seed of that split"});
    list.add(mirror, {.key = "mirror",
                      .help = "train on the mirror images of the clips too, with left and right exchanged "
                              "in their captions"});
    list.add(stretch, {.key = "stretch",
                       .help = "train on the clips also this much faster and slower; 0.1: by a tenth; 0: not",
                       .range = Range::between(0, 0.5),
                       .type = "SHARE"});
    list.add(balanced, {.key = "balanced",
                        .help = "draw every description equally often, instead of every clip",
                        .option = "--balance"});
  }
};

}  // namespace motiongan::motion
