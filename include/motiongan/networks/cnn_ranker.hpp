// The CNN ranker of DVGAN, which has the CNN critic's trunk (Lin & Amer, eq. 8).
#pragma once
#include "motiongan/networks/cnn_trunk.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// Sizes of either ranker, CNN or RNN.
struct RankerSizes {
  std::size_t vocabulary = 0;  ///< number of words
  std::size_t dof = 0;         ///< M, values per pose
  std::size_t frames = 32;     ///< N, frames per window; a power of two for the CNN
  std::size_t hidden = 1024;   ///< k, hidden width
  std::size_t taps = 3;        ///< kernel size of the CNN's convolutions: 3 or 5
};

/// Embeds texts and motions in one space; a motion's embedding is its coarsest level.
class CnnRanker {
 public:
  /// Throws Error if a size is 0 or frames is not a power of two of at least 2.
  CnnRanker(Initializer init, const RankerSizes& sizes) : sizes_(sizes) {
    require(sizes.vocabulary > 0 && sizes.dof > 0 && sizes.hidden > 0,
            "CnnRanker: vocabulary, dof and hidden must be positive");
    require(sizes.frames >= 2, "CnnRanker: windows of ", sizes.frames, " frames, expected at least 2");
    text_ = TextEncoder(init, sizes.vocabulary, sizes.hidden);
    trunk_ = CnnTrunk(init, sizes.dof, sizes.frames, sizes.hidden, sizes.taps);
  }

  /// Embeddings [K, k] of K descriptions.
  Var describe(const Sentences& text) const { return text_(text); }

  /// The embedding h_0, [B, k], of normalised motion [N, B, M]; not normalised to unit length. Throws Error
  /// for another N or M.
  Var embed(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(0) == sizes_.frames && motion.dim(2) == sizes_.dof,
            "CnnRanker: motion ", motion.shape(), ", expected [", sizes_.frames, ", batch, ", sizes_.dof,
            "]");
    Var h = CnnTrunk::with_ones(motion);
    const Var encode = trunk_.encoding();
    for (std::size_t i = trunk_.levels(); i-- > 0;) h = trunk_.halve(i, h, encode);
    return reshape(h, {motion.dim(1), sizes_.hidden});
  }

  void list_parameters(ParameterList& list) {
    list.add_module("text", text_);
    trunk_.list_parameters(list);
  }

 private:
  RankerSizes sizes_;
  TextEncoder text_;
  CnnTrunk trunk_;
};

}  // namespace motiongan
