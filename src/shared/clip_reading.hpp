// Reading motion files for the verbs: their options, notes on stderr, and lists of files that cannot be read.
#pragma once
#include <functional>

#include "motiongan/data/dataset.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "shared/options.hpp"

namespace motiongan::command {

/// What a verb that takes clips says of its arguments.
inline constexpr const char* clip_files_help =
    "motion files (BVH, GLB, FBX, AMC, NPZ, NPY, CSV; moves.glb#walk: one animation of several), or folders "
    "of "
    "them";

/// Adds --up, --scale, --fps, --first-frame and --bones; with `folders` also --skip-bad.
void add_reading_options(CLI::App& verb, motion::ClipOptions& options, bool folders);

/// Prints notes to stderr, the first ten of them.
void print_notes(const std::vector<std::string>& notes);

/// Names files that were left out, the first ten of them, on stderr.
void print_skipped(const std::vector<motion::SkippedClip>& clips);

/// Reads one file and prints its notes. If `space` is that of a model whose clips had z up, so has a file
/// that does not tell.
motion::LoadedMotion read_clip(const fs::path& file, const motion::ClipOptions& options,
                               const motion::ClipSpace& space = {});

/// Calls use(file, id, motion) for each motion file of `where`, in order. Throws Error listing all files that
/// cannot be read, unless options.skip_bad; then they are named on stderr.
void for_each_clip(
    const fs::path& where, const motion::ClipOptions& options,
    const std::function<void(const fs::path& file, const std::string& id, motion::LoadedMotion&&)>& use);

/// Scales a Motion or PositionClip to a model's size by leg length if it differs by more than half, and says
/// so; returns the factor. `what` names the motion: "the prior walk.bvh".
template <class Clip>
double scale_to_model(Clip& clip, const motion::Skeleton& model, const std::string& what) {
  const double factor = motion::scale_to(model, clip.skeleton);
  if (factor == 1) return 1;
  fmt::print(stderr, "motiongan: {} is scaled by {} to the model's size, by leg length\n", what,
             brief(factor));
  clip = motion::scaled(std::move(clip), factor);
  return factor;
}

/// The same for a set of motions, each by its own factor; says how many were scaled.
void scale_all_to(const motion::Skeleton& model, std::vector<motion::Motion>& motions,
                  const std::string& what);

}  // namespace motiongan::command
