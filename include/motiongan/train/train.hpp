// train(model, data, options, run) for every kind of model.
#pragma once
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "motiongan/train/dvgan_trainer.hpp"
#include "motiongan/train/prediction_trainer.hpp"
#include "motiongan/train/ranker_trainer.hpp"
