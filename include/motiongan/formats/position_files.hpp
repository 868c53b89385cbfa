// Motions as files of joint positions (CSV and NPY), for exchange with other tools and data sets.
#pragma once
#include <filesystem>
#include <string>
#include <system_error>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bone_list.hpp"
#include "motiongan/formats/position_csv.hpp"
#include "motiongan/formats/position_npy.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

/// File name of the bone list in a folder of position files.
inline constexpr const char* bone_list_name = "bones.tsv";

/// Reads a .csv (parse_position_csv) or .npy (parse_position_npy) file. `bones` is its bone list
/// (read_bone_list); if empty, `bones.tsv` next to the file is used. `rate`, in frames per second, is the
/// file's; a .csv with a column `time` has its own. The clip's id is the file name without extension. Throws
/// Error for other files, and if there is no bone list.
inline PositionClip read_position_file(const std::filesystem::path& file, const std::filesystem::path& bones,
                                       double rate) {
  const std::string extension = file.extension().string();
  require(extension == ".csv" || extension == ".npy", file.string(), " ends in '", extension,
          "', expected joint positions in a .csv or .npy file");
  std::filesystem::path list = bones;
  if (list.empty()) {
    std::error_code problem;
    list = file.parent_path() / bone_list_name;
    require(std::filesystem::exists(list, problem), file.string(), " holds joint positions but no ",
            "hierarchy, and ", list.string(),
            " does not exist: create it, or give a bone list (lines of joint <TAB> parent, - for the root)");
  }
  const Skeleton skeleton = read_bone_list(list);
  const std::string text = read_text(file, "file of joint positions");
  PositionClip clip = extension == ".csv" ? parse_position_csv(text, skeleton, rate, file.string())
                                          : parse_position_npy(text, skeleton, rate, file.string());
  clip.id = file.stem().string();
  return clip;
}

/// Writes format_position_csv(clip); `path` never holds a partial file.
inline void write_position_csv(const std::filesystem::path& path, const PositionClip& clip) {
  write_text_atomically(path, format_position_csv(clip));
}

/// Writes format_position_npy(clip); `path` never holds a partial file.
inline void write_position_npy(const std::filesystem::path& path, const PositionClip& clip) {
  write_text_atomically(path, format_position_npy(clip));
}

}  // namespace motiongan::motion
