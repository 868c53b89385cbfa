// motiongan: generative adversarial models of human motion over OpenCL. Everything, from the ground up.
#pragma once
#include "motiongan/core/context.hpp"
#include "motiongan/core/device.hpp"
#include "motiongan/core/error.hpp"
#include "motiongan/core/gemm.hpp"
#include "motiongan/core/random.hpp"
#include "motiongan/core/tensor.hpp"
//
#include "motiongan/autograd/grad.hpp"
#include "motiongan/autograd/var.hpp"
//
#include "motiongan/ops/elementwise.hpp"
#include "motiongan/ops/layout.hpp"
#include "motiongan/ops/lstm.hpp"
#include "motiongan/ops/matmul.hpp"
#include "motiongan/ops/reduce.hpp"
#include "motiongan/ops/rollout.hpp"
#include "motiongan/ops/taps.hpp"
//
#include "motiongan/nn/linear.hpp"
#include "motiongan/nn/lstm.hpp"
#include "motiongan/nn/module.hpp"
#include "motiongan/nn/text_encoder.hpp"
//
#include "motiongan/optim/adam.hpp"
//
#include "motiongan/motion/bvh.hpp"
#include "motiongan/motion/bvh_stream.hpp"
#include "motiongan/motion/dataset.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/procedural.hpp"
#include "motiongan/motion/resampler.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/statistics.hpp"
//
#include "motiongan/io/safetensors.hpp"
#include "motiongan/io/state_dict.hpp"
//
#include "motiongan/models/cnn_critic.hpp"
#include "motiongan/models/cnn_generator.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/dvgan_critic.hpp"
#include "motiongan/models/rnn_critic.hpp"
#include "motiongan/models/rnn_generator.hpp"
#include "motiongan/models/rnn_stream.hpp"
//
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/dvgan_trainer.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/train/train.hpp"
#include "motiongan/train/wgan_gp.hpp"
//
#include "motiongan/sample/motion_stream.hpp"
//
#include "motiongan/eval/drift.hpp"
#include "motiongan/eval/euler_error.hpp"
//
#include "motiongan/view/line_plot.hpp"
#include "motiongan/view/player.hpp"
#include "motiongan/view/pose_strip.hpp"
