// Motion of RNN models that is written while it is made: what generate and complete share.
#pragma once
#include <optional>

#include "shared/command.hpp"
#include "generate/drift_report.hpp"
#include "motiongan/sample/motion_stream.hpp"
#include "shared/show.hpp"

namespace motiongan::command {

struct StreamJob {
  std::vector<CharacterOptions> characters = {};
  std::vector<fs::path> files = {};  ///< one for each
  motion::Motion before = {};        ///< what each file begins with, at the model's rate; may have no frames
  std::size_t frames = 0;            ///< to be made of each
  double rate = 0;                   ///< of the files, by interpolation; 0: the model's
  std::size_t kept = 0;              ///< frames of each to give back, at the model's rate
};

/// Makes the motions in pieces and writes them, in memory that does not depend on their length; shows how far
/// it is where that takes a while. Gives back
/// the first frames of each, those of `before` among them; nothing where a signal asked to stop (see
/// catch_signals), and then the files are not there either.
std::optional<std::vector<motion::Motion>> write_streamed(const Dvgan& model, const StreamJob& job,
                                                          DriftReport* drift = nullptr);

/// Frames at the model's rate that make most_shown frames at `rate` (0: the model's).
std::size_t shown_frames(double model_rate, double rate);

/// What is said where a signal asked to stop, and the exit status.
int stopped(std::size_t complete);

}  // namespace motiongan::command
