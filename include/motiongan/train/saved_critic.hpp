// The critic of a run, to score motions with.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/io/fields_json.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/dvgan_trainer.hpp"

namespace motiongan {

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
        options_(options_of(file, where)),
        sees_(model.context(), model.format(), options_.sees),
        critic_(Initializer(model.context(), 1), critic_sizes(model, sees_.size()), options_) {
    io::load_parameters(named_parameters(critic_), file, where, "critic.");
  }

  static DvganCriticOptions options_of(const io::SafeTensors& file, const std::string& where) {
    DvganTrainOptions options;
    io::fields_from_text(fields_of(options), detail::checkpoint_text(file, "training", where), where);
    return options.critic;
  }

  std::size_t frames_;
  DvganCriticOptions options_;
  CriticView sees_;
  DvganCritic critic_;
};

}  // namespace motiongan
