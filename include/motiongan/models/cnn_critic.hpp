// The CNN critic of DVGAN with dense validation at every time scale (Lin & Amer, eq. 6; SPEC 3).
#pragma once
#include <optional>
#include <string_view>

#include "motiongan/models/residual.hpp"
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

/// The score of one time scale: mean over frames of score(ReLU(motion(h) + text(h_txt))), size-1
/// convolutions.
struct Validate {
  Conv1d motion, text, score;

  Validate() = default;
  Validate(Initializer& init, std::size_t k) : motion(init, k, k), text(init, k, k), score(init, k, 1) {}

  /// h [T, B, k], h_txt [1, B, k] -> [1, B, 1]. The mean is taken before `score`, which is linear: less to
  /// multiply.
  Var operator()(const Var& h, const Var& h_txt) const {
    const Var hidden = mean_frames(relu_of_sum(motion(h), text(h_txt)));
    return score(reshape(hidden, {1, hidden.dim(0), hidden.dim(1)}));
  }

  void list_parameters(ParameterList& list) {
    list.add_module("motion", motion);
    list.add_module("text", text);
    list.add_module("score", score);
  }
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
    Var h = encode_(motion);
    std::vector<Var> scores;  // from the finest validated level to the coarsest
    for (std::size_t i = levels_ + 1; i-- > 0;) {
      if (i < levels_) h = halve(residual_[i], h);
      if (is_validated(i)) scores.push_back(validate_[i](h, text));
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

  /// Down(h) + conv2(ReLU(Down(conv1(h)))): half the frames.
  static Var halve(const Residual& r, const Var& h) {
    const std::size_t frames = h.dim(0), half = frames / 2;
    const Var pairs = pair_means(h), down = slice(pairs, 0, half + 1, half);
    const Var inner =
        r.conv1.weight.dim(0) == 3 ? r.conv1.down(pairs, frames, true) : relu(sum_frames(r.conv1(h), 2, 0.5));
    return r.conv2(inner, {.residual = down});
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
