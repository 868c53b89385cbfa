// A ranker as the command keeps it: what `train ranker` writes and `evaluate` reads.
#pragma once
#include "captioned_data.hpp"
#include "motiongan/train/ranker_trainer.hpp"

namespace motiongan::command {

struct RankerArgs : CaptionedDataArgs {
  // What a run is. Kept in its checkpoint, so that --resume needs none of it.
  std::string kind = "rnn";
  RankerOptions model;
  RankerTrainOptions training;
  // What only this start of it is.
  std::string save;
  bool resume = false;
  RankerRunOptions run;
};

/// Calls f(name, member) for all that is kept, by the name of its option.
template <class F>
void each_kept(RankerArgs& a, const F& f) {
  each_kept_of_data(a, f);
  f("--ranker", a.kind);
  f("--hidden", a.model.hidden);
  f("--taps", a.model.taps);
  f("--iterations", a.training.iterations);
  f("--batch", a.training.batch);
  f("--descriptions", a.training.descriptions);
  f("--learning-rate", a.training.adam.learning_rate);
  f("--beta1", a.training.adam.beta1);
  f("--beta2", a.training.adam.beta2);
  f("--epsilon", a.training.adam.epsilon);
  f("--seed", a.training.seed);
}

/// Puts the choices that are given as words, and what follows from other options, where the library has them.
inline void fill_in(RankerArgs& a) {
  fill_in_data(a, "heading");
  a.model.kind = a.kind == "cnn" ? RankerKind::cnn : RankerKind::rnn;
  a.model.seed = a.training.seed;
  if (a.kind == "cnn")
    levels_of(a.data.frames);
  else
    require(a.data.frames >= 2, "--frames ", a.data.frames, ": expected at least 2");
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
