// Writes position clips as BVH, CSV or NPY files.
#pragma once
#include "motiongan/data/action_source.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/motion/position_rotations.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Adds --format.
inline void add_format_option(CLI::App& verb, std::string& format) {
  verb.add_option("--format", format, "file format: bvh, or positions as csv or npy (with a bones.tsv)")
      ->check(CLI::IsMember({"bvh", "csv", "npy"}))
      ->capture_default_str();
}

/// Writes the clip in the format of the file's extension, at `rate` (0: the clip's own). `motion` is the clip
/// with rotations; only BVH needs it.
inline void write_action_clip(const fs::path& file, const motion::PositionClip& clip,
                              const motion::Motion& motion, double rate) {
  const std::string kind = file.extension().string();
  if (kind == ".bvh") return motion::write_bvh(file, rate > 0 ? motion::resample(motion, rate) : motion);
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
