// Auxiliary generator losses of the attention WGAN-GP (Malek-Podjaski & Deligianni, eq. 9 and 10).
#pragma once
#include "motiongan/data/position_format.hpp"
#include "motiongan/ops/conv1d.hpp"

namespace motiongan {

/// L_skel (Malek-Podjaski & Deligianni, eq. 9): bones of the generated motion against those of the real
/// prior's first frame, on de-normalised positions. Lengths are divided by the skeleton's mean bone length,
/// which makes the loss independent of the unit; bones of zero rest length are left out.
class SkeletonLoss {
 public:
  /// `vectors`: compare bone vectors, as eq. 9 is printed, instead of bone lengths. Throws Error if no bone
  /// has a length.
  SkeletonLoss(const Context& context, const motion::PositionFormat& format, bool vectors = false)
      : bones_(format.bones().size()), mean_length_(format.mean_bone_length()), vectors_(vectors) {
    require(bones_ > 0, "the skeleton has no bone of non-zero length; the skeleton loss needs at least one");
    map_ = Var::constant(Tensor::from(context, {1, 3 * bones_, format.dof()}, format.bone_map()));
    shift_ = Var::constant(Tensor::from(context, {3 * bones_}, format.bone_shift()));
  }

  /// The loss, [1], of a prior [1 or more frames, B, dof] and a future [T, B, dof], both normalised: the sum
  /// over bones of the mean over frames of (|bone in the prior's first frame| - |bone in the future|)^2,
  /// averaged over samples.
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

/// L_blend (Malek-Podjaski & Deligianni, eq. 10), [1]: squared difference between the last frame of the prior
/// [T, B, dof] and the first frame of the future [T, B, dof], both normalised, summed over channels and
/// averaged over samples.
inline Var blend_loss(const Var& prior, const Var& future) {
  const Var step = slice(future, 0, 0, 1) - slice(prior, 0, prior.dim(0) - 1, 1);
  return affine(sum(square(step)), 1 / static_cast<double>(future.dim(1)));
}

}  // namespace motiongan
