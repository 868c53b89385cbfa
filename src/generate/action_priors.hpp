// Priors, the seconds of motion that an attention model continues: read from files, or drawn from a run's
// clips.
#pragma once
#include "motiongan/models/action_gan.hpp"
#include "shared/action_data.hpp"

namespace motiongan::command {

struct GivenPrior {
  ActionPrior prior;
  std::vector<motion::Quat> reference;  ///< [joints], joint rotations at its end; empty if the file has none
  std::string from;                     ///< for messages: "07_01 from 1.5 s on"
};

/// Reads the second of motion that starts `seconds` into the clip, counted after a T-pose at its start.
GivenPrior read_prior(const fs::path& file, const motion::PositionFormat& format, const ActionDataArgs& data,
                      double seconds);

/// Seconds that the model keeps, see ActionGan::start(); empty if it keeps none.
std::vector<GivenPrior> kept_priors(const ActionGan& model, std::size_t label, std::size_t first_sample,
                                    std::size_t count);

/// Draws priors from the clips that the run held out for testing (split.tsv), of class `label` if there are
/// any; prints a note if others must be used. The prior of a sample depends only on seed and sample.
std::vector<GivenPrior> draw_priors(const fs::path& run, const motion::PositionFormat& format,
                                    const ActionDataArgs& data, std::size_t label, std::uint64_t seed,
                                    std::size_t first_sample, std::size_t count);

/// A line of a run's split.tsv: a clip's id and class, and whether it was trained on or held out.
struct SplitLine {
  bool train = false;
  std::string id, label;
};
std::vector<SplitLine> read_split(const fs::path& file);

}  // namespace motiongan::command
