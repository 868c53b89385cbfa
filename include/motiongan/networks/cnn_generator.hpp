// The CNN generator of DVGAN (Lin & Amer, eq. 4).
#pragma once
#include "motiongan/networks/plot_layer.hpp"
#include "motiongan/networks/residual.hpp"
#include "motiongan/nn/text_encoder.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// Options of a CnnGenerator.
struct CnnGeneratorOptions {
  std::size_t vocabulary = 0;  ///< number of words
  std::size_t dof = 0;         ///< M, values per pose
  std::size_t frames = 32;     ///< N, frames per window; a power of two
  std::size_t hidden = 256;    ///< k, hidden width
  std::size_t taps = 3;        ///< kernel size of the convolutions: 3 or 5
  bool final_cut = true;       ///< generate 2N frames and keep N consecutive ones
};

/// Generates motion from coarse to fine: level i has 2^i frames and its own noise, and each level doubles the
/// number of frames.
class CnnGenerator {
 public:
  /// Throws Error if a size is 0 or frames is not a power of two.
  CnnGenerator(Initializer init, const CnnGeneratorOptions& options)
      : options_(options), levels_(levels_of(options.frames) + options.final_cut) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0,
            "CnnGenerator: vocabulary, dof and hidden must be positive");
    text_ = TextEncoder(init, options.vocabulary, options.hidden);
    for (std::size_t i = 0; i <= levels_; ++i) plot_.emplace_back(init, options.hidden);
    for (std::size_t i = 1; i <= levels_; ++i) residual_.emplace_back(init, options.hidden, options.taps);
    decode_ = Conv1d(init, options.hidden, options.dof);
  }

  const CnnGeneratorOptions& options() const { return options_; }
  /// The finest level: noise has levels 0 .. levels(), with 2^i frames at level i.
  std::size_t levels() const { return levels_; }

  /// First of the N frames that the final cut keeps of 2N, per sample: uniform in 0..N, both included. Empty
  /// without final cut.
  Indices cuts(const Context& context, const RandomKey& key, std::size_t batch) const {
    return options_.final_cut
               ? random_integers(context, key.with(RandomStream::cut), batch, 0, options_.frames + 1)
               : Indices();
  }

  /// Standard normal noise z_i [2^i, B, k] for every level, keyed by sample: a sample's noise does not depend
  /// on its batch. With final cut, the last level holds only the frames that the cut needs,
  /// [N + 2 * (taps / 2), B, k].
  std::vector<Var> noise(const Context& context, const RandomKey& key, std::size_t batch,
                         const Indices& cut) const {
    std::vector<Var> z;
    for (std::size_t i = 0; i <= levels_; ++i) {
      RandomKey level = key.with(RandomStream::noise + i);
      const bool last = options_.final_cut && i == levels_;
      if (last) level.first_frame = -static_cast<std::int32_t>(reach());
      z.push_back(
          Var::constant(last ? random_normal(context, level, kept_frames(), batch, options_.hidden, cut)
                             : random_normal(context, level, std::size_t{1} << i, batch, options_.hidden)));
    }
    return z;
  }

  /// The frames that the final cut needs of noise z [2N, B, k] for the last level, for callers that supply
  /// their own noise.
  Var cut_noise(const Var& z, const Indices& cut) const {
    return shift_frames(z, cut, kept_frames(), {.first = -static_cast<int>(reach())});
  }

  /// Normalised motion [N, B, M] for a batch of sentences, from z as returned by noise() (or with the last
  /// level reduced by cut_noise()) and `cut` as returned by cuts(). Throws Error for another number of
  /// levels.
  Var operator()(const Sentences& text, const std::vector<Var>& z, const Indices& cut) const {
    require(z.size() == levels_ + 1, "CnnGenerator: noise for ", z.size(), " levels, expected ", levels_ + 1);
    const Var h_txt = text_(text);
    Var h = plot_[0](h_txt, z[0]);
    if (levels_ == 0) return decode_(h);
    for (std::size_t i = 1; i < levels_; ++i) {
      const Residual& r = residual_[i - 1];
      h = r.conv2(relu_of_sum(plot_[i](h_txt, z[i]), r.conv1(h)), {.residual = upsample_nearest(h, 2)});
    }
    return decoded_last_level(h, h_txt, z[levels_], cut);
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    for (std::size_t i = 0; i < plot_.size(); ++i) list.add_module("plot." + std::to_string(i), plot_[i]);
    for (std::size_t i = 0; i < residual_.size(); ++i)
      list.add_module("residual." + std::to_string(i + 1), residual_[i]);
    list.add_module("decode", decode_);
  }

 private:
  /// Frames on either side of the cut that the last convolution reads.
  std::size_t reach() const { return options_.taps / 2; }
  std::size_t kept_frames() const { return options_.frames + 2 * reach(); }

  /// decode(h_L) = decode(Up(h) + conv2(x)), computed as Up(decode(h)) + (decode conv2)(x): both layers are
  /// linear, and a pose has fewer values than a hidden state, so multiplying their weights saves most of the
  /// finest level's arithmetic. With final cut, only the frames it keeps and those the convolution reads
  /// around them are computed. Frames outside 0..2N-1 are zero padding: a large negative number before the
  /// ReLU makes them zero.
  Var decoded_last_level(const Var& h, const Var& h_txt, const Var& z, const Indices& cut) const {
    constexpr double far_below = -1e30;
    const std::size_t frames = 2 * h.dim(0), k = options_.hidden, dof = options_.dof;
    const Residual& r = residual_.back();
    const Var plot = plot_.back()(h_txt, z);
    const Var decode = decode_.weight;  // [1, dof, k]
    Var inner, residual = upsample_nearest(linear(h, decode), 2);
    Offsets offsets = r.conv2.offsets();
    if (options_.final_cut) {
      const int first = -static_cast<int>(reach());
      inner = relu_of_sum(plot, shift_frames(upsample_nearest(r.conv1(h), 2), cut, kept_frames(),
                                             {.first = first, .outside = far_below}));
      residual = shift_frames(residual, cut, options_.frames);
      for (int& offset : offsets) offset -= first;
    } else {
      inner = relu_of_sum(plot, r.conv1(h));
    }
    const Var weight = matmul(broadcast_to(decode, {options_.taps, dof, k}), r.conv2.weight);
    const Var bias =
        decode_.bias +
        reshape(matmul(reshape(r.conv2.bias, {1, k}), reshape(decode, {dof, k}), false, true), {dof});
    return conv1d(inner, weight, offsets, options_.final_cut ? options_.frames : frames, false,
                  {.bias = bias, .residual = residual});
  }

  CnnGeneratorOptions options_;
  std::size_t levels_;
  TextEncoder text_;
  std::vector<PlotLayer> plot_;
  std::vector<Residual> residual_;  // residual_[i - 1] produces level i
  Conv1d decode_;
};

}  // namespace motiongan
