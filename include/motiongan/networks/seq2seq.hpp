// Residual seq2seq (Martinez, Black & Romero, "On human motion prediction using recurrent neural networks",
// 2017): a baseline for motion completion.
#pragma once
#include "motiongan/networks/attention_block.hpp"
#include "motiongan/nn/gru.hpp"
#include "motiongan/ops/gru_rollout.hpp"

namespace motiongan {

/// Options of a Seq2seq.
struct Seq2seqOptions {
  std::size_t dof = 0;        ///< values per pose
  std::size_t classes = 0;    ///< Y, for the class appended to every pose; 0: unconditional
  std::size_t hidden = 1024;  ///< width of the GRU
};

/// One GRU, with the same weights in encoder and decoder, and a linear layer `out`: each pose is the previous
/// one plus out(state).
class Seq2seq {
 public:
  /// Throws Error if dof or hidden is 0.
  Seq2seq(Initializer init, const Seq2seqOptions& options) : options_(options) {
    require(options.dof > 0 && options.hidden > 0, "Seq2seq: dof and hidden must be positive");
    gru_ = Gru(init, options.dof + options.classes, options.hidden);
    out_ = Linear(init, options.hidden, options.dof);
  }

  const Seq2seqOptions& options() const { return options_; }

  /// The `frames` poses [frames, B, dof] that follow the prefix [n, B, dof]. `classes` [B, Y] (one-hot) are
  /// ignored by an unconditional model. The encoder reads the first n - 1 frames, the decoder starts from the
  /// last one. Throws Error for any other shape or if frames is 0.
  Var operator()(const Var& prefix, const Var& classes, std::size_t frames) const {
    require(prefix.value().rank() == 3 && prefix.dim(2) == options_.dof && frames > 0, "Seq2seq: prefix ",
            prefix.shape(), " and frames ", frames, ", expected [frames, batch, ", options_.dof,
            "] and at least 1");
    require(options_.classes == 0 || (!classes.empty() && classes.dim(1) == options_.classes),
            "Seq2seq: the model is class-conditional; expected classes [batch, ", options_.classes, "]");
    const std::size_t batch = prefix.dim(1), dof = options_.dof, k = options_.hidden;
    const bool sees_class = options_.classes > 0;
    const Var x = sees_class ? with_constant_channels(prefix, classes) : prefix;
    const Var x_gates = linear(x, gru_.weight_ih, {.bias = gru_.bias_ih});  // all frames in one product
    Var each = broadcast_to(gru_.bias_ih, {batch, 3 * k}), by_pose = gru_.weight_ih;
    if (sees_class) {
      by_pose = slice(gru_.weight_ih, 1, 0, dof);
      each = each + matmul(classes, slice(gru_.weight_ih, 1, dof, options_.classes), false, true);
    }
    const Var last = reshape(slice(prefix, 0, prefix.dim(0) - 1, 1), {batch, dof});
    return gru_rollout(x_gates, each, last, {gru_.weight_hh, gru_.bias_hh, by_pose, out_.weight, out_.bias},
                       frames);
  }

  void list_parameters(ParameterList& list) {
    list.add_module("gru", gru_);
    list.add_module("out", out_);
  }

 private:
  Seq2seqOptions options_;
  Gru gru_;
  Linear out_;
};

}  // namespace motiongan
