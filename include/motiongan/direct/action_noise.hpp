// The noise and the class of a class-conditioned motion as variables.
#pragma once
#include <vector>

#include "motiongan/direct/noise.hpp"
#include "motiongan/sample/action_generate.hpp"

namespace motiongan {

/// What is free in a batch of motions that continue priors: the noise of every step, if the model takes
/// noise, which only turns (see NoiseVariable), and its class. The class that is asked for keeps half of the
/// weight at least; the rest may go to the others. With their weights u, S the sum of their squares and e the
/// one-hot class, a generator sees (1 - S / (2 + 2 S)) e + u^2 / (2 + 2 S).
class ActionNoise {
 public:
  /// Motions that continue `prior` [T, B, dof] for steps_of() a schedule, of which the first is number
  /// key.first_frame of its motion. Noise is drawn as ActionStream does, for samples key.first_sample and
  /// following.
  ActionNoise(const ActionGan& model, ActionSchedule steps, Var prior, const RandomKey& key)
      : model_(model), steps_(std::move(steps)), prior_(std::move(prior)) {
    const Context& context = model.context();
    const std::size_t batch = prior_.dim(1), classes = model.format().classes.size();
    const NoGrad values_only;
    std::vector<Var> noise, asked, weights;
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      RandomKey own = key;
      own.first_frame += static_cast<std::int32_t>(s);
      if (model.options().noise_dim > 0) noise.push_back(model.noise(batch, own));
      const std::vector<std::size_t> labels(batch, steps_[s].label);
      asked.push_back(Var::constant(one_hot(context, labels, classes)));
      // Small, and not nothing: at nothing their squares have no derivative.
      weights.push_back(
          affine(Var::constant(random_normal(context, own.with(RandomStream::seeding), 1, batch, classes)
                                   .reshape({batch, classes})),
                 0.01));
    }
    if (!noise.empty()) noise_ = detail::TurningVectors(concatenate(noise, 0));
    asked_ = concatenate(asked, 0);
    weights_ = Var::leaf(concatenate(weights, 0).value());
  }

  /// For an optimizer.
  std::vector<NamedParameter> parameters() {
    std::vector<NamedParameter> out{{"classes", &weights_}};
    if (has_noise()) out.push_back({"noise", &noise_.variable()});
    return out;
  }

  /// Normalised motion [1 + frames, B, dof]: the prior's last frame, and what is made.
  Var motion() const {
    const std::size_t batch = prior_.dim(1), all = prior_.dim(0);
    const Var classes = mixed_classes(), noise = has_noise() ? noise_.value() : Var();
    Var made = prior_;
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      const Var last = slice(made, 0, made.dim(0) - all, all), own = slice(classes, 0, s * batch, batch);
      const Var next =
          model_.is_baseline()
              ? model_.baseline()(last, own, all)
              : model_.generator()(last, own, has_noise() ? slice(noise, 0, s * batch, batch) : Var());
      made = concatenate({made, slice(next, 0, 0, steps_[s].frames)}, 0);
    }
    return slice(made, 0, all - 1, made.dim(0) - all + 1);
  }

  /// How far the noise has turned, and how much of the classes has gone to others, [1].
  Var turned_away() const {
    const Var others = sum(square(asked_ - mixed_classes()));
    return has_noise() ? noise_.turned_away() + others : others;
  }

 private:
  bool has_noise() const { return model_.options().noise_dim > 0; }

  /// [steps * B, Y]; rows are not negative and add up to 1.
  Var mixed_classes() const {
    const Var squares = square(weights_), all = reshape(sum(squares, 1), {weights_.dim(0), 1});
    const Var twice = broadcast_to(affine(all, 2, 2), asked_.shape());
    return affine(broadcast_to(all, asked_.shape()) / twice, -1, 1) * asked_ + squares / twice;
  }

  const ActionGan& model_;
  ActionSchedule steps_;
  Var prior_;
  detail::TurningVectors noise_;
  Var asked_;    // [steps * B, Y], one-hot
  Var weights_;  // [steps * B, Y]
};

}  // namespace motiongan
