// The CNN critic of DVGAN with dense validation at every time scale (Lin & Amer, eq. 6; SPEC 3).
#pragma once
#include <optional>
#include <string_view>

#include "motiongan/models/residual.hpp"
#include "motiongan/models/validate.hpp"
#include "motiongan/nn/text_encoder.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// Which time scales the critic judges: all of them, every second one, or only the coarsest.
enum class Validation { dense, mod2, final };
/// How the levels' scores are weighted: exp(w_i), or a softmax over w.
enum class LevelWeights { exp, softmax };

struct CnnCriticOptions {
  std::size_t vocabulary = 0;  ///< words
  std::size_t dof = 0;         ///< numbers of a pose, M
  std::size_t frames = 32;     ///< N, a power of two
  std::size_t hidden = 256;    ///< k
  std::size_t taps = 3;        ///< of the convolutions: 3 or 5
  Validation validation = Validation::dense;
  LevelWeights level_weights = LevelWeights::exp;
};

class CnnCritic {
 public:
  CnnCritic(Initializer init, const CnnCriticOptions& options)
      : options_(options), levels_(levels_of(options.frames)) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0,
            "CnnCritic: vocabulary, dof and hidden must be positive");
    text_ = TextEncoder(init, options.vocabulary, options.hidden);
    encode_ = Conv1d(init, options.dof, options.hidden);
    for (std::size_t i = 0; i < levels_; ++i) residual_.emplace_back(init, options.hidden, options.taps);
    std::size_t validated = 0;
    for (std::size_t i = 0; i <= levels_; ++i) {
      validate_.emplace_back();
      if (!is_validated(i)) continue;
      validate_.back() = Validate(init, options.hidden);
      ++validated;
    }
    // exp(w) starts convex: every level counts 1/n.
    level_weight_ = init.constant({validated}, -std::log(static_cast<double>(validated)));
  }

  const CnnCriticOptions& options() const { return options_; }

  /// [B, k]; computed once a step, it serves real, fake and mixed motion alike.
  Var encode_text(const Sentences& text) const { return text_(text); }

  /// One score per sample, [B], of motion [N, B, M] with encoded text [B, k].
  Var operator()(const Var& motion, const Var& h_txt) const {
    require(motion.dim(0) == options_.frames && motion.dim(2) == options_.dof, "CnnCritic: motion ",
            motion.shape(), ", expected [", options_.frames, ", batch, ", options_.dof, "]");
    const std::size_t batch = motion.dim(1);
    const Var text = reshape(h_txt, {1, batch, options_.hidden});
    // The finest level is encode(motion), which is linear and so are the layers that see it: they take the
    // motion itself by the product of their weights with encode's. A pose has fewer numbers than a hidden
    // state, and the largest of all activations need not exist. A channel of ones carries encode's bias, also
    // through the zero padding.
    Var h = concat_axis({motion, ones(motion.context(), {motion.dim(0), batch, 1})}, 2);
    const Var encode = with_bias(encode_);  // [k, dof + 1]
    std::vector<Var> scores;                // from the finest validated level to the coarsest
    for (std::size_t i = levels_ + 1; i-- > 0;) {
      const bool finest = i == levels_;
      if (!finest) h = halve(residual_[i], h, i + 1 == levels_ ? encode : Var());
      if (is_validated(i)) {
        const Validate& v = validate_[i];
        scores.push_back(v(h, text, finest ? after(v.motion, encode) : v.motion.weight, v.motion.bias));
      }
    }
    std::reverse(scores.begin(), scores.end());
    const std::size_t n = scores.size();
    const Var each = reshape(concat_axis(scores, 2), {batch, n});
    const Var weights =
        options_.level_weights == LevelWeights::exp ? exp(level_weight_) : softmax(level_weight_);
    return reshape(matmul(each, reshape(weights, {n, 1})), {batch});
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    list.add_module("encode", encode_);
    for (std::size_t i = 0; i < levels_; ++i) list.add_module("residual." + std::to_string(i), residual_[i]);
    for (std::size_t i = 0; i <= levels_; ++i)
      if (is_validated(i)) list.add_module("validate." + std::to_string(i), validate_[i]);
    list.add("level_weight", level_weight_);
  }

 private:
  bool is_validated(std::size_t level) const {
    return options_.validation == Validation::dense ||
           (options_.validation == Validation::mod2 && level % 2 == 0) || level == 0;
  }

  /// Down(h) + conv2(ReLU(Down(conv1(h)))): half the frames. With `encode`, h is what encode is yet to be
  /// applied to.
  static Var halve(const Residual& r, const Var& h, const Var& encode) {
    const std::size_t frames = h.dim(0), half = frames / 2;
    const Var pairs = pair_means(h), weight = encode.empty() ? r.conv1.weight : after(r.conv1, encode);
    Var down = slice(pairs, 0, half + 1, half);
    if (!encode.empty()) down = taps(down, reshape(encode, {1, encode.dim(0), encode.dim(1)}), {0}, half);
    const Var inner =
        weight.dim(0) == 3
            ? conv_down(pairs, weight, r.conv1.bias, frames, {.relu = true})
            : relu(sum_frames(taps(h, weight, r.conv1.offsets(), frames, false, {.bias = r.conv1.bias}), 2,
                              0.5));
    return r.conv2(inner, {.residual = down});
  }

  /// Weight and bias of a linear layer side by side, [out, in + 1]: for inputs with a channel of ones.
  static Var with_bias(const Conv1d& layer) {
    const std::size_t out = layer.weight.dim(1), in = layer.weight.dim(2);
    return concat_axis({reshape(layer.weight, {out, in}), reshape(layer.bias, {out, 1})}, 1);
  }

  /// The weights of conv after a linear layer `first` [k, in]: [taps, out, in].
  static Var after(const Conv1d& conv, const Var& first) {
    const std::size_t count = conv.weight.dim(0), out = conv.weight.dim(1), k = conv.weight.dim(2);
    return reshape(matmul(reshape(conv.weight, {count * out, k}), first), {count, out, first.dim(1)});
  }

  CnnCriticOptions options_;
  std::size_t levels_;
  TextEncoder text_;
  Conv1d encode_;
  std::vector<Residual> residual_;  // residual_[i] leads from level i + 1 to level i
  std::vector<Validate> validate_;  // by level; unused where a level is not validated
  Var level_weight_;
};

}  // namespace motiongan
