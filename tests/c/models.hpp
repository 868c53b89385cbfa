// Small models of every kind for the tests of the C interface, and a clip to continue.
#pragma once
#include <filesystem>
#include <motiongan/data/action_dataset.hpp>
#include <motiongan/data/dataset.hpp>
#include <motiongan/formats/bvh_writer.hpp>
#include <motiongan/models/action_gan.hpp>
#include <motiongan/models/dvgan.hpp>
#include <motiongan/procedural/procedural.hpp>

namespace motiongan::testing {

/// The files that write_models() writes into a folder.
struct ModelFiles {
  std::filesystem::path folder;
  std::string rnn() const { return (folder / "rnn.safetensors").string(); }        ///< texts, frame by frame
  std::string window() const { return (folder / "window.safetensors").string(); }  ///< texts, 8 frames
  std::string classes() const { return (folder / "classes.safetensors").string(); }  ///< walk, run and jump
  std::string prior() const { return (folder / "prior.bvh").string(); }
};

/// Untrained models: their motion is small, and different for every text, class and noise.
inline void write_models(const ModelFiles& files) {
  std::filesystem::create_directories(files.folder);
  const Context context;
  auto clips = motion::procedural_motions({.clips = 17, .seconds = 4, .rate = 20});
  motion::write_bvh(files.prior(), clips[0].motion);
  const auto texts = motion::Dataset::from_motions(
      clips, {.frames = 8, .rate = 10, .root_rotation = motion::RootRotation::velocity});
  Dvgan(context, texts.format, {.generator = GeneratorKind::rnn, .hidden = 16}).save(files.rnn());
  Dvgan(context, texts.format, {.hidden = 16}).save(files.window());
  for (auto& clip : clips) clip.captions = {clip.id.substr(0, clip.id.find('_'))};
  const auto actions = motion::ActionDataset::from_motions(
      clips, {.frames = 6, .rate = 10, .train_share = 1, .classes = {"walk", "run", "jump"}});
  ActionGan(context, actions.format, {.hidden = 16, .noise_dim = 3}).save(files.classes());
}

}  // namespace motiongan::testing
