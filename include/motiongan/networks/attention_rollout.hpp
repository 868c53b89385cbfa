// Autoregressive rollout of the attention generator, without an autograd graph.
#pragma once
#include "motiongan/networks/attention_generator.hpp"
#include "motiongan/ops/attention.hpp"

namespace motiongan {

/// Computes what AttentionGenerator computes, equal to rounding, for inference. A sample's motion does not
/// depend on the rest of the batch, bit for bit with gemm()'s native engine.
///
/// The weights are copied at construction: construct a new rollout after a training step. They are kept in 16
/// bits if AttentionGenerator::bfloat16() rounded them. Buffers are
/// allocated by the first step and kept as long as frames and batch size stay the same; a step then takes
/// only its result and the mixed frames of one layer, and what exact bones and fading are computed with, from
/// the context's pool.
class AttentionRollout {
 public:
  explicit AttentionRollout(const AttentionGenerator& generator)
      : options_(generator.options()),
        bones_(generator.bones()),
        context_(generator.encode().weight.context()) {
    const NoGrad values_only;
    in_16_bits_ = generator.in_16_bits();
    encode_ = convolution(generator.encode().weight, generator.encode().bias);
    for (std::size_t i : {0u, 1u}) {
      const Residual& block = generator.block(i);
      first_[i] = convolution(block.conv1.weight, block.conv1.bias);
      second_[i] = convolution(block.conv2.weight, block.conv2.bias);
      first_[i].relu = true;
    }
    second_[1].relu = true;
    decode_ = convolution(generator.decode().weight, generator.decode().bias);
    if (const auto& attention = generator.attention()) {
      inner_ = attention->query.out_channels();
      parts_ = convolution(
          concatenate({attention->query.weight, attention->key.weight, attention->value.weight}, 1),
          concatenate({attention->query.bias, attention->key.bias, attention->value.bias}, 0));
      const auto scaled = [&](const Var& v) { return v * broadcast_to(attention->gamma, v.shape()); };
      // Transposed to [inner, hidden]: the kernel reads along the hidden channels.
      const std::vector<double> by_row = scaled(attention->out.weight).value().to_host<double>();
      std::vector<double> turned(by_row.size());
      const std::size_t hidden = options_.hidden;
      for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = by_row[i % hidden * inner_ + i / hidden];
      out_weight_ = Tensor::from(context_, {inner_, hidden}, turned);
      out_bias_ = scaled(attention->out.bias).value();
    }
  }

  const AttentionGeneratorOptions& options() const { return options_; }

  /// The future [T, B, dof] of a normalised prior [T, B, dof] for `classes` [B, Y] (one-hot). `noise` [B,
  /// noise_dim] is required if the generator takes noise, and not accepted otherwise. Pass the result back as
  /// the next prior for motion of any length; classes may change between steps. Throws Error for any other
  /// shape.
  Tensor step(const Tensor& prior, const Tensor& classes, const Tensor& noise = {}) {
    check(prior, classes, noise);
    reserve(prior.dim(0), prior.dim(1));
    detail::rows_with_constants(prior, classes, noise, {rows_, batch_ * encode_.k});
    compute(encode_);
    compute(first_[0]);
    compute(second_[0]);
    if (inner_ > 0) attend();
    compute(first_[1]);
    compute(second_[1]);
    decode_.c = Tensor(context_, {frames_, batch_, options_.dof});
    if (options_.continues) {
      const NoGrad values_only;
      decode_.residual = AttentionGenerator::fading_frames(Var::constant(prior), fading_).value();
      decode_.residual_ld = options_.dof;
    }
    compute(decode_);
    decode_.residual = {};
    Tensor made = std::exchange(decode_.c, {});
    if (!bones_) return made;
    const NoGrad values_only;
    return bones_->with_lengths_of(slice(Var::constant(prior), 0, frames_ - 1, 1), Var::constant(made))
        .value();
  }

 private:
  /// A convolution as a matrix product and, for numbers of frames with which that is cheaper, in Winograd's
  /// form: `run` then has a form and `points` the weights for it.
  struct Layer : GemmCall {
    detail::TapRun run = {};
    Tensor points = {};
  };

  void compute(const Layer& layer) const {
    if (!layer.run.form) return gemm(context_, layer);
    const Tensor frames = layer.a.view(batch_ * layer.k, {frames_, batch_, layer.k});
    detail::winograd_multiply(detail::winograd_frames(frames, layer.run), layer.points,
                              {.form = *layer.run.form,
                               .frames = frames_,
                               .batch = batch_,
                               .out = layer.n,
                               .bias = layer.bias,
                               .residual = layer.residual,
                               .relu = layer.relu,
                               .rectified = layer.rectified,
                               .rectified_offset = layer.rectified_offset},
                              {layer.c, layer.c_offset});
  }

  /// A layer without its input and output. `weight` is [taps, out, in].
  Layer convolution(const Var& weight, const Var& bias) const {
    const auto kept = [&](const Var& v) {  // a copy that the caller's optimizer does not change
      Tensor copy(context_, v.shape());
      detail::copy_tensor(v.value(), copy);
      return copy;
    };
    Layer call;
    call.n = weight.dim(1), call.k = weight.dim(2), call.b = kept(weight);
    call.a_ld = call.b_ld = call.k, call.c_ld = call.n;
    call.b_transposed = true;
    call.b_in_16_bits = in_16_bits_;
    call.segments = weight.dim(0);
    for (std::size_t s = 0; s < call.segments; ++s) call.b_offset[s] = s * call.n * call.k;
    call.bias = kept(bias);
    call.b_panels = pack_b(context_, call);
    return call;
  }

