// The classifier of the attention WGAN-GP (Malek-Podjaski & Deligianni).
#pragma once
#include "motiongan/networks/attention_block.hpp"

namespace motiongan {

/// Options of an AttentionClassifier.
struct AttentionClassifierOptions {
  std::size_t dof = 0;       ///< values per pose
  std::size_t classes = 0;   ///< Y, the number of classes
  std::size_t hidden = 256;  ///< C, hidden width
  bool attention = true;     ///< false: the paper's ablation
};

/// Predicts the class of a motion: `encode` -> `block.0` -> pooling -> `attention` -> `block.1` -> ReLU ->
/// mean over frames -> `logits`.
class AttentionClassifier {
 public:
  /// Throws Error if dof, classes or hidden is 0.
  AttentionClassifier(Initializer init, const AttentionClassifierOptions& options) : options_(options) {
    require(options.dof > 0 && options.classes > 0 && options.hidden > 0,
            "AttentionClassifier: dof, classes and hidden must be positive");
    encode_ = Conv1d(init, options.dof, options.hidden, 3);
    block0_ = Residual(init, options.hidden, 3);
    if (options.attention) attention_ = SelfAttention(init, options.hidden);
    block1_ = Residual(init, options.hidden, 3);
    logits_ = Linear(init, options.hidden, options.classes);
  }

  const AttentionClassifierOptions& options() const { return options_; }

  /// Class logits [B, Y] of normalised motion [T, B, dof], T >= 2. Throws Error for any other shape.
  Var operator()(const Var& motion) const {
    return logits_(mean(residual_block(block1_, attend(attention_, before_attention(motion)), true), 0));
  }

  /// Attention weights [B, T/2, T/2] of the frames after pooling: row j is what frame j attends to. Throws
  /// Error if the model has no attention.
  Var attention_map(const Var& motion) const {
    require(attention_.has_value(), "the classifier was made without attention and has no attention map");
    return attention_->map(before_attention(motion));
  }

  /// The attention layer; empty in the ablation without it.
  const std::optional<SelfAttention>& attention() const { return attention_; }

  void list_parameters(ParameterList& list) {
    list.add_module("encode", encode_);
    list.add_module("block.0", block0_);
    if (attention_) list.add_module("attention", *attention_);
    list.add_module("block.1", block1_);
    list.add_module("logits", logits_);
  }

 private:
  Var before_attention(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(2) == options_.dof && motion.dim(0) >= 2,
            "AttentionClassifier: motion ", motion.shape(), ", expected [2 or more frames, batch, ",
            options_.dof, "]");
    return residual_block_down(block0_, encode_(motion));
  }

  AttentionClassifierOptions options_;
  Conv1d encode_;
  Residual block0_, block1_;
  std::optional<SelfAttention> attention_;
  Linear logits_;
};

}  // namespace motiongan
