// motiongan: generative adversarial networks of human motion over OpenCL. Includes the whole library.
#pragma once

/// Tensors, derivatives, networks, models, training and generation.
namespace motiongan {
/// Files that hold named tensors and options.
namespace io {}
/// Clips: skeletons, rotations, files of motion, data sets, and what is done to motion.
namespace motion {}
/// The figures that the papers report.
namespace paper {}
/// Motion to look at: HTML pages and pictures.
namespace view {}
}  // namespace motiongan

#include "motiongan/version.hpp"
//
#include "motiongan/core/context.hpp"
#include "motiongan/core/device.hpp"
#include "motiongan/core/error.hpp"
#include "motiongan/core/gemm.hpp"
#include "motiongan/core/random.hpp"
#include "motiongan/core/tensor.hpp"
//
#include "motiongan/io/safetensors.hpp"
//
#include "motiongan/autograd/grad.hpp"
#include "motiongan/autograd/var.hpp"
//
#include "motiongan/ops/attention.hpp"
#include "motiongan/ops/conv1d.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/ops/elementwise.hpp"
#include "motiongan/ops/gru_rollout.hpp"
#include "motiongan/ops/layout.hpp"
#include "motiongan/ops/lstm.hpp"
#include "motiongan/ops/matmul.hpp"
#include "motiongan/ops/reduce.hpp"
#include "motiongan/ops/rollout.hpp"
//
#include "motiongan/nn/gru.hpp"
#include "motiongan/nn/linear.hpp"
#include "motiongan/nn/lstm.hpp"
#include "motiongan/nn/module.hpp"
#include "motiongan/nn/self_attention.hpp"
#include "motiongan/nn/state_dict.hpp"
#include "motiongan/nn/text_encoder.hpp"
//
#include "motiongan/optim/adam.hpp"
#include "motiongan/optim/sgd.hpp"
//
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/clean_stream.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/position_rotations.hpp"
#include "motiongan/motion/resampler.hpp"
#include "motiongan/motion/retarget.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/untwist.hpp"
//
#include "motiongan/formats/amass.hpp"
#include "motiongan/formats/amc.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/bvh_stream.hpp"
#include "motiongan/formats/expmap_text.hpp"
#include "motiongan/formats/glb.hpp"
#include "motiongan/formats/glb_character.hpp"
#include "motiongan/formats/known_skeletons.hpp"
#include "motiongan/formats/position_files.hpp"
#include "motiongan/formats/read_motion.hpp"
#include "motiongan/formats/vrma.hpp"
//
#include "motiongan/data/action_dataset.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/data/descriptions.hpp"
//
#include "motiongan/procedural/procedural.hpp"
//
#include "motiongan/metrics/bone_length_error.hpp"
#include "motiongan/metrics/diversity.hpp"
#include "motiongan/metrics/drift.hpp"
#include "motiongan/metrics/euler_error.hpp"
#include "motiongan/metrics/foot_skate.hpp"
#include "motiongan/metrics/frechet_distance.hpp"
#include "motiongan/metrics/inception_score.hpp"
#include "motiongan/metrics/jerk.hpp"
#include "motiongan/metrics/joint_angle.hpp"
#include "motiongan/metrics/mean_std.hpp"
#include "motiongan/metrics/motion_quality.hpp"
#include "motiongan/metrics/npss.hpp"
#include "motiongan/metrics/position_metrics.hpp"
#include "motiongan/metrics/retrieval.hpp"
#include "motiongan/metrics/statistics.hpp"
#include "motiongan/metrics/symmetric_eigenvalues.hpp"
//
#include "motiongan/networks/attention_classifier.hpp"
#include "motiongan/networks/attention_critic.hpp"
#include "motiongan/networks/attention_generator.hpp"
#include "motiongan/networks/attention_rollout.hpp"
#include "motiongan/networks/cnn_critic.hpp"
#include "motiongan/networks/cnn_generator.hpp"
#include "motiongan/networks/cnn_ranker.hpp"
#include "motiongan/networks/cnn_trunk.hpp"
#include "motiongan/networks/difference_lstm.hpp"
#include "motiongan/networks/dvgan_critic.hpp"
#include "motiongan/networks/erd.hpp"
#include "motiongan/networks/lstm_3lr.hpp"
#include "motiongan/networks/lstm_baseline.hpp"
#include "motiongan/networks/rnn_critic.hpp"
#include "motiongan/networks/rnn_generator.hpp"
#include "motiongan/networks/rnn_ranker.hpp"
#include "motiongan/networks/rnn_stream.hpp"
#include "motiongan/networks/seq2seq.hpp"
#include "motiongan/networks/world_view.hpp"
//
#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/action_starts.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/prediction_model.hpp"
#include "motiongan/models/ranker.hpp"
#include "motiongan/models/shipped_models.hpp"
//
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/dvgan_trainer.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/train/ranker_trainer.hpp"
#include "motiongan/train/saved_critic.hpp"
#include "motiongan/train/train.hpp"
#include "motiongan/train/training_cost.hpp"
#include "motiongan/train/wgan_gp.hpp"
//
#include "motiongan/sample/action_generate.hpp"
#include "motiongan/sample/action_stream.hpp"
#include "motiongan/sample/character_stream.hpp"
#include "motiongan/sample/motion_stream.hpp"
//
#include "motiongan/direct/action_direct.hpp"
#include "motiongan/direct/between.hpp"
#include "motiongan/direct/checks.hpp"
#include "motiongan/direct/constraints.hpp"
#include "motiongan/direct/direct.hpp"
#include "motiongan/direct/errors.hpp"
#include "motiongan/direct/exact.hpp"
#include "motiongan/direct/pace.hpp"
#include "motiongan/direct/path.hpp"
#include "motiongan/direct/path_file.hpp"
//
#include "motiongan/search/collection.hpp"
#include "motiongan/search/distance.hpp"
#include "motiongan/search/index.hpp"
#include "motiongan/search/ranking.hpp"
#include "motiongan/search/windows.hpp"
//
#include "motiongan/experiments/action_ablation.hpp"
#include "motiongan/experiments/action_evaluation.hpp"
#include "motiongan/experiments/augmentation_study.hpp"
#include "motiongan/experiments/completion_models.hpp"
#include "motiongan/experiments/completion_protocol.hpp"
#include "motiongan/experiments/completion_table.hpp"
#include "motiongan/experiments/dvgan_ablation.hpp"
#include "motiongan/experiments/model_evaluation.hpp"
#include "motiongan/experiments/numpy_random.hpp"
#include "motiongan/experiments/paper_tables.hpp"
#include "motiongan/experiments/ranker_evaluation.hpp"
//
#include "motiongan/view/heat_map.hpp"
#include "motiongan/view/line_plot.hpp"
#include "motiongan/view/player.hpp"
#include "motiongan/view/pose_strip.hpp"
