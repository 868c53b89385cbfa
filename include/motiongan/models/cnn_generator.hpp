// The CNN generator of DVGAN (Lin & Amer, eq. 4; SPEC 2).
#pragma once
#include "motiongan/models/plot.hpp"
#include "motiongan/models/residual.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

struct CnnGeneratorOptions {
  std::size_t vocabulary = 0;  ///< words
  std::size_t dof = 0;         ///< numbers of a pose, M
  std::size_t frames = 32;     ///< N, a power of two
  std::size_t hidden = 256;    ///< k
  std::size_t taps = 3;        ///< of the convolutions: 3 or 5
  bool final_cut = true;       ///< make 2N frames and keep N of them
};

/// From coarse to fine: level i has 2^i frames and noise of its own; each level doubles the frames of the one
/// before.
class CnnGenerator {
 public:
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
  /// Noise levels are 0 .. levels(), of 2^i frames each.
  std::size_t levels() const { return levels_; }

  /// z_i [2^i, B, k] for every level, keyed by sample: a sample's noise does not depend on its batch.
  std::vector<Var> noise(const Context& context, const RandomKey& key, std::size_t batch) const {
    std::vector<Var> z;
    for (std::size_t i = 0; i <= levels_; ++i)
      z.push_back(Var::constant(
          random_normal(context, key.with(Stream::noise + i), std::size_t{1} << i, batch, options_.hidden)));
    return z;
  }

  /// Where each sample's N frames are cut from the 2N made: uniform in 0..N. Empty without final cut.
  Indices cuts(const Context& context, const RandomKey& key, std::size_t batch) const {
    return options_.final_cut ? random_integers(context, key.with(Stream::cut), batch, 0, options_.frames + 1)
                              : Indices();
  }

  /// Motion [N, B, M] for a batch of sentences; `cut` as cuts() gives it.
  Var operator()(const Sentences& text, const std::vector<Var>& z, const Indices& cut) const {
    require(z.size() == levels_ + 1, "CnnGenerator: noise for ", z.size(), " levels, ", levels_ + 1,
            " expected");
    const Var h_txt = text_(text);
    Var h = plot_[0](h_txt, z[0]);
    for (std::size_t i = 1; i <= levels_; ++i) {
      const Residual& r = residual_[i - 1];
      const Var p = plot_[i](h_txt, z[i]);
      h = r.conv2(relu_of_sum(p, r.conv1(h)), {.residual = repeat_frames(h, 2)});
    }
    const Var motion = decode_(h);
    return options_.final_cut ? shift_frames(motion, cut, options_.frames) : motion;
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    for (std::size_t i = 0; i < plot_.size(); ++i) list.add_module("plot." + std::to_string(i), plot_[i]);
    for (std::size_t i = 0; i < residual_.size(); ++i)
      list.add_module("residual." + std::to_string(i + 1), residual_[i]);
    list.add_module("decode", decode_);
  }

 private:
  CnnGeneratorOptions options_;
  std::size_t levels_;
  TextEncoder text_;
  std::vector<Plot> plot_;
  std::vector<Residual> residual_;  // residual_[i - 1] leads to level i
  Conv1d decode_;
};

}  // namespace motiongan
