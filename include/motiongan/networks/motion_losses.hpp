// Auxiliary generator losses of the attention WGAN-GP (Malek-Podjaski & Deligianni, eq. 9 and 10).
#pragma once
#include "motiongan/networks/bones.hpp"

namespace motiongan {

/// L_skel (Malek-Podjaski & Deligianni, eq. 9): bones of the generated motion against those of the real
/// prior's first frame, on de-normalised positions. Lengths are divided by the skeleton's mean bone length,
/// which makes the loss independent of the unit; bones of zero rest length are left out.
class SkeletonLoss {
 public:
  /// `vectors`: compare bone vectors, as eq. 9 is printed, instead of bone lengths. Throws Error if no bone
  /// has a length.
  SkeletonLoss(const Context& context, const motion::PositionFormat& format, bool vectors = false)
      : bones_(context, format), vectors_(vectors) {}

  /// The loss, [1], of a prior [1 or more frames, B, dof] and a future [T, B, dof], both normalised: the sum
  /// over bones of the mean over frames of (|bone in the prior's first frame| - |bone in the future|)^2,
  /// averaged over samples.
  Var operator()(const Var& prior, const Var& future) const {
    const std::size_t frames = future.dim(0), batch = future.dim(1);
    const Var made = measured(future), given = measured(slice(prior, 0, 0, 1));
    const Var miss = made - broadcast_to(given, made.shape());
    const double unit = bones_.mean_length();
    return affine(sum(square(miss)), 1 / (static_cast<double>(frames * batch) * unit * unit));
  }

 private:
  /// Bone vectors [T, B, 3 * bones], or their lengths [T, B, bones].
  Var measured(const Var& motion) const {
    const Var vectors = bones_.vectors(motion);
    return vectors_ ? vectors : bones_.lengths(vectors);
  }

  Bones bones_;
  bool vectors_;
};

/// L_blend (Malek-Podjaski & Deligianni, eq. 10), [1]: squared difference between the last frame of the prior
/// [T, B, dof] and the first frame of the future [T, B, dof], both normalised, summed over channels and
/// averaged over samples.
inline Var blend_loss(const Var& prior, const Var& future) {
  const Var step = slice(future, 0, 0, 1) - slice(prior, 0, prior.dim(0) - 1, 1);
  return affine(sum(square(step)), 1 / static_cast<double>(future.dim(1)));
}

}  // namespace motiongan
