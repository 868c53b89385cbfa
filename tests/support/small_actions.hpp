// A small data set of procedural motion of two classes, for the action models.
#pragma once
#include <motiongan/data/action_dataset.hpp>
#include <motiongan/nn/module.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/messages.hpp"

namespace motiongan::testing {

/// T = 6 at 10 Hz: 10 clips of about four seconds, alternating "stand" and "walk".
inline motion::ActionDataset make_small_actions(bool root_track) {
  std::vector<motion::LabelledMotion> clips;
  for (std::size_t i = 0; i < 10; ++i) {
    motion::LabelledMotion clip =
        motion::procedural_motion(i, {.clips = 10, .seconds = 4, .rate = 20, .seed = 5});
    clip.captions = {i % 2 == 0 ? "stand" : "walk"};
    clips.push_back(std::move(clip));
  }
  return motion::ActionDataset::from_motions(clips, {.frames = 6, .rate = 10, .root_track = root_track});
}

/// Those with the root's track.
inline const motion::ActionDataset& small_actions() {
  static const motion::ActionDataset data = make_small_actions(true);
  return data;
}

/// The values of all parameters, to compare two models bit for bit.
template <class Model>
std::vector<std::vector<float>> values_in(Model& model) {
  std::vector<std::vector<float>> all;
  for (const NamedParameter& p : named_parameters(model)) all.push_back(p.value->value().to_host());
  return all;
}

}  // namespace motiongan::testing
