// The ranker with the CNN critic's trunk (Lin & Amer, eq. 8; SPEC 7).
#pragma once
#include "motiongan/networks/cnn_trunk.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// Sizes of either ranker.
struct RankerSizes {
  std::size_t vocabulary = 0;  ///< words
  std::size_t dof = 0;         ///< numbers of a pose, M
  std::size_t frames = 32;     ///< N; of the CNN a power of two
  std::size_t hidden = 1024;   ///< k
  std::size_t taps = 3;        ///< of the CNN's convolutions: 3 or 5
};

/// Embeds a motion by its coarsest time scale.
class CnnRanker {
 public:
  CnnRanker(Initializer init, const RankerSizes& sizes) : sizes_(sizes) {
    require(sizes.vocabulary > 0 && sizes.dof > 0 && sizes.hidden > 0,
            "CnnRanker: vocabulary, dof and hidden must be positive");
    require(sizes.frames >= 2, "CnnRanker: windows of ", sizes.frames, " frames, expected 2 or more");
    text_ = TextEncoder(init, sizes.vocabulary, sizes.hidden);
    trunk_ = CnnTrunk(init, sizes.dof, sizes.frames, sizes.hidden, sizes.taps);
  }

  /// [K, k] of K descriptions.
  Var describe(const Sentences& text) const { return text_(text); }

  /// h_0, [B, k], of motion [N, B, M]. Not of length 1 yet.
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
