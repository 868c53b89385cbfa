// The LSTM baseline of the attention WGAN-GP (Malek-Podjaski & Deligianni): it reads the prior, then runs on
// its own output.
#pragma once
#include "motiongan/networks/attention_block.hpp"
#include "motiongan/nn/lstm.hpp"

namespace motiongan {

/// Options of an LstmBaseline.
struct LstmBaselineOptions {
  std::size_t dof = 0;       ///< values per pose
  std::size_t classes = 0;   ///< Y, the number of classes
  std::size_t hidden = 256;  ///< k, hidden width
};

/// [pose, class] -> `frame` Linear -> one-layer `lstm` -> `out` Linear = the next pose.
class LstmBaseline {
 public:
  /// Throws Error if dof, classes or hidden is 0.
  LstmBaseline(Initializer init, const LstmBaselineOptions& options) : options_(options) {
    require(options.dof > 0 && options.classes > 0 && options.hidden > 0,
            "LstmBaseline: dof, classes and hidden must be positive");
    frame_ = Linear(init, options.dof + options.classes, options.hidden);
    lstm_ = Lstm(init, options.hidden, options.hidden, 1);
    out_ = Linear(init, options.hidden, options.dof);
  }

  const LstmBaselineOptions& options() const { return options_; }

  /// The `frames` poses [frames, B, dof] that follow the prior [T, B, dof] for `classes` [B, Y] (one-hot).
  /// Throws Error for any other shape or if frames is 0.
  Var operator()(const Var& prior, const Var& classes, std::size_t frames) const {
    require(prior.value().rank() == 3 && prior.dim(2) == options_.dof && classes.dim(1) == options_.classes,
            "LstmBaseline: prior ", prior.shape(), " and classes ", classes.shape(),
            ", expected [frames, batch, ", options_.dof, "] and [batch, ", options_.classes, "]");
    require(frames > 0, "LstmBaseline: frames is 0, expected at least 1");
    const std::size_t k = options_.hidden, dof = options_.dof, batch = prior.dim(1);
    const Lstm::Layer& layer = lstm_.layers.front();
    // `frame` and the LSTM's input weights are consecutive linear maps: one matrix [4k, dof + Y].
    const Var weight = matmul(layer.weight_ih, frame_.weight);
    const Var bias = layer.bias_ih + layer.bias_hh +
                     reshape(matmul(reshape(frame_.bias, {1, k}), layer.weight_ih, false, true), {4 * k});
    const auto gates = [&](const Var& x) { return linear(x, weight, {.bias = bias}); };
    const Var zero = zeros(prior.context(), {batch, k});
    const Var states = lstm_layer(gates(with_constant_channels(prior, classes)), layer.weight_hh, zero, zero);
    const Var first_h = last_state(states, 0), first_c = last_state(states, 1);
    Var h = reshape(first_h, {1, batch, k});
    if (frames > 1) {
      // The output is linear in h, so feeding it back only changes the recurrent weights; the rest of the
      // input is the same in every step. All steps are therefore one LSTM layer again.
      const Var by_pose = slice(weight, 1, 0, dof);  // [4k, dof]
      const Var recurrent = layer.weight_hh + matmul(by_pose, out_.weight);
      const Var fed = broadcast_to(out_.bias, {1, batch, dof});
      const Var each = gates(with_constant_channels(fed, classes));  // [1, B, 4k]
      const Var all = lstm_layer(broadcast_to(each, {frames - 1, batch, 4 * k}), recurrent, first_h, first_c);
      h = concatenate({h, hidden_states(all)}, 0);
    }
    return out_(h);
  }

  void list_parameters(ParameterList& list) {
    list.add_module("frame", frame_);
    list.add_module("lstm", lstm_);
    list.add_module("out", out_);
  }

 private:
  LstmBaselineOptions options_;
  Linear frame_, out_;
  Lstm lstm_;
};

}  // namespace motiongan
