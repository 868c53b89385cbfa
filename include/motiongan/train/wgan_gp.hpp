// The losses of a Wasserstein GAN with gradient penalty (Gulrajani et al. 2017), for any critic of motion.
#pragma once
#include <functional>

#include "motiongan/autograd/grad.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// A critic with everything but the motion fixed: [T, B, C] -> [B].
using CriticFn = std::function<Var(const Var& motion)>;

/// eps*real + (1-eps)*fake with one eps [B] per sample; a leaf, so that a gradient with respect to it can be taken.
inline Var interpolate(const Tensor& real, const Tensor& fake, const Tensor& eps) {
  const NoGrad values_only;
  const Var r = Var::constant(real), f = Var::constant(fake);
  const Var e = broadcast_to(reshape(Var::constant(eps), {real.dim(1), 1}), real.shape());
  return Var::leaf((f + e * (r - f)).value());
}

/// mean over samples of (|gradient of the critic at x| - 1)^2, [1]; the norm is over all frames and channels
/// of a sample. Itself differentiable with respect to the critic's parameters. `x` is a leaf.
inline Var gradient_penalty(const CriticFn& critic, const Var& x) {
  const Var gradient = grad(critic(x), {x}, {.create_graph = true})[0];
  const Var norm = sqrt(sum_per_sample(square(gradient)) + 1e-12);
  return mean(square(norm - 1));
}

/// The parts of the critic's loss, each [1].
struct CriticLoss {
  Var loss;         ///< mean D(fake) - mean D(real) + lambda * penalty
  Var wasserstein;  ///< mean D(real) - mean D(fake), the estimate of the distance
  Var penalty;      ///< mean (|gradient| - 1)^2; empty without a penalty
  Var scores;       ///< [2B]: of the real, then of the fake motions
};

/// Without a penalty, for a critic whose weights are clipped (Arjovsky et al. 2017). `critic_of_pairs` scores
/// real and fake motions joined along the batch, [T, 2B, C] -> [2B].
inline CriticLoss critic_loss(const CriticFn& critic_of_pairs, const Tensor& real, const Tensor& fake) {
  const std::size_t batch = real.dim(1);
  CriticLoss out;
  out.scores = critic_of_pairs(concatenate({Var::constant(real), Var::constant(fake)}, 1));
  out.wasserstein = mean(slice(out.scores, 0, 0, batch)) - mean(slice(out.scores, 0, batch, batch));
  out.loss = -out.wasserstein;
  return out;
}

/// With the gradient penalty (Gulrajani et al. 2017). `critic` scores a batch of B; eps [B] says where
/// between real and fake each sample's gradient is taken.
inline CriticLoss critic_loss(const CriticFn& critic_of_pairs, const CriticFn& critic, const Tensor& real,
                              const Tensor& fake, const Tensor& eps, double lambda) {
  CriticLoss out = critic_loss(critic_of_pairs, real, fake);
  out.penalty = gradient_penalty(critic, interpolate(real, fake, eps));
  out.loss = weighted_sum(out.penalty, lambda, out.wasserstein, -1);
  return out;
}

/// -mean D(fake), [1].
inline Var generator_loss(const Var& fake_scores) { return -mean(fake_scores); }

}  // namespace motiongan
