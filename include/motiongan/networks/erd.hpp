// Encoder-recurrent-decoder (Fragkiadaki, Levine, Felsen & Malik, "Recurrent network models for human
// dynamics", 2015): a baseline for motion completion.
#pragma once
#include <array>

#include "motiongan/networks/lstm_stack.hpp"

namespace motiongan {

/// Options of an Erd.
struct ErdOptions {
  std::size_t dof = 0;        ///< values per pose
  std::size_t hidden = 1000;  ///< LSTM width; linear layers have half of it, the last hidden one a tenth
};

/// `encode.0` Linear (ReLU) -> `encode.1` Linear -> two layers `lstm` -> `decode.0` Linear (ReLU) ->
/// `decode.1` Linear (ReLU) -> `decode.2` Linear = the next pose.
class Erd {
 public:
  /// Throws Error if dof is 0 or hidden below 2.
  Erd(Initializer init, const ErdOptions& options) : options_(options) {
    require(options.dof > 0 && options.hidden > 1, "Erd: dof must be positive and hidden above 1, found ",
            options.dof, " and ", options.hidden);
    const std::size_t k = options.hidden, half = k / 2, tenth = std::max<std::size_t>(1, k / 10);
    encode_ = {Linear(init, options.dof, half), Linear(init, half, half)};
    lstm_ = Lstm(init, half, k, 2);
    decode_ = {Linear(init, k, half), Linear(init, half, tenth), Linear(init, tenth, options.dof)};
  }

  const ErdOptions& options() const { return options_; }

  /// The next pose after each pose of x, [T, B, dof] -> [T, B, dof]; advances `state`.
  Var next_poses(const Var& x, LstmState& state) const {
    require(x.value().rank() == 3 && x.dim(2) == options_.dof, "Erd: poses ", x.shape(),
            ", expected [frames, batch, ", options_.dof, "]");
    const Var h = lstm_.advance(encode_[1](encode_[0](x, true)), state);
    return decode_[2](decode_[1](decode_[0](h, true), true));
  }

  /// The `frames` poses [frames, B, dof] that follow the prefix [n, B, dof], fed with its own output.
  Var operator()(const Var& prefix, std::size_t frames) const { return closed_loop(*this, prefix, frames); }

  void list_parameters(ParameterList& list) {
    for (std::size_t i = 0; i < encode_.size(); ++i) list.add_module(concat("encode.", i), encode_[i]);
    list.add_module("lstm", lstm_);
    for (std::size_t i = 0; i < decode_.size(); ++i) list.add_module(concat("decode.", i), decode_[i]);
  }

 private:
  ErdOptions options_;
  std::array<Linear, 2> encode_;
  Lstm lstm_;
  std::array<Linear, 3> decode_;
};

}  // namespace motiongan
