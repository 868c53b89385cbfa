// The RNN critic of DVGAN: scores of poses and of frame differences (Lin & Amer, eq. 10).
#pragma once
#include "motiongan/core/fields.hpp"
#include "motiongan/networks/difference_lstm.hpp"
#include "motiongan/networks/validate.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// Input of the second score: the LSTM's hidden states over the frame differences, as the paper's text says,
/// or the encoded differences themselves, as eq. 10 is printed (the LSTM is then unused).
enum class DiffInput { hidden, difference };
constexpr NameTable<DiffInput, 2> enum_names(DiffInput) {
  return {{{DiffInput::hidden, "hidden"}, {DiffInput::difference, "difference"}}};
}

/// Options of an RnnCritic.
struct RnnCriticOptions {
  std::size_t vocabulary = 0;                ///< number of words
  std::size_t dof = 0;                       ///< M, values per pose
  std::size_t hidden = 256;                  ///< k, hidden width
  DiffInput diff_input = DiffInput::hidden;  ///< what the second score is made from
};

/// Scores motion against a text: a weighted sum of one score of the poses and one of their frame differences.
class RnnCritic {
 public:
  /// Throws Error if vocabulary, dof or hidden is 0.
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

  /// Text encoding [B, k]. Compute it once per step and share it between real, fake and interpolated motion.
  Var encode_text(const Sentences& text) const { return text_(text); }

  /// One score per sample, [B], of normalised motion [N, B, M], N >= 2, and the text encoding [B, k]. Throws
  /// Error for another shape.
  Var operator()(const Var& motion, const Var& h_txt) const {
    require(motion.value().rank() == 3 && motion.dim(0) >= 2 && motion.dim(2) == options_.dof,
            "RnnCritic: motion ", motion.shape(), ", expected [2 or more frames, batch, ", options_.dof, "]");
    const std::size_t batch = motion.dim(1);
    const Var text = reshape(h_txt, {1, batch, options_.hidden});
    const Var differences = frame_differences(motion);
    // `frame` and `diff` feed linear layers, so the weights are multiplied once and applied to poses and
    // differences directly: a pose has fewer values than a hidden state.
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
  /// validate(first(x), text) for x [T, B, M], with the weights of both layers multiplied first.
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
  Var weights_;  // of the two scores: poses (A), differences (D)
};

}  // namespace motiongan
