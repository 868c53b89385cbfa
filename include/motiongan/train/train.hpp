// Training every kind of model from start to end: train(model, data, options, run).
#pragma once
#include "motiongan/train/attention_trainer.hpp"
#include "motiongan/train/baseline_trainer.hpp"
#include "motiongan/train/dvgan_trainer.hpp"
#include "motiongan/train/prediction_trainer.hpp"
#include "motiongan/train/ranker_trainer.hpp"
