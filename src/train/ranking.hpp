// Options and files of a ranker's run, shared by `train ranker`, `evaluate` and `ablate dvgan`.
#pragma once
#include "motiongan/train/ranker_trainer.hpp"
#include "shared/captioned_data.hpp"
#include "train/training_size.hpp"

namespace motiongan::command {

/// The options that define a run. Its checkpoint stores them, so --resume needs none of them.
struct RankerArgs : CaptionedDataArgs {
  RankerOptions model;
  RankerTrainOptions training;

  void list_fields(FieldList& list) {
    CaptionedDataArgs::list_fields(list);
    model.list_fields(list);
    training.list_fields(list);
  }
};

/// Sets defaults that follow from other options. Throws Error if --frames does not suit the network.
inline void fill_in_choices(RankerArgs& a) {
  fill_in_data(a, motion::RootRotation::heading);
  a.model.seed = a.training.seed;
  a.training.adam.schedule.fix(a.training.iterations);
  if (a.model.kind == RankerKind::cnn)
    levels_of(a.data.frames);
  else
    require(a.data.frames >= 2, "--frames is ", a.data.frames, ", expected at least 2");
}

/// Builds a ranker and its trainer, for training_cost(). Refers to the data.
inline auto builder(const motion::Dataset& data, const RankerOptions& options) {
  return [&data, options](const Context& context, const RankerTrainOptions& training, const TrainerUse& use) {
    Ranker ranker(context, data.format, options);
    RankerTrainer trainer(ranker, data, training);
    use(trainer);
  };
}

/// The ranker file `given`, or the one in the run folder `given`.
inline fs::path ranker_file(const fs::path& given) {
  if (!fs::is_directory(given)) return given;
  const fs::path file = RunFiles{given}.network("ranker");
  require(fs::exists(file), given.string(), " holds no ", file.filename().string(),
          "; give a ranker file, or the --save folder of `motiongan train ranker`");
  return file;
}

}  // namespace motiongan::command
