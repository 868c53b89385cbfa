// Options of an ActionDataset.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/formats/clip_options.hpp"

namespace motiongan::motion {

/// Options of an ActionDataset. Labels come from one source: `labels`, `folders` or a `pattern` with {label}.
/// Subjects are needed only with `by_subject` or `test_subjects`; they come from a pattern with {subject},
/// else from the text before the first '_' of the clip's name.
struct ActionDatasetOptions {
  std::size_t frames = 30;                   ///< T: a window is a prior and a future of T frames each
  double rate = 30;                          ///< frames per second
  std::filesystem::path labels{};            ///< file of lines `clip id <TAB> label`
  std::string pattern{};                     ///< for file names, see NamePattern
  bool folders = false;                      ///< whether a clip's folder is its label
  bool root_track = true;                    ///< whether poses include the root's steps, height and turns
  double train_share = 0.67;                 ///< fraction of the clips; the rest is for testing
  bool by_subject = false;                   ///< whether all clips of a subject go to the same part
  std::vector<std::string> test_subjects{};  ///< these, and only these, are for testing
  std::uint64_t split_seed = 1;              ///< decides which clips are for testing
  ClipOptions clips{};                       ///< how the files are read
  std::vector<std::string> classes{};        ///< keep only clips of these; empty: all

  void list_fields(FieldList& list) {
    list.add(
        labels,
        {.key = "labels", .help = "file of lines `clip id <TAB> label` [FOLDER/labels.tsv]", .type = "FILE"});
    list.add(folders, {.key = "folders", .help = "a clip's label is its folder below FOLDER"});
    list.add(pattern, {.key = "pattern",
                       .help = "for file names without extension: {label}, {subject}, * and text, such as "
                               "*_{label}_*",
                       .type = "PATTERN"});
    list.add(classes, {.key = "classes", .help = "keep only clips of these labels [all]", .type = "A,B"});
    clips.list_fields(list);
    list.add(by_subject, {.key = "by_subject",
                          .help = "all clips of a subject go to the same part (subject: by --pattern, else "
                                  "the name up to its first _)",
                          .option = "--subjects"});
    list.add(test_subjects, {.key = "test_subjects",
                             .help = "hold out these subjects, and only these, for testing",
                             .type = "A,B"});
    list.add(train_share, {.key = "train_share",
                           .help = "fraction of the clips to train on; the rest is held out for testing",
                           .range = Range::between(0, 1)});
    list.add(split_seed, {.key = "split_seed", .help = "seed of that split"});
    list.add(frames, {.key = "frames",
                      .help = "T: frames of the given prior, and of what is generated at once",
                      .range = Range::at_least(1)});
    list.add(rate, {.key = "rate", .help = "frames per second", .range = Range::above(0)});
    list.add(root_track, {.key = "root_track",
                          .help = "learn steps, turns and height of the root, so that characters travel",
                          .option = "--root"});
  }
};

}  // namespace motiongan::motion
