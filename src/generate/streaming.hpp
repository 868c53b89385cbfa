// Writes the motion of RNN models while it is generated; shared by generate and complete.
#pragma once
#include <optional>

#include "generate/drift_report.hpp"
#include "motiongan/motion/clean_stream.hpp"
#include "motiongan/sample/motion_stream.hpp"
#include "shared/command.hpp"
#include "shared/retargeting.hpp"
#include "shared/show.hpp"

namespace motiongan::command {

struct StreamJob {
  std::vector<CharacterOptions> characters = {};
  std::vector<fs::path> files = {};  ///< one for each character
  motion::Motion before = {};        ///< what each file begins with, at the model's rate; may have no frames
  std::size_t frames = 0;            ///< to generate for each
  double rate = 0;                   ///< of the files, by interpolation; 0: the model's
  double scale = 1;                  ///< of the files' lengths to the model's
  std::size_t kept = 0;              ///< frames of each to return, at the model's rate
  double unit_metres = 0;            ///< metres per unit of the files; 0: unknown
  TargetBody* body = nullptr;        ///< a skeleton that what is written and returned is put on
  std::optional<motion::CleanOptions> clean = {};  ///< clean up what is written and returned
};

/// Generates the motions in pieces and writes them, in memory that does not depend on their length; shows
/// progress if that takes a while. Returns the first frames of each, including those of `before`. If a signal
/// requested a stop (see catch_signals), returns nothing and leaves no incomplete file.
std::optional<std::vector<motion::Motion>> write_streamed(const Dvgan& model, const StreamJob& job,
                                                          DriftReport* drift = nullptr);

/// Frames at the model's rate that give most_shown frames at `rate` (0: the model's).
std::size_t shown_frames(double model_rate, double rate);

/// Prints that a signal stopped the command after `complete` files. Returns the exit status.
int stopped(std::size_t complete);

}  // namespace motiongan::command
