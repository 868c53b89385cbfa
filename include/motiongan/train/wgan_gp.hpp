// The losses of a Wasserstein GAN with gradient penalty (Gulrajani et al. 2017; Lin & Amer, eq. 3), for any
// critic of motion.
#pragma once
#include <functional>

#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// A critic as a function of the motion alone: [T, B, C] -> [B].
using CriticFn = std::function<Var(const Var& motion)>;

/// eps * real + (1 - eps) * fake, with one eps [B] per sample, as a leaf that gradients can be taken with
/// respect to.
inline Var interpolate(const Tensor& real, const Tensor& fake, const Tensor& eps) {
  const NoGrad values_only;
  const Var r = Var::constant(real), f = Var::constant(fake);
  const Var e = broadcast_to(reshape(Var::constant(eps), {real.dim(1), 1}), real.shape());
  return Var::leaf((f + e * (r - f)).value());
}

/// The gradient penalty, [1]: the mean over samples of (|dD/dx| - 1)^2 at the leaf `x`, the norm taken over
/// all frames and channels of a sample. Differentiable with respect to the critic's parameters.
inline Var gradient_penalty(const CriticFn& critic, const Var& x) {
  const Var gradient = grad(critic(x), {x}, {.create_graph = true})[0];
  const Var norm = sqrt(sum_per_sample(square(gradient)) + 1e-12);
  return mean(square(norm - 1));
}

/// The critic's loss and its terms, each [1].
struct CriticLoss {
  Var loss;         ///< mean D(fake) - mean D(real) + lambda * penalty
  Var wasserstein;  ///< mean D(real) - mean D(fake), the estimate of the Wasserstein distance
  Var penalty;      ///< mean (|gradient| - 1)^2; empty without a penalty
  Var scores;       ///< [2B]: scores of the real, then of the fake motions
};

/// The critic's loss without a penalty, for weight clipping (Arjovsky et al. 2017). `critic_of_pairs` scores
/// real and fake motions concatenated along the batch, [T, 2B, C] -> [2B].
inline CriticLoss critic_loss(const CriticFn& critic_of_pairs, const Tensor& real, const Tensor& fake) {
  const std::size_t batch = real.dim(1);
  CriticLoss out;
  out.scores = critic_of_pairs(concatenate({Var::constant(real), Var::constant(fake)}, 1));
  out.wasserstein = mean(slice(out.scores, 0, 0, batch)) - mean(slice(out.scores, 0, batch, batch));
  out.loss = -out.wasserstein;
  return out;
}

/// The critic's loss with the gradient penalty (Gulrajani et al. 2017). `critic` scores a batch of B; eps
/// [B], in 0..1, is the interpolation between fake (0) and real (1) at which each sample's gradient is taken.
inline CriticLoss critic_loss(const CriticFn& critic_of_pairs, const CriticFn& critic, const Tensor& real,
                              const Tensor& fake, const Tensor& eps, double lambda) {
  CriticLoss out = critic_loss(critic_of_pairs, real, fake);
  out.penalty = gradient_penalty(critic, interpolate(real, fake, eps));
  out.loss = weighted_sum(out.penalty, lambda, out.wasserstein, -1);
  return out;
}

/// The generator's adversarial loss, -mean D(fake), [1].
inline Var generator_loss(const Var& fake_scores) { return -mean(fake_scores); }

}  // namespace motiongan
