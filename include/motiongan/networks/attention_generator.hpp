// The generator of the attention WGAN-GP (Malek-Podjaski & Deligianni).
#pragma once
#include "motiongan/networks/attention_block.hpp"
#include "motiongan/networks/bones.hpp"

namespace motiongan {

/// Options of an AttentionGenerator.
struct AttentionGeneratorOptions {
  std::size_t dof = 0;        ///< values per pose
  std::size_t classes = 0;    ///< Y, the number of classes
  std::size_t hidden = 256;   ///< C, hidden width
  std::size_t noise_dim = 0;  ///< noise values per sample, next to the class; the paper has none
  bool attention = true;      ///< false: the paper's ablation
  bool continues = false;     ///< the output is added to the prior's last frame, fading; the paper: no
};

/// Maps one second of motion and a class to the next second: `encode` -> `block.0` -> `attention` ->
/// `block.1` -> ReLU -> `decode`.
class AttentionGenerator {
 public:
  /// With `bones`, generated bones are as long as those of the prior's last pose; the paper: without. Throws
  /// Error if dof, classes or hidden is 0.
  AttentionGenerator(Initializer init, const AttentionGeneratorOptions& options,
                     std::optional<Bones> bones = std::nullopt)
      : options_(options), bones_(std::move(bones)) {
    require(options.dof > 0 && options.classes > 0 && options.hidden > 0,
            "AttentionGenerator: dof, classes and hidden must be positive");
    encode_ = Conv1d(init, options.dof + options.classes + options.noise_dim, options.hidden, 3);
    block0_ = Residual(init, options.hidden, 3);
    if (options.attention) attention_ = SelfAttention(init, options.hidden);
    block1_ = Residual(init, options.hidden, 3);
    decode_ = Conv1d(init, options.hidden, options.dof, 3);
  }

  const AttentionGeneratorOptions& options() const { return options_; }

  /// The future [T, B, dof] of a normalised prior [T, B, dof] for `classes` [B, Y] (one-hot). `noise` [B,
  /// noise_dim] is required if noise_dim > 0, and not accepted otherwise. Throws Error for any other shape.
  Var operator()(const Var& prior, const Var& classes, const Var& noise = {}) const {
    const Var made =
        decode_(residual_block(block1_, attend(attention_, before_attention(prior, classes, noise)), true));
    return with_exact_bones(prior, options_.continues
                                       ? made + fading_frames(prior, fading(prior.context(), prior.dim(0)))
                                       : made);
  }

  /// What is generated after `prior` if `made` comes out of the network: its bones as long as those of the
  /// prior's last pose, if the generator has exact bones.
  Var with_exact_bones(const Var& prior, const Var& made) const {
    return bones_ ? bones_->with_lengths_of(last_pose(prior), made) : made;
  }
  /// What keeps the lengths of bones; empty without exact bones.
  const std::optional<Bones>& bones() const { return bones_; }

  /// What the output is added to if it continues, [T, B, dof]: the prior's last frame times `fading`. The
  /// next second thus begins where the last one ends, and yet ends in a pose of its own.
  static Var fading_frames(const Var& prior, const Var& fading) {
    return broadcast_to(fading, prior.shape()) * broadcast_to(last_pose(prior), prior.shape());
  }
  /// (T - t) / (T + 1) in frame t = 0 .. T - 1, [T, 1, 1].
  static Var fading(const Context& context, std::size_t frames) {
    std::vector<double> weights;
    for (std::size_t t = 0; t < frames; ++t)
      weights.push_back(static_cast<double>(frames - t) / static_cast<double>(frames + 1));
    return Var::constant(Tensor::from(context, {frames, 1, 1}, weights));
  }

  /// Attention weights [B, T, T]: row j is what frame j attends to. Throws Error if the model has no
  /// attention.
  Var attention_map(const Var& prior, const Var& classes, const Var& noise = {}) const {
    require(attention_.has_value(), "the generator was made without attention and has no attention map");
    return attention_->map(before_attention(prior, classes, noise));
  }

  /// The layers, for code that runs them without a graph (AttentionRollout). `i` of block() is 0 or 1.
  const Conv1d& encode() const { return encode_; }
  const Residual& block(std::size_t i) const { return i == 0 ? block0_ : block1_; }
  const std::optional<SelfAttention>& attention() const { return attention_; }
  const Conv1d& decode() const { return decode_; }

  /// Rounds all weights to bfloat16: an AttentionRollout then reads them in 16 bits. For generation; there is
  /// no way back.
  void bfloat16() {
    round_to_bf16(named_parameters(*this));
    in_16_bits_ = true;
  }
  /// Whether weights are read in 16 bits, see bfloat16().
  bool in_16_bits() const { return in_16_bits_; }

  void list_parameters(ParameterList& list) {
    list.add_module("encode", encode_);
    list.add_module("block.0", block0_);
    if (attention_) list.add_module("attention", *attention_);
    list.add_module("block.1", block1_);
    list.add_module("decode", decode_);
  }

 private:
  static Var last_pose(const Var& prior) { return slice(prior, 0, prior.dim(0) - 1, 1); }

  Var before_attention(const Var& prior, const Var& classes, const Var& noise) const {
    require(prior.value().rank() == 3 && prior.dim(2) == options_.dof && classes.dim(1) == options_.classes,
            "AttentionGenerator: prior ", prior.shape(), " and classes ", classes.shape(),
            ", expected [frames, "
            "batch, ",
            options_.dof, "] and [batch, ", options_.classes, "]");
    require(noise.empty() ? options_.noise_dim == 0 : noise.dim(1) == options_.noise_dim,
            "AttentionGenerator: noise of ", noise.empty() ? 0 : noise.dim(1), " values, expected ",
            options_.noise_dim);
    return residual_block(block0_, encode_(with_constant_channels(
                                       prior, noise.empty() ? classes : concatenate({classes, noise}, 1))));
  }

  AttentionGeneratorOptions options_;
  Conv1d encode_, decode_;
  Residual block0_, block1_;
  std::optional<SelfAttention> attention_;
  std::optional<Bones> bones_;
  bool in_16_bits_ = false;
};

}  // namespace motiongan
