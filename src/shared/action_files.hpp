// Clips of positions as files: BVH, CSV or NPY.
#pragma once
#include "shared/command.hpp"
#include "motiongan/data/action_source.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/motion/position_rotations.hpp"

namespace motiongan::command {

/// Adds --format.
inline void add_format_option(CLI::App& verb, std::string& format) {
  verb.add_option("--format", format, "of the files: bvh, or positions as csv or npy (with a bones.tsv)")
      ->check(CLI::IsMember({"bvh", "csv", "npy"}))
      ->capture_default_str();
}

/// Writes the clip as its name ends, at `rate` (0: as it is). `motion` is the clip with rotations, for BVH.
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

/// Positions do not say how joints hang together: writes that beside them.
inline void write_bones_beside(const fs::path& folder, const motion::Skeleton& skeleton) {
  motion::write_bone_list(folder / motion::bone_list_name, skeleton);
}

}  // namespace motiongan::command
