// What the second paper's generator is told beside its critic: bones keep their lengths, motions join (eq. 9,
// 10).
#pragma once
#include "motiongan/data/position_format.hpp"
#include "motiongan/ops/conv1d.hpp"

namespace motiongan {

/// L_skel (Malek-Podjaski & Deligianni, eq. 9; SPEC 5): bones of generated motion against those of the real
/// prior's first frame, on de-normalised positions. Lengths are divided by the skeleton's mean bone length,
/// for units differ; bones without a length at rest are left out.
class SkeletonLoss {
 public:
  /// `vectors`: compare bone vectors, as eq. 9 is printed, instead of their lengths.
  SkeletonLoss(const Context& context, const motion::PositionFormat& format, bool vectors = false)
      : bones_(format.bones().size()), mean_length_(format.mean_bone_length()), vectors_(vectors) {
    require(bones_ > 0,
            "the skeleton has no bone of any length: there is nothing for the skeleton loss to keep");
    map_ = Var::constant(Tensor::from(context, {1, 3 * bones_, format.dof()}, format.bone_map()));
    shift_ = Var::constant(Tensor::from(context, {3 * bones_}, format.bone_shift()));
  }

  /// Of prior [1 or more frames, B, dof] and future [T, B, dof], both normalised: the sum over bones of the
  /// mean over frames of (|bone in the prior's first frame| - |bone in the future|)^2, mean over samples,
  /// [1].
  Var operator()(const Var& prior, const Var& future) const {
    const std::size_t frames = future.dim(0), batch = future.dim(1);
    const Var made = measured(future), given = measured(slice(prior, 0, 0, 1));
    const Var miss = made - broadcast_to(given, made.shape());
    return affine(sum(square(miss)), 1 / (static_cast<double>(frames * batch) * mean_length_ * mean_length_));
  }

 private:
  /// Bone vectors [T, B, 3 * bones], or their lengths [T, B, bones].
  Var measured(const Var& motion) const {
    Var bones = linear(motion, map_, {.bias = shift_});
    if (vectors_) return bones;
    return sqrt(sum(square(reshape(bones, {motion.dim(0), motion.dim(1), bones_, 3})), -1) + 1e-12);
  }

  std::size_t bones_;
  double mean_length_;
  bool vectors_;
  Var map_, shift_;
};

/// L_blend (eq. 10): |last frame of the prior that was fed - first frame made|^2, in normalised space, summed
/// over channels, mean over samples, [1].
inline Var blend_loss(const Var& prior, const Var& future) {
  const Var step = slice(future, 0, 0, 1) - slice(prior, 0, prior.dim(0) - 1, 1);
  return affine(sum(square(step)), 1 / static_cast<double>(future.dim(1)));
}

}  // namespace motiongan
