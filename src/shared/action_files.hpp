// Writes position clips as BVH, GLB, FBX, VRMA, CSV or NPY files.
#pragma once
#include "motiongan/data/action_source.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/motion/position_rotations.hpp"
#include "shared/motion_files.hpp"

namespace motiongan::command {

/// Adds --format with the formats of positions too.
inline void add_clip_format_option(CLI::App& verb, std::string& format) {
  add_format_option(verb, format, {"csv", "npy"}, "; or positions as csv or npy (with a bones.tsv)");
}

/// Whether the format holds rotations.
inline bool has_rotations(const std::string& format) { return format != "csv" && format != "npy"; }

/// Writes the clip in the format of the file's extension, at `rate` (0: the clip's own). `motion` is the clip
/// with rotations, which all but CSV and NPY need.
inline void write_action_clip(const fs::path& file, const motion::PositionClip& clip,
                              const motion::Motion& motion, double rate, double unit_metres = 0,
                              const motion::GlbCharacter* character = nullptr) {
  const std::string kind = file.extension().string();
  if (has_rotations(kind.substr(1))) return write_motion(file, motion, rate, unit_metres, character);
  const motion::PositionClip own = rate > 0 ? motion::resample(clip, rate) : motion::PositionClip{};
  const motion::PositionClip& written = rate > 0 ? own : clip;
  if (kind == ".csv")
    motion::write_position_csv(file, written);
  else
    motion::write_position_npy(file, written);
}

/// Writes bones.tsv, the parents of the joints, which position files do not contain.
inline void write_bones_beside(const fs::path& folder, const motion::Skeleton& skeleton) {
  motion::write_bone_list(folder / motion::bone_list_name, skeleton);
}

}  // namespace motiongan::command
