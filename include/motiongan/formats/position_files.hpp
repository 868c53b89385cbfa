// Motions as files of joint positions (CSV and NPY), for exchange with other tools and data sets.
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bone_list.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/known_skeletons.hpp"
#include "motiongan/formats/position_csv.hpp"
#include "motiongan/formats/position_npy.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

/// File name of the bone list in a folder of position files.
inline constexpr const char* bone_list_name = "bones.tsv";

/// The bone list of a position file: `bones` or, if that is empty, bones.tsv next to the file; empty if there
/// is none.
inline std::filesystem::path bone_list_of(const std::filesystem::path& file,
                                          const std::filesystem::path& bones) {
  if (!bones.empty()) return bones;
  std::error_code problem;
  std::filesystem::path beside = file.parent_path() / bone_list_name;
  return std::filesystem::exists(beside, problem) ? beside : std::filesystem::path();
}

/// The skeleton of an array of HumanML3D or KIT-ML, and their rate if `rate` is 0. Throws Error for their
/// feature vectors.
inline std::optional<Skeleton> known_skeleton_of(std::string_view npy, std::string_view name, double& rate) {
  const std::vector<std::size_t> shape = npy_detail::parse_npy_header(npy, name).shape;
  refuse_feature_vectors(shape, name);
  if (shape.size() != 3) return std::nullopt;
  std::optional<Skeleton> out = known_skeleton(shape[1]);
  if (out && rate == 0) rate = shape[1] == humanml3d_skeleton().size() ? humanml3d_rate : kit_ml_rate;
  return out;
}

/// Reads a .csv (parse_position_csv) or .npy (parse_position_npy) file, its ending in any case. `bones` is
/// its bone list (read_bone_list); if empty, `bones.tsv` next to the file is used or, for arrays of HumanML3D
/// and KIT-ML, their joints. `rate`, in frames per
/// second, is the file's; a .csv with a column `time` has its own. The clip's id is the file name without
/// extension. Throws Error for other files, for an empty one, and if there is no bone list.
inline PositionClip read_position_file(const std::filesystem::path& file, const std::filesystem::path& bones,
                                       double rate) {
  const std::string extension = extension_of(file);
  require(extension == ".csv" || extension == ".npy", file.string(), " ends in '", file.extension().string(),
          "', expected joint positions in a .csv or .npy file");
  const std::string text = read_text(file, "file of joint positions");
  require(!text.empty(), file.string(), " is empty, expected joint positions");
  const bool npy = extension == ".npy";
  const std::filesystem::path list = bone_list_of(file, bones);
  std::optional<Skeleton> known;
  if (list.empty() && npy) known = known_skeleton_of(text, file.string(), rate);
  require(!list.empty() || known, file.string(), " holds joint positions but no hierarchy, and ",
          (file.parent_path() / bone_list_name).string(),
          " does not exist: create it, or give a bone list (lines of joint <TAB> parent, - for the root)");
  const Skeleton skeleton = known ? *known : read_bone_list(list);
  PositionClip clip = npy ? parse_position_npy(text, skeleton, rate, file.string())
                          : parse_position_csv(text, skeleton, rate, file.string());
  clip.id = file.stem().string();
  return clip;
}

/// Whether the first line of a CSV names columns of positions (`Hips.x`, `Hips.y`, `Hips.z`), in contrast to
/// a log or a table: at least one column of each axis, and no fewer such columns than others.
inline bool is_position_csv(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const char line_end = position_csv_detail::line_end_of(text);
  const std::string_view header = position_csv_detail::take_line(text, line_end);
  std::vector<std::string_view> fields;
  position_csv_detail::split_fields(header, position_csv_detail::separator_of(header), fields);
  std::array<std::size_t, 3> columns{};
  for (const std::string_view field : fields)
    if (field.size() > 2 && field[field.size() - 2] == '.' && field.back() >= 'x' && field.back() <= 'z')
      ++columns[static_cast<std::size_t>(field.back() - 'x')];
  const std::size_t found = columns[0] + columns[1] + columns[2];
  return columns[0] > 0 && columns[1] > 0 && columns[2] > 0 && 2 * found >= fields.size();
}

/// A skeleton for a position file without a bone list: its joints, all children of the first. It serves to
/// say what the file holds, not to train on it.
inline Skeleton joints_without_bones(std::string_view text, bool npy, std::string_view name) {
  std::vector<std::string> names;
  if (npy) {
    const std::vector<std::size_t> shape = npy_detail::parse_npy_header(text, name).shape;
    require((shape.size() == 3 && shape[2] == 3) || (shape.size() == 2 && shape[1] % 3 == 0), name,
            ": the shape is ", shape, ", expected [frames, joints, 3] or [frames, 3 * joints]");
    const std::size_t joints = shape.size() == 3 ? shape[1] : shape[1] / 3;
    require(joints <= most_joints, name, ": the shape is ", shape, ", expected at most ", most_joints,
            " joints");
    for (std::size_t j = 0; j < joints; ++j) names.push_back(concat("joint", j));
  } else {
    const std::string_view header =
        position_csv_detail::take_line(text, position_csv_detail::line_end_of(text));
    std::vector<std::string_view> fields;
    position_csv_detail::split_fields(header, position_csv_detail::separator_of(header), fields);
    for (const std::string_view field : fields)
      if (field.ends_with(".x")) names.emplace_back(field.substr(0, field.size() - 2));
    require(names.size() <= most_joints, name, ":1: found columns of ", names.size(),
            " joints, expected at most ", most_joints);
  }
  Skeleton out;
  for (const std::string& joint : names) {
    out.joints.emplace_back();
    out.joints.back().name = joint;
    out.joints.back().parent = out.joints.size() == 1 ? -1 : 0;
  }
  return out;
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
