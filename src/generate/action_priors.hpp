// Seconds of motion that an attention model goes on from: of files, or drawn from the clips of its training.
#pragma once
#include "shared/action_data.hpp"
#include "motiongan/sample/action_prior.hpp"

namespace motiongan::command {

struct GivenPrior {
  ActionPrior prior;
  std::vector<motion::Quat>
      reference;     ///< [joints], the joints' rotations at its end; none where none are known
  std::string from;  ///< for people: "07_01 from 1.5 s on"
};

/// The second of the clip in `file` from `seconds` on, counted after T-poses at its start.
GivenPrior read_prior(const fs::path& file, const motion::PositionFormat& format, const ActionDataArgs& data,
                      double seconds);

/// Draws priors from the clips that the run in `run` (its split.tsv) kept for testing, of class `label` where
/// there are such; says so where others must do. The prior of a sample depends on seed and sample alone.
std::vector<GivenPrior> draw_priors(const fs::path& run, const motion::PositionFormat& format,
                                    const ActionDataArgs& data, std::size_t label, std::uint64_t seed,
                                    std::size_t first_sample, std::size_t count);

/// The ids of the clips that a run trained on, or kept for testing, with their classes; from its split.tsv.
struct SplitLine {
  bool train = false;
  std::string id, label;
};
std::vector<SplitLine> read_split(const fs::path& file);

}  // namespace motiongan::command
