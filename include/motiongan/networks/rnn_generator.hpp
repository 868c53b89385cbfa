// The RNN generator of DVGAN (Lin & Amer, eq. 5; SPEC 2).
#pragma once
#include "motiongan/networks/plot_layer.hpp"
#include "motiongan/nn/text_encoder.hpp"
#include "motiongan/ops/rollout.hpp"

namespace motiongan {

struct RnnGeneratorOptions {
  std::size_t vocabulary = 0;  ///< words
  std::size_t dof = 0;         ///< numbers of a pose, M
  std::size_t frames = 64;     ///< N; any number
  std::size_t hidden = 256;    ///< k
  bool final_cut = false;      ///< make 2N frames and keep N of them
};

/// Frame by frame: a two-layer LSTM sees the last pose and a plot of the text and of noise of this frame's
/// own, and moves the pose on. It can go on for ever, and continue what is given.
class RnnGenerator {
 public:
  RnnGenerator(Initializer init, const RnnGeneratorOptions& options) : options_(options) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0 && options.frames > 0,
            "RnnGenerator: vocabulary, dof, frames and hidden must be positive");
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

  /// Frames that are made: N, or 2N of which the final cut keeps N.
  std::size_t frames_made() const { return options_.final_cut ? 2 * options_.frames : options_.frames; }

  /// Where each sample's N frames are cut from the 2N made: uniform in 0..N. Empty without final cut.
  Indices cuts(const Context& context, const RandomKey& key, std::size_t batch) const {
    return options_.final_cut ? random_integers(context, key.with(RandomStream::cut), batch, 0, options_.frames + 1)
                              : Indices();
  }

  /// z [frames, B, k]: every frame of every sample has noise of its own, whatever the batch and the length.
  Var noise(const Context& context, const RandomKey& key, std::size_t batch, std::size_t frames) const {
    return Var::constant(random_normal(context, key.with(RandomStream::noise), frames, batch, options_.hidden));
  }

  /// The weights as rollout() takes them, with every pair of linear layers that stands behind one another
  /// made one: `frame` and the half of the first LSTM layer that sees it, `plot.out` and the other half. The
  /// products cost as much as some thousand samples' frames less: whoever samples often keeps them.
  struct Folded {
    RolloutWeights rollout;
    Var plot, plot_bias;  ///< [1, 4k, k], [4k]: from the plot's hidden numbers to the first layer's gates
  };
  Folded fold() const {
    const std::size_t k = options_.hidden;
    const Lstm::Layer &first = lstm_.layers[0], &second = lstm_.layers[1];
    const Var by_frame = slice(first.weight_ih, 1, 0, k), by_plot = slice(first.weight_ih, 1, k, k);
    const Var out = reshape(plot_.out.weight, {k, k});
    const auto through = [k](const Var& bias, const Var& weight) {
      return reshape(matmul(reshape(bias, {1, k}), weight, false, true), {4 * k});
    };
    return {
        {.layer0 = concatenate({matmul(by_frame, frame_.weight), first.weight_hh}, 1),
         .layer1 = concatenate({second.weight_ih, second.weight_hh}, 1),
         .bias1 = second.bias_ih + second.bias_hh,
         .diff = diff_.weight,
         .diff_bias = diff_.bias},
        reshape(matmul(by_plot, out), {1, 4 * k, k}),
        first.bias_ih + first.bias_hh + through(frame_.bias, by_frame) + through(plot_.out.bias, by_plot)};
  }

  /// The first pose, [1, B, M], of encoded text [B, k] and the first frame's noise [1, B, k].
  Var first_pose(const Var& h_txt, const Var& z) const { return decode_(initial_plot_(h_txt, z)); }

  /// What plots do to the first layer's gates, [T, B, 4k], for noise [T, B, k].
  Var plot_gates(const Folded& folded, const Var& h_txt, const Var& z) const {
    const Var hidden = relu_of_sum(plot_.noise(z), reshape(h_txt, {1, h_txt.dim(0), h_txt.dim(1)}));
    return linear(hidden, folded.plot, {.bias = folded.plot_bias});
  }

  /// Motion [T, B, M] for a batch of sentences and noise z [T, B, k]. With `seed` [n, B, M], 1 <= n <= T, the
  /// motion begins with it and goes on from there (completion). `cut`, as cuts() gives it, keeps N of the
  /// frames.
  Var operator()(const Sentences& text, const Var& z, const Indices& cut = {}, const Var& seed = {}) const {
    require(z.value().rank() == 3 && z.dim(1) == text.batch && z.dim(2) == options_.hidden,
            "RnnGenerator: noise ", z.shape(), ", expected [frames, ", text.batch, ", ", options_.hidden,
            "]");
    require(cut.empty() || seed.empty(), "RnnGenerator: a completion is not cut");
    const std::size_t frames = z.dim(0);
    const Var h_txt = text_(text);
    Var given = seed.empty() ? first_pose(h_txt, slice(z, 0, 0, 1)) : seed;
    if (frames == 1) return given;
    const Folded folded = fold();
    const Var motion = rollout(given, plot_gates(folded, h_txt, slice(z, 0, 1, frames - 1)), folded.rollout);
    return cut.empty() ? motion : shift_frames(motion, cut, options_.frames);
  }

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
};

}  // namespace motiongan
