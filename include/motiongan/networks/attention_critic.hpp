// The critic of the attention WGAN-GP (Malek-Podjaski & Deligianni).
#pragma once
#include "motiongan/networks/attention_block.hpp"

namespace motiongan {

/// Options of an AttentionCritic.
struct AttentionCriticOptions {
  std::size_t dof = 0;       ///< values per pose
  std::size_t hidden = 256;  ///< C, hidden width
  std::size_t classes = 0;   ///< Y for a class-conditional critic; 0: unconditional, as in the paper
  bool attention = true;     ///< false: the paper's ablation
};

/// Scores a prior and its future, concatenated in time: `encode` -> `block.0` -> pooling -> `attention` ->
/// `block.1` -> pooling -> `block.2` -> ReLU -> mean over frames -> `score`.
class AttentionCritic {
 public:
  /// Throws Error if dof or hidden is 0.
  AttentionCritic(Initializer init, const AttentionCriticOptions& options) : options_(options) {
    require(options.dof > 0 && options.hidden > 0, "AttentionCritic: dof and hidden must be positive");
    encode_ = Conv1d(init, options.dof + options.classes, options.hidden, 3);
    block0_ = Residual(init, options.hidden, 3);
    if (options.attention) attention_ = SelfAttention(init, options.hidden);
    block1_ = Residual(init, options.hidden, 3);
    block2_ = Residual(init, options.hidden, 3);
    score_ = Linear(init, options.hidden, 1);
  }

  const AttentionCriticOptions& options() const { return options_; }

  /// One score per sample, [B], of normalised motion [2T, B, dof], at least 4 frames. `classes` [B, Y]
  /// (one-hot) are required if the options give a number of classes, and not accepted otherwise. Throws Error
  /// for any other shape.
  Var operator()(const Var& motion, const Var& classes = {}) const {
    const Var h = residual_block_down(block1_, attend(attention_, before_attention(motion, classes)));
    return reshape(score_(mean(residual_block(block2_, h, true), 0)), {motion.dim(1)});
  }

  /// Attention weights [B, T, T] of the T frames after the first pooling: row j is what frame j attends to.
  /// Throws Error if the model has no attention.
  Var attention_map(const Var& motion, const Var& classes = {}) const {
    require(attention_.has_value(), "the critic was made without attention and has no attention map");
    return attention_->map(before_attention(motion, classes));
  }

  /// The attention layer; empty in the ablation without it.
  const std::optional<SelfAttention>& attention() const { return attention_; }

  void list_parameters(ParameterList& list) {
    list.add_module("encode", encode_);
    list.add_module("block.0", block0_);
    if (attention_) list.add_module("attention", *attention_);
    list.add_module("block.1", block1_);
    list.add_module("block.2", block2_);
    list.add_module("score", score_);
  }

 private:
  Var before_attention(const Var& motion, const Var& classes) const {
    require(motion.value().rank() == 3 && motion.dim(2) == options_.dof && motion.dim(0) >= 4,
            "AttentionCritic: motion ", motion.shape(), ", expected [4 or more frames, batch, ", options_.dof,
            "]");
    require(classes.empty() ? options_.classes == 0 : classes.dim(1) == options_.classes,
            "AttentionCritic: ", classes.empty() ? 0 : classes.dim(1), " classes, expected ",
            options_.classes);
    return residual_block_down(block0_,
                               encode_(classes.empty() ? motion : with_constant_channels(motion, classes)));
  }

  AttentionCriticOptions options_;
  Conv1d encode_;
  Residual block0_, block1_, block2_;
  std::optional<SelfAttention> attention_;
  Linear score_;
};

}  // namespace motiongan
