// A ranker as the command keeps it: what `train ranker` writes and `evaluate` reads.
#pragma once
#include "motiongan/train/ranker_trainer.hpp"
#include "shared/captioned_data.hpp"

namespace motiongan::command {

/// What a run is. Kept in its checkpoint, so that --resume needs none of it.
struct RankerArgs : CaptionedDataArgs {
  RankerOptions model;
  RankerTrainOptions training;

  void list_fields(FieldList& list) {
    CaptionedDataArgs::list_fields(list);
    model.list_fields(list);
    training.list_fields(list);
  }
};

/// Sets what follows from other options. Throws Error for windows that the network cannot have.
inline void fill_in_choices(RankerArgs& a) {
  fill_in_data(a, motion::RootRotation::heading);
  a.model.seed = a.training.seed;
  if (a.model.kind == RankerKind::cnn)
    levels_of(a.data.frames);
  else
    require(a.data.frames >= 2, "--frames is ", a.data.frames, ", expected at least 2");
}

/// The ranker's file: the one given, or the one in the folder of a run.
inline fs::path ranker_file(const fs::path& given) {
  if (!fs::is_directory(given)) return given;
  const fs::path file = RunFiles{given}.network("ranker");
  require(fs::exists(file), given.string(), " holds no ", file.filename().string(),
          "; give a ranker's file, or the --save folder of motiongan train ranker");
  return file;
}

}  // namespace motiongan::command
