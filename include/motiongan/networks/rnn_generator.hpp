// The RNN generator of DVGAN (Lin & Amer, eq. 5).
#pragma once
#include "motiongan/networks/plot_layer.hpp"
#include "motiongan/nn/text_encoder.hpp"
#include "motiongan/ops/rollout.hpp"

namespace motiongan {

/// Options of an RnnGenerator.
struct RnnGeneratorOptions {
  std::size_t vocabulary = 0;  ///< number of words
  std::size_t dof = 0;         ///< M, values per pose
  std::size_t frames = 64;     ///< N, frames per window; any number
  std::size_t hidden = 256;    ///< k, hidden width
  bool final_cut = false;      ///< generate 2N frames and keep N consecutive ones
  double leak = 0;             ///< share of the pose that is lost in a frame, see RolloutWeights
};

/// Generates motion frame by frame: a two-layer LSTM reads the previous pose and the frame's plot (text and
/// noise), and its output is added to the pose, which leaks if that is asked for. Motion can be of any length
/// and can continue given frames.
class RnnGenerator {
 public:
  /// Throws Error if a size is 0 or the leak is not in [0, 1).
  RnnGenerator(Initializer init, const RnnGeneratorOptions& options) : options_(options) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0 && options.frames > 0,
            "RnnGenerator: vocabulary, dof, frames and hidden must be positive");
    require(options.leak >= 0 && options.leak < 1, "RnnGenerator: leak ", options.leak,
            ", expected at least 0 and below 1");
    const std::size_t k = options.hidden;
    text_ = TextEncoder(init, options.vocabulary, k);
    initial_plot_ = PlotLayer(init, k);
    plot_ = PlotLayer(init, k);
    decode_ = Linear(init, k, options.dof);
    frame_ = Linear(init, options.dof, k);
    lstm_ = Lstm(init, 2 * k, k, 2);
    diff_ = Linear(init, k, options.dof);
  }

  const RnnGeneratorOptions& options() const { return options_; }
  const TextEncoder& text_encoder() const { return text_; }
  const PlotLayer& initial_plot() const { return initial_plot_; }
  const PlotLayer& plot() const { return plot_; }
  const Linear& decode() const { return decode_; }

  /// Frames generated: N, or 2N with final cut.
  std::size_t frames_made() const { return options_.final_cut ? 2 * options_.frames : options_.frames; }

  /// Frames before the first one of a stream or of a long motion without a prior: N with final cut, whose
  /// critic has hardly seen the first frames, else 0.
  std::size_t warm_up() const { return options_.final_cut ? options_.frames : 0; }

  /// First of the N frames that the final cut keeps of 2N, per sample: uniform in 0..N, both included. Empty
  /// without final cut.
  Indices cuts(const Context& context, const RandomKey& key, std::size_t batch) const {
    return options_.final_cut
               ? random_integers(context, key.with(RandomStream::cut), batch, 0, options_.frames + 1)
               : Indices();
  }

  /// Standard normal noise z [frames, B, k], keyed by sample and frame: it does not depend on the batch or
  /// the length.
  Var noise(const Context& context, const RandomKey& key, std::size_t batch, std::size_t frames) const {
    return Var::constant(
        random_normal(context, key.with(RandomStream::noise), frames, batch, options_.hidden));
  }

  /// The weights as rollout() takes them, with consecutive linear layers multiplied into one: `frame` with
  /// its half of the first LSTM layer's input weights, `plot.out` with the other half. The products are a
  /// fixed cost, so keep the result when sampling repeatedly.
  struct Folded {
    RolloutWeights rollout;
    Var plot, plot_bias;  ///< [1, 4k, k], [4k]: from the plot's hidden units to the first layer's gates
  };
  Folded fold() const {
    const std::size_t k = options_.hidden;
    const Lstm::Layer &first = lstm_.layers[0], &second = lstm_.layers[1];
    const Var by_frame = slice(first.weight_ih, 1, 0, k), by_plot = slice(first.weight_ih, 1, k, k);
    const Var out = reshape(plot_.out.weight, {k, k});
    const auto through = [k](const Var& bias, const Var& weight) {
      return reshape(matmul(reshape(bias, {1, k}), weight, false, true), {4 * k});
    };
    Folded folded{
        {.layer0 = concatenate({matmul(by_frame, frame_.weight), first.weight_hh}, 1),
         .layer1 = concatenate({second.weight_ih, second.weight_hh}, 1),
         .bias1 = second.bias_ih + second.bias_hh,
         .diff = diff_.weight,
         .diff_bias = diff_.bias,
         .leak = options_.leak},
        reshape(matmul(by_plot, out), {1, 4 * k, k}),
        first.bias_ih + first.bias_hh + through(frame_.bias, by_frame) + through(plot_.out.bias, by_plot)};
    if (in_16_bits_)  // products of rounded weights are not rounded
      for (const Var& weights : {folded.rollout.layer0, folded.plot}) round_to_bf16(weights.value());
    return folded;
  }

  /// The first pose, [1, B, M], from the text encoding [B, k] and the first frame's noise [1, B, k].
  Var first_pose(const Var& h_txt, const Var& z) const { return decode_(initial_plot_(h_txt, z)); }

  /// The plots' contribution to the first layer's gates, [T, B, 4k], for noise [T, B, k].
  Var plot_gates(const Folded& folded, const Var& h_txt, const Var& z) const {
    const Var hidden = relu_of_sum(plot_.noise(z), reshape(h_txt, {1, h_txt.dim(0), h_txt.dim(1)}));
    return linear(hidden, folded.plot, {.bias = folded.plot_bias});
  }

  /// Normalised motion [T, B, M] for a batch of sentences and noise z [T, B, k]. With seed frames `seed`
  /// [n, B, M], 1 <= n <= T, the motion begins with them and continues them (completion). `cut`, as returned
  /// by cuts(), keeps N of the frames. Throws Error if z does not fit, or if both cut and seed are given.
  Var operator()(const Sentences& text, const Var& z, const Indices& cut = {}, const Var& seed = {}) const {
    require(z.value().rank() == 3 && z.dim(1) == text.batch && z.dim(2) == options_.hidden,
            "RnnGenerator: noise ", z.shape(), ", expected [frames, ", text.batch, ", ", options_.hidden,
            "]");
    require(cut.empty() || seed.empty(),
            "RnnGenerator: cut and seed are both given; a completion has no final cut");
    const std::size_t frames = z.dim(0);
    const Var h_txt = text_(text);
    Var given = seed.empty() ? first_pose(h_txt, slice(z, 0, 0, 1)) : seed;
    if (frames == 1) return given;
    const Folded folded = fold();
    const Var motion = rollout(given, plot_gates(folded, h_txt, slice(z, 0, 1, frames - 1)), folded.rollout);
    return cut.empty() ? motion : shift_frames(motion, cut, options_.frames);
  }

  /// Rounds all weights to bfloat16, also the products of fold(): an RnnStream then reads them in 16 bits.
  /// For generation; there is no way back.
  void bfloat16() {
    round_to_bf16(named_parameters(*this));
    in_16_bits_ = true;
  }
  /// Whether weights are read in 16 bits, see bfloat16().
  bool in_16_bits() const { return in_16_bits_; }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    list.add_module("initial_plot", initial_plot_);
    list.add_module("plot", plot_);
    list.add_module("decode", decode_);
    list.add_module("frame", frame_);
    list.add_module("lstm", lstm_);
    list.add_module("diff", diff_);
  }

 private:
  RnnGeneratorOptions options_;
  TextEncoder text_;
  PlotLayer initial_plot_, plot_;
  Linear decode_, frame_, diff_;
  Lstm lstm_;
  bool in_16_bits_ = false;
};

}  // namespace motiongan
