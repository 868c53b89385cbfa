// Whole clips from an attention model: by a schedule of classes, or as synthetic counterparts of real clips.
#pragma once
#include "motiongan/data/action_schedule.hpp"
#include "motiongan/sample/action_stream.hpp"

namespace motiongan {

/// The schedule in pieces of at most `most` frames each, as a model makes them.
inline ActionSchedule steps_of(const ActionSchedule& schedule, std::size_t most) {
  ActionSchedule out;
  for (const ActionPiece& piece : schedule)
    for (std::size_t left = piece.frames; left > 0; left -= out.back().frames)
      out.push_back({piece.label, std::min(left, most)});
  return out;
}

inline std::vector<motion::PositionClip> ActionGan::generate(const std::vector<ActionPrior>& priors,
                                                             const ActionSchedule& schedule,
                                                             const ActionGenerateOptions& options) const {
  require(frames_of(schedule) > 0, "the schedule has no frames, expected at least 1");
  ActionStream stream(*this);
  std::vector<ActionCharacterOptions> characters;
  std::vector<motion::PositionClip> clips;
  for (std::size_t i = 0; i < priors.size(); ++i) {
    const ActionPrior& prior = priors[i];
    characters.push_back({.prior = &prior,
                          .label = schedule.front().label,
                          .seed = options.seed,
                          .sample = options.first_sample + static_cast<std::uint32_t>(i)});
    clips.push_back({prior.id, prior.skeleton, format_.rate, 0, {}});
    if (options.with_prior) clips.back().frames = format_.frames, clips.back().positions = prior.positions;
  }
  const std::vector<ActionStream::Id> ids = stream.add(characters);
  for (const ActionPiece& piece : steps_of(schedule, format_.frames)) {
    for (const ActionStream::Id id : ids) stream.set_class(id, piece.label);
    stream.step(piece.frames);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const motion::PositionClip made = stream.clip(ids[i]);
      clips[i].frames += made.frames;
      clips[i].positions.insert(clips[i].positions.end(), made.positions.begin(), made.positions.end());
    }
  }
  return clips;
}

inline std::vector<motion::PositionClip> ActionGan::generate(const std::vector<ActionPrior>& priors,
                                                             std::string_view schedule,
                                                             const ActionGenerateOptions& options) const {
  return generate(priors, parse_action_schedule(schedule, format_), options);
}

inline std::vector<motion::PositionClip> ActionGan::generate(std::string_view schedule, std::size_t count,
                                                             const ActionGenerateOptions& options) const {
  const ActionSchedule parsed = parse_action_schedule(schedule, format_);
  std::vector<ActionPrior> priors;
  for (std::size_t i = 0; i < count; ++i) {
    const ActionStart* const own = start(parsed.front().label, options.first_sample + i);
    require(own != nullptr, "the model keeps no motion to continue; give priors (see prior_from)");
    priors.push_back(own->prior);
  }
  return generate(priors, parsed, options);
}

/// A clip of which all but the first T frames are generated.
struct SyntheticClip {
  motion::PositionClip clip;  ///< as long as the real clip, with the real first T frames
  std::size_t label = 0;      ///< index of its class
};

/// Generates a synthetic clip for each of `clips` of `data`, with the same prior, class and length. If the
/// model's format has no root channels, the root follows the real clip. Throws Error if the model lacks a
/// class of the data or has another skeleton.
inline std::vector<SyntheticClip> synthesise(const ActionGan& model, const motion::ActionDataset& data,
                                             std::span<const motion::ActionClip> clips,
                                             std::uint64_t seed = 1, std::uint32_t first_sample = 0) {
  const motion::PositionFormat& format = model.format();
  const std::size_t frames = format.frames;
  ActionStream stream(model);
  std::map<ActionStream::Id, std::size_t> numbers;  // clip number of the characters still in progress
  std::vector<SyntheticClip> out;
  std::vector<std::size_t> lengths;
  std::vector<std::vector<motion::RootTrack>> places;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const motion::PositionClip real = data.clip(clips[i]);
    const ActionPrior prior = prior_from(real, format);
    const std::size_t label = format.class_index(data.format.classes[clips[i].label]);
    const auto at_rate =
        std::abs(real.rate / format.rate - 1) < 1e-6 ? real : motion::resample(real, format.rate);
    out.push_back({{real.id, real.skeleton, format.rate, frames, prior.positions}, label});
    lengths.push_back(at_rate.frames);
    places.push_back(format.layout.root_track() ? std::vector<motion::RootTrack>{}
                                                : format.layout.places(at_rate.positions));
    if (lengths.back() > frames)
      numbers[stream.add({.prior = &prior,
                          .label = label,
                          .seed = seed,
                          .sample = first_sample + static_cast<std::uint32_t>(i)})] = i;
  }
  while (!numbers.empty()) {
    stream.step();
    for (auto at = numbers.begin(); at != numbers.end();) {
      const std::size_t i = at->second;
      motion::PositionClip& clip = out[i].clip;
      const std::size_t kept = std::min(frames, lengths[i] - clip.frames);
      const std::vector<motion::Vec3> made =
          places[i].empty() ? stream.clip(at->first).positions
                            : format.restore(stream.poses(at->first).first(kept * format.dof()),
                                             std::span(places[i]).subspan(clip.frames, kept));
      clip.positions.insert(clip.positions.end(), made.begin(),
                            made.begin() + static_cast<std::ptrdiff_t>(kept * clip.skeleton.size()));
      clip.frames += kept;
      if (clip.frames < lengths[i]) {
        ++at;
        continue;
      }
      stream.remove(at->first);
      at = numbers.erase(at);
    }
  }
  return out;
}

}  // namespace motiongan
