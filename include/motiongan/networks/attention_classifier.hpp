// The classifier of the attention WGAN-GP (Malek-Podjaski & Deligianni; SPEC 5): which class a second of
// motion is of.
#pragma once
#include "motiongan/networks/attention_block.hpp"

namespace motiongan {

struct AttentionClassifierOptions {
  std::size_t dof = 0;       ///< numbers of a pose
  std::size_t classes = 0;   ///< Y
  std::size_t hidden = 256;  ///< C
  bool attention = true;
};

class AttentionClassifier {
 public:
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

  /// One logit per class, [B, Y], of motion [T, B, dof].
  Var operator()(const Var& motion) const {
    return logits_(mean(residual_block(block1_, attend(attention_, before_attention(motion)), true), 0));
  }

  /// How much each of the T / 2 frames after Down takes from each, [B, T/2, T/2]; Error where there is none.
  Var attention_map(const Var& motion) const {
    require(attention_.has_value(), "the classifier was made without attention: there is no map of it");
    return attention_->map(before_attention(motion));
  }

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
