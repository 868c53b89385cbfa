// What a data set of classes is made of, and how.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/data/first_frame.hpp"

namespace motiongan::motion {

/// What a data set of classes is made of, and how. Labels come from one place: `labels`, `folders` or a
/// `pattern` with {label}. Subjects come from a pattern with {subject}, else from the text before the first
/// '_' of the clip's name; they are asked for with `by_subject` or `test_subjects`.
struct ActionDatasetOptions {
  std::size_t frames = 30;                   ///< T: a window is a prior and a future of T frames each
  double rate = 30;                          ///< frames per second
  std::filesystem::path labels{};            ///< file of lines `clip id <TAB> label`
  std::string pattern{};                     ///< of file names, see NamePattern
  bool folders = false;                      ///< whether the folder that a clip lies in is its label
  bool root_track = true;                    ///< whether steps, height and turns are part of a pose
  double train_share = 0.67;                 ///< of the clips; the rest is for testing
  bool by_subject = false;                   ///< whether all clips of a subject go to the same part
  std::vector<std::string> test_subjects{};  ///< these, and only these, are for testing
  std::uint64_t split_seed = 1;
  FirstFrame first_frame = FirstFrame::automatic;  ///< for BVH files
  std::filesystem::path bones{};       ///< bone list for .csv and .npy files; empty: the one beside them
  std::vector<std::string> classes{};  ///< keep only clips of these; empty: of all
};

}  // namespace motiongan::motion
