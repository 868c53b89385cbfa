// The critics of runs, to score motions with.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/io/fields_json.hpp"
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/dvgan_trainer.hpp"

namespace motiongan {

namespace detail {

/// The options that a run was trained with, from its checkpoint.
template <class TrainOptions>
TrainOptions saved_training(const io::SafeTensors& file, const std::string& where) {
  TrainOptions options;
  io::fields_from_text(fields_of(options), checkpoint_text(file, "training", where), where);
  return options;
}

}  // namespace detail

/// The critic that a text-conditioned model was trained with, from the run's checkpoint: of two motions of a
/// text it scores the one higher that looks more like the clips.
class SavedCritic {
 public:
  /// Throws Error, naming the file, if it is no checkpoint of this model's run.
  SavedCritic(const Dvgan& model, const std::filesystem::path& checkpoint)
      : SavedCritic(model, io::SafeTensors::read(checkpoint), checkpoint.string()) {}

  /// Scores of normalised motion [N or more frames, B, dof], of which the last N frames count, for its texts:
  /// [B].
  std::vector<float> operator()(const Var& motion, const Sentences& text) const {
    const NoGrad values_only;
    require(motion.dim(0) >= frames_, "the critic scores motion of ", frames_, " frames, found ",
            motion.dim(0));
    const Var seen = sees_(slice(motion, 0, motion.dim(0) - frames_, frames_));
    return critic_(seen, critic_.encode_text(text)).value().to_host();
  }

 private:
  SavedCritic(const Dvgan& model, const io::SafeTensors& file, const std::string& where)
      : frames_(model.format().frames),
        options_(detail::saved_training<DvganTrainOptions>(file, where).critic),
        sees_(model.context(), model.format(), options_.sees),
        critic_(Initializer(model.context(), 1), critic_sizes(model, sees_.size()), options_) {
    io::load_parameters(named_parameters(critic_), file, where, "critic.");
  }

  std::size_t frames_;
  DvganCriticOptions options_;
  CriticView sees_;
  DvganCritic critic_;
};

/// The critic that a class-conditioned model was trained with: of two motions it scores the one higher that
/// looks more like the clips.
class SavedActionCritic {
 public:
  /// Throws Error, naming the file, if it is no checkpoint of this model's run.
  SavedActionCritic(const ActionGan& model, const std::filesystem::path& checkpoint)
      : SavedActionCritic(model, io::SafeTensors::read(checkpoint), checkpoint.string()) {}

  /// Scores of a second and the next one, normalised [2T, B, dof], for the classes [B, Y]: [B].
  std::vector<float> operator()(const Var& pairs, const Var& classes) const {
    const NoGrad values_only;
    const Var seen = detail::critic_view(bones_, options_, pairs);
    return critic_(seen, options_.critic_classes ? classes : Var()).value().to_host();
  }

 private:
  SavedActionCritic(const ActionGan& model, const io::SafeTensors& file, const std::string& where)
      : options_(detail::saved_training<AttentionTrainOptions>(file, where)),
        bones_(model.context(), model.format()),
        critic_(Initializer(model.context(), 1), detail::critic_sizes(model, bones_, options_)) {
    io::load_parameters(named_parameters(critic_), file, where, "critic.");
  }

  AttentionTrainOptions options_;
  Bones bones_;
  AttentionCritic critic_;
};

}  // namespace motiongan
