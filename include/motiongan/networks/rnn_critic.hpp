// The RNN critic of DVGAN: poses judged one by one, and their changes through an LSTM (Lin & Amer, eq. 10;
// SPEC 3).
#pragma once
#include "motiongan/networks/difference_lstm.hpp"
#include "motiongan/networks/validate.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// What the second score judges: the LSTM's hidden states over the frame differences, as the paper's text
/// says, or the encoded differences themselves, as its eq. 10 is printed (the LSTM then has no influence).
enum class DiffInput { hidden, difference };

struct RnnCriticOptions {
  std::size_t vocabulary = 0;  ///< words
  std::size_t dof = 0;         ///< numbers of a pose, M
  std::size_t hidden = 256;    ///< k
  DiffInput diff_input = DiffInput::hidden;
};

class RnnCritic {
 public:
  RnnCritic(Initializer init, const RnnCriticOptions& options) : options_(options) {
    require(options.vocabulary > 0 && options.dof > 0 && options.hidden > 0,
            "RnnCritic: vocabulary, dof and hidden must be positive");
    const std::size_t k = options.hidden;
    text_ = TextEncoder(init, options.vocabulary, k);
    frame_ = Linear(init, options.dof, k);
    diff_ = Linear(init, options.dof, k);
    lstm_ = Lstm(init, k, k, 2);
    frame_validate_ = Validate(init, k);
    diff_validate_ = Validate(init, k);
    weights_ = init.constant({2}, 0.5);
  }

  const RnnCriticOptions& options() const { return options_; }

  /// [B, k]; computed once a step, it serves real, fake and mixed motion alike.
  Var encode_text(const Sentences& text) const { return text_(text); }

  /// One score per sample, [B], of motion [N, B, M] with encoded text [B, k]; N is any number from 2 on.
  Var operator()(const Var& motion, const Var& h_txt) const {
    require(motion.value().rank() == 3 && motion.dim(0) >= 2 && motion.dim(2) == options_.dof,
            "RnnCritic: motion ", motion.shape(), ", expected [2 or more frames, batch, ", options_.dof, "]");
    const std::size_t batch = motion.dim(1);
    const Var text = reshape(h_txt, {1, batch, options_.hidden});
    const Var differences = frame_differences(motion);
    // `frame` and `diff` are linear and so is what sees their results: poses and differences enter by the
    // product of both layers' weights. A pose has fewer numbers than a hidden state.
    const Var of_frames = judge(frame_validate_, motion, text, frame_);
    const Var of_differences = options_.diff_input == DiffInput::difference
                                   ? judge(diff_validate_, differences, text, diff_)
                                   : diff_validate_(difference_lstm(diff_, lstm_, differences), text);
    const Var both = reshape(concatenate({of_frames, of_differences}, 2), {batch, 2});
    return reshape(matmul(both, reshape(weights_, {2, 1})), {batch});
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    list.add_module("frame", frame_);
    list.add_module("diff", diff_);
    list.add_module("lstm", lstm_);
    list.add_module("frame_validate", frame_validate_);
    list.add_module("diff_validate", diff_validate_);
    list.add("weights", weights_);
  }

 private:
  /// The score of features that `first` makes of x [T, B, M], by the product of its weights with those that
  /// follow.
  static Var judge(const Validate& validate, const Var& x, const Var& text, const Linear& first) {
    const std::size_t k = first.weight.dim(0), dof = first.weight.dim(1);
    const Var motion = reshape(validate.motion.weight, {k, k});
    const Var of_bias = matmul(motion, reshape(first.bias, {k, 1}));
    return validate(x, text, reshape(matmul(motion, first.weight), {1, k, dof}),
                    reshape(of_bias, {k}) + validate.motion.bias);
  }

  RnnCriticOptions options_;
  TextEncoder text_;
  Linear frame_, diff_;
  Lstm lstm_;
  Validate frame_validate_, diff_validate_;
  Var weights_;  // of the two scores, (A, D)
};

}  // namespace motiongan