  void check(const Tensor& prior, const Tensor& classes, const Tensor& noise) const {
    require(prior.rank() == 3 && prior.dim(2) == options_.dof && prior.size() > 0, "AttentionRollout: prior ",
            prior.shape(), ", expected [frames, batch, ", options_.dof, "]");
    require(classes.shape() == Shape{prior.dim(1), options_.classes}, "AttentionRollout: classes ",
            classes.shape(), ", expected ", Shape{prior.dim(1), options_.classes});
    require(
        noise.empty() ? options_.noise_dim == 0 : noise.shape() == Shape{prior.dim(1), options_.noise_dim},
        "AttentionRollout: noise ", noise.shape(), ", expected ", Shape{prior.dim(1), options_.noise_dim},
        options_.noise_dim == 0 ? ": the generator takes no noise, omit it" : "");
  }

  /// Buffers for this number of frames and samples. The inputs of 3-tap convolutions are padded with a zero
  /// frame at either end, so that all frames use the same taps in one product.
  void reserve(std::size_t frames, std::size_t batch) {
    if (frames == frames_ && batch == batch_) return;
    const std::size_t hidden = options_.hidden, rows = frames * batch;
    const auto padded = [&](std::size_t width) { return full(context_, {frames + 2, batch, width}, 0); };
    rows_ = padded(encode_.k);
    rectified_ = padded(hidden);
    between_ = padded(hidden);
    state_ = Tensor(context_, {frames, batch, hidden});
    other_ = Tensor(context_, {frames, batch, hidden});
    const auto place = [&](Layer& call, const Tensor& from, const Tensor& to, std::size_t to_first) {
      call.m = rows, call.a = from, call.c = to, call.c_offset = to_first;
      for (std::size_t s = 0; s < call.segments; ++s) call.a_offset[s] = s * batch * call.k;
      call.run = {}, call.points = {};
      // Weights mixed for Winograd's form are no bfloat16 values, and more of them.
      if (call.segments != 3 || in_16_bits_) return;
      const Offsets offsets{-1, 0, 1};
      detail::TapPlan plan =
          detail::plan_taps({from.view(0, {frames, batch, call.k}), call.b, offsets, frames, false},
                            detail::ConvolutionPart::value);
      if (plan.runs.empty()) return;
      call.run = std::move(plan.runs.front());
      call.points = detail::winograd_weights(call.b, false, call.run.taps, *call.run.form);
    };
    const auto add = [&](Layer& call, const Tensor& residual) {
      call.residual = residual, call.residual_ld = hidden;
    };
    place(encode_, rows_, state_, 0);
    const auto rectify = [&](Layer& call) {
      call.rectified = rectified_, call.rectified_offset = batch * hidden;
    };
    rectify(encode_);
    if (inner_ == 0) rectify(second_[0]);  // with attention, its kernel does
    for (Layer& call : first_) place(call, rectified_, between_, batch * hidden);
    place(second_[0], between_, other_, 0);
    add(second_[0], state_);
    if (inner_ > 0) {
      parts_to_ = Tensor(context_, {frames, batch, 3 * inner_});
      place(parts_, other_, parts_to_, 0);
      // A sample's frames are split into pieces, so that a small batch still keeps all cores busy; in the
      // wide form, in which a work-group shares a frame, into single ones.
      const std::size_t groups = 4 * context_.device().compute_units;
      pieces_ = context_.wide() ? frames : std::clamp<std::size_t>((groups + batch - 1) / batch, 1, frames);
      scratch_ = Tensor(context_, {pieces_, batch, frames + inner_});
    }
    place(second_[1], between_, rectified_, batch * hidden);
    add(second_[1], inner_ > 0 ? state_ : other_);
    place(decode_, rectified_, {}, 0);
    if (options_.continues) fading_ = AttentionGenerator::fading(context_, frames);
    frames_ = frames, batch_ = batch;
  }

  void attend() {
    gemm(context_, parts_);
    detail::attend_frames(parts_to_, scratch_, other_, {out_weight_, out_bias_}, state_,
                          {rectified_, batch_ * options_.hidden}, pieces_);
  }

  AttentionGeneratorOptions options_;
  std::optional<Bones> bones_;
  Context context_;
  Layer encode_, decode_, parts_;
  std::array<Layer, 2> first_, second_;  // of the two residual blocks
  bool in_16_bits_ = false;
  std::size_t inner_ = 0;  // channels of query, key and value; 0: no attention
  std::size_t frames_ = 0, batch_ = 0, pieces_ = 1;
  Var fading_;                         // if the generator continues
  Tensor rows_, rectified_, between_;  // [frames + 2, batch, channels], first and last frame zero
  Tensor state_, other_;               // [frames * batch, hidden]
  Tensor parts_to_, scratch_, out_weight_, out_bias_;
};

}  // namespace motiongan
