// The RNN ranker of DVGAN (Lin & Amer, eq. 9).
#pragma once
#include "motiongan/networks/cnn_ranker.hpp"
#include "motiongan/networks/difference_lstm.hpp"

namespace motiongan {

/// Embeds texts and motions in one space; a motion's embedding combines the mean of its poses with the mean
/// of an LSTM's states over its frame differences.
class RnnRanker {
 public:
  /// Throws Error if vocabulary, dof or hidden is 0.
  RnnRanker(Initializer init, const RankerSizes& sizes) : sizes_(sizes) {
    require(sizes.vocabulary > 0 && sizes.dof > 0 && sizes.hidden > 0,
            "RnnRanker: vocabulary, dof and hidden must be positive");
    const std::size_t k = sizes.hidden;
    text_ = TextEncoder(init, sizes.vocabulary, k);
    pose_ = Linear(init, sizes.dof, k);
    diff_ = Linear(init, sizes.dof, k);
    lstm_ = Lstm(init, k, k, 2);
    motion_ = Linear(init, k, k);
    combine_ = Linear(init, 2 * k, k);
  }

  /// Embeddings [K, k] of K descriptions.
  Var describe(const Sentences& text) const { return text_(text); }

  /// The embedding combine([h_d, h_a]), [B, k], of normalised motion [N, B, M], N >= 2; not normalised to
  /// unit length. `pose` and `motion` are linear, so the means are taken before them. Throws Error for
  /// another shape.
  Var embed(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(0) >= 2 && motion.dim(2) == sizes_.dof,
            "RnnRanker: motion ", motion.shape(), ", expected [2 or more frames, batch, ", sizes_.dof, "]");
    const Var h_a = pose_(mean(motion, 0));
    const Var h_d = motion_(mean(difference_lstm(diff_, lstm_, frame_differences(motion)), 0));
    return combine_(concatenate({h_d, h_a}, 1));
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    list.add_module("pose", pose_);
    list.add_module("diff", diff_);
    list.add_module("lstm", lstm_);
    list.add_module("motion", motion_);
    list.add_module("combine", combine_);
  }

 private:
  RankerSizes sizes_;
  TextEncoder text_;
  Linear pose_, diff_;
  Lstm lstm_;
  Linear motion_, combine_;
};

}  // namespace motiongan
