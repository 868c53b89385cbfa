// LSTM-3LR (Fragkiadaki, Levine, Felsen & Malik, "Recurrent network models for human dynamics",
// 2015): a baseline for motion completion.
#pragma once
#include "motiongan/networks/lstm_stack.hpp"

namespace motiongan {

/// Options of an Lstm3lr.
struct Lstm3lrOptions {
  std::size_t dof = 0;        ///< values per pose
  std::size_t hidden = 1000;  ///< width of each layer
};

/// Three LSTM layers `lstm` over poses, then a linear layer `out` = the next pose.
class Lstm3lr {
 public:
  /// Throws Error if dof or hidden is 0.
  Lstm3lr(Initializer init, const Lstm3lrOptions& options) : options_(options) {
    require(options.dof > 0 && options.hidden > 0, "Lstm3lr: dof and hidden must be positive");
    lstm_ = Lstm(init, options.dof, options.hidden, 3);
    out_ = Linear(init, options.hidden, options.dof);
  }

  const Lstm3lrOptions& options() const { return options_; }

  /// The next pose after each pose of x, [T, B, dof] -> [T, B, dof]; advances `state`.
  Var next_poses(const Var& x, LstmState& state) const {
    require(x.value().rank() == 3 && x.dim(2) == options_.dof, "Lstm3lr: poses ", x.shape(),
            ", expected [frames, batch, ", options_.dof, "]");
    return out_(lstm_.advance(x, state));
  }

  /// The `frames` poses [frames, B, dof] that follow the prefix [n, B, dof], fed with its own output.
  Var operator()(const Var& prefix, std::size_t frames) const { return closed_loop(*this, prefix, frames); }

  void list_parameters(ParameterList& list) {
    list.add_module("lstm", lstm_);
    list.add_module("out", out_);
  }

 private:
  Lstm3lrOptions options_;
  Lstm lstm_;
  Linear out_;
};

}  // namespace motiongan
