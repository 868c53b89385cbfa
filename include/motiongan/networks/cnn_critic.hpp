// The CNN critic of DVGAN, with dense validation (Lin & Amer, eq. 6).
#pragma once
#include <optional>
#include <string_view>

#include "motiongan/core/fields.hpp"
#include "motiongan/networks/cnn_trunk.hpp"
#include "motiongan/networks/validate.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// Which time scales the critic scores: all levels, the even ones, or only the coarsest.
enum class Validation { dense, mod2, final };
constexpr NameTable<Validation, 3> enum_names(Validation) {
  return {{{Validation::dense, "dense"}, {Validation::mod2, "mod2"}, {Validation::final, "final"}}};
}
/// Weights of the levels' scores: exp(w_i), or a softmax over w.
enum class LevelWeights { exp, softmax };
constexpr NameTable<LevelWeights, 2> enum_names(LevelWeights) {
  return {{{LevelWeights::exp, "exp"}, {LevelWeights::softmax, "softmax"}}};
}

/// Options of a CnnCritic.
struct CnnCriticOptions {
  std::size_t vocabulary = 0;                      ///< number of words
  std::size_t dof = 0;                             ///< M, values per pose
  std::size_t frames = 32;                         ///< N, frames per window; a power of two
  std::size_t hidden = 256;                        ///< k, hidden width
  std::size_t taps = 3;                            ///< kernel size of the convolutions: 3 or 5
  Validation validation = Validation::dense;       ///< the time scales that are scored
  LevelWeights level_weights = LevelWeights::exp;  ///< how the scores of levels are weighted
  bool composes = true;  ///< apply `encode` through the layers that read it, see CnnTrunk; equal to rounding
};

/// Scores motion against a text. `encode` and residual steps halve the frames level by level; every validated
/// level has its own Validate module, and the result is the weighted sum of their scores.
class CnnCritic {
 public:
  /// Throws Error if a size is 0 or frames is not a power of two.
  CnnCritic(Initializer init, const CnnCriticOptions& options)
      : options_(options), levels_(levels_of(options.frames)) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0,
            "CnnCritic: vocabulary, dof and hidden must be positive");
    text_ = TextEncoder(init, options.vocabulary, options.hidden);
    trunk_ = CnnTrunk(init, options.dof, options.frames, options.hidden, options.taps);
    std::size_t validated = 0;
    for (std::size_t i = 0; i <= levels_; ++i) {
      validate_.emplace_back();
      if (!is_validated(i)) continue;
      validate_.back() = Validate(init, options.hidden);
      ++validated;
    }
    // exp(w) is 1/n at the start: the mean of the levels' scores.
    level_weight_ = init.constant({validated}, -std::log(static_cast<double>(validated)));
  }

  const CnnCriticOptions& options() const { return options_; }

  /// Text encoding [B, k]. Compute it once per step and share it between real, fake and interpolated motion.
  Var encode_text(const Sentences& text) const { return text_(text); }

  /// One score per sample, [B], of normalised motion [N, B, M] and the text encoding [B, k]. Throws Error for
  /// another N or M.
  Var operator()(const Var& motion, const Var& h_txt) const {
    require(motion.dim(0) == options_.frames && motion.dim(2) == options_.dof, "CnnCritic: motion ",
            motion.shape(), ", expected [", options_.frames, ", batch, ", options_.dof, "]");
    const std::size_t batch = motion.dim(1);
    const Var text = reshape(h_txt, {1, batch, options_.hidden});
    const Var encode = options_.composes ? trunk_.encoding() : Var();
    Var h = options_.composes ? CnnTrunk::with_ones(motion) : trunk_.encoded(motion);
    std::vector<Var> scores;  // from the finest validated level to the coarsest
    for (std::size_t i = levels_ + 1; i-- > 0;) {
      const bool finest = i == levels_, composed = finest && options_.composes;
      if (!finest) h = trunk_.halve(i, h, encode);
      if (is_validated(i)) {
        const Validate& v = validate_[i];
        scores.push_back(
            v(h, text, composed ? CnnTrunk::after(v.motion, encode) : v.motion.weight, v.motion.bias));
      }
    }
    std::reverse(scores.begin(), scores.end());
    const std::size_t n = scores.size();
    const Var each = reshape(concatenate(scores, 2), {batch, n});
    const Var weights =
        options_.level_weights == LevelWeights::exp ? exp(level_weight_) : softmax(level_weight_);
    return reshape(matmul(each, reshape(weights, {n, 1})), {batch});
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    trunk_.list_parameters(list);
    for (std::size_t i = 0; i <= levels_; ++i)
      if (is_validated(i)) list.add_module("validate." + std::to_string(i), validate_[i]);
    list.add("level_weight", level_weight_);
  }

 private:
  bool is_validated(std::size_t level) const {
    return options_.validation == Validation::dense ||
           (options_.validation == Validation::mod2 && level % 2 == 0) || level == 0;
  }

  CnnCriticOptions options_;
  std::size_t levels_;
  TextEncoder text_;
  CnnTrunk trunk_;
  std::vector<Validate> validate_;  // by level; empty for levels that are not validated
  Var level_weight_;
};

}  // namespace motiongan
