// Options of a DVGAN run, shared by train, ablate and demo.
#pragma once
#include "motiongan/train/dvgan_trainer.hpp"
#include "shared/captioned_data.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {

/// The options that define a run. Its checkpoint stores them, so --resume needs none of them.
struct DvganArgs : CaptionedDataArgs {
  DvganOptions model;
  DvganTrainOptions training;

  void list_fields(FieldList& list) {
    CaptionedDataArgs::list_fields(list);
    model.list_fields(list);
    training.list_fields(list);
  }
};

/// Sets defaults that follow from other options. Throws Error if --frames or --completions does not suit the
/// networks.
void fill_in_choices(DvganArgs& args);

/// Builds a DVGAN and its trainer, for training_cost(). Refers to the data.
inline auto builder(const motion::Dataset& data, const DvganOptions& options) {
  return [&data, options](const Context& context, const DvganTrainOptions& training, const TrainerUse& use) {
    Dvgan model(context, data.format, options);
    DvganTrainer trainer(model, data, training);
    use(trainer);
  };
}

void print_model(Dvgan& model);

}  // namespace motiongan::command
