// The validation module of DVGAN's critics: scores features against a text (Lin & Amer, eq. 6 and 10).
#pragma once
#include "motiongan/nn/linear.hpp"

namespace motiongan {

/// The score of a sequence of features: mean over frames of score(ReLU(motion(h) + text(h_txt))), with size-1
/// convolutions.
struct Validate {
  Conv1d motion, text, score;

  Validate() = default;
  Validate(Initializer& init, std::size_t k) : motion(init, k, k), text(init, k, k), score(init, k, 1) {}

  /// Features h [T, B, k] and text h_txt [1, B, k] -> scores [1, B, 1].
  Var operator()(const Var& h, const Var& h_txt) const {
    return (*this)(h, h_txt, motion.weight, motion.bias);
  }

  /// The same for features that are a linear function of h [T, B, c]: `weight` [1, k, c] and `bias` [k] are
  /// those of motion() composed with it. `score` is linear, so the mean is taken before it.
  Var operator()(const Var& h, const Var& h_txt, const Var& weight, const Var& bias) const {
    const Var moved = linear(h, weight, {.bias = bias});
    const Var hidden = mean(relu_of_sum(moved, text(h_txt)), 0);
    return score(reshape(hidden, {1, hidden.dim(0), hidden.dim(1)}));
  }

  void list_parameters(ParameterList& list) {
    list.add_module("motion", motion);
    list.add_module("text", text);
    list.add_module("score", score);
  }
};

}  // namespace motiongan
