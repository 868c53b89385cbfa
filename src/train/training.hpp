// A DVGAN training as the command keeps it: what train, ablate and demo share.
#pragma once
#include "motiongan/train/dvgan_trainer.hpp"
#include "shared/captioned_data.hpp"
#include "train/run_start.hpp"

namespace motiongan::command {

/// What a run is. Kept in its checkpoint, so that --resume needs none of it.
struct DvganArgs : CaptionedDataArgs {
  DvganOptions model;
  DvganTrainOptions training;

  void list_fields(FieldList& list) {
    CaptionedDataArgs::list_fields(list);
    model.list_fields(list);
    training.list_fields(list);
  }
};

/// Sets what follows from other options. Throws Error for windows that the networks cannot have.
void fill_in_choices(DvganArgs& args);

void print_model(Dvgan& model);

}  // namespace motiongan::command
