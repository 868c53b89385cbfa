// Training of the attention WGAN-GP (Malek-Podjaski & Deligianni): critic, classifier and generator take
// turns, the other networks frozen.
#pragma once
#include "motiongan/models/action_gan.hpp"
#include "motiongan/networks/attention_classifier.hpp"
#include "motiongan/networks/attention_critic.hpp"
#include "motiongan/networks/body_losses.hpp"
#include "motiongan/networks/motion_losses.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/train/action_windows.hpp"
#include "motiongan/train/run.hpp"
#include "motiongan/train/wgan_gp.hpp"

namespace motiongan {

/// Options of AttentionTrainer. Where the paper (Malek-Podjaski & Deligianni) gives a value, it is the
/// default.
struct AttentionTrainOptions {
  std::size_t iterations = 20'000;  ///< each: critic_steps, one classifier step, generator_steps
  std::size_t critic_steps = 5;     ///< n_critic
  std::size_t generator_steps = 1;  ///< n_generator
  std::size_t batch = 64;           ///< windows in a step
  std::size_t rollouts = 2;         ///< n_ar: seconds generated in a row, each from the one before
  double lambda_gp = 10;            ///< weight of the gradient penalty (eq. 6)
  double weight_clip = 0;           ///< above 0: clip the critic's weights to +-weight_clip; no penalty then
  double skeleton_weight = 1;       ///< weight of L_skel (eq. 9); 0: off
  double blend_weight = 1;          ///< weight of L_blend (eq. 10); 0: off
  double class_weight = 1;          ///< weight of L_class (eq. 11); 0: off
  bool skeleton_vectors = false;    ///< L_skel compares bone vectors, as eq. 9 is printed, not bone lengths
  bool critic_classes = false;      ///< give the critic the class
  bool critic_directions = false;   ///< give the critic the directions of the bones too; the paper: no
  BodyLossOptions body{};           ///< not in the paper
  bool balanced = true;             ///< draw classes with equal probability, however many clips they have
  AdamOptions adam{};               ///< used for all three networks
  double ema = 0.999;               ///< decay of the running mean of the generator's weights; 0: none
  std::uint64_t seed = 1;           ///< of the initial weights, batches and noise

  /// Update steps in an iteration; each draws its own random numbers.
  std::size_t steps() const { return total_steps({critic_steps, 1, generator_steps}); }

  void list_fields(FieldList& list) {
    const auto loss_weight = [&](double& member, const char* key, const char* help) {
      list.add(member, {.key = key, .help = help, .range = Range::at_least(0)});
    };
    list.add(iterations,
             {.key = "iterations", .help = "how long to train", .range = Range::at_least(1), .saved = false});
    list.add(critic_steps,
             {.key = "critic_steps", .help = "critic steps in each iteration", .range = Range::at_least(1)});
    list.add(
        generator_steps,
        {.key = "generator_steps", .help = "generator steps in each iteration", .range = Range::at_least(1)});
    list.add(batch, {.key = "batch", .help = "windows in a step", .range = Range::at_least(1)});
    list.add(rollouts, {.key = "rollouts",
                        .help = "how many seconds in a row the generator makes, fed with its own output",
                        .range = Range::between(1, 64)});
    list.add(lambda_gp, {.key = "lambda_gp",
                         .help = "weight of the gradient penalty",
                         .range = Range::at_least(0),
                         .option = "--lambda"});
    list.add(weight_clip, {.key = "weight_clip",
                           .help = "above 0: clip the critic's weights there, instead of the penalty",
                           .range = Range::at_least(0)});
    loss_weight(skeleton_weight, "skeleton_weight", "weight of the bone-length loss; 0: without");
    loss_weight(blend_weight, "blend_weight", "weight of the loss at the seam; 0: without");
    loss_weight(class_weight, "class_weight", "weight of the classification loss; 0: without");
    list.add(skeleton_vectors,
             {.key = "skeleton_vectors", .help = "compare bone vectors, not their lengths"});
    list.add(critic_classes,
             {.key = "critic_classes", .help = "give the critic the class", .group = "Model"});
    list.add(critic_directions, {.key = "critic_directions",
                                 .help = "give the critic the directions of the bones too; the paper: off",
                                 .group = "Model"});
    body.list_fields(list);
    list.add(balanced, {.key = "balanced",
                        .help = "draw all classes with equal probability, however many clips they have"});
    adam.list_fields(list);
    list_ema(list, ema);
    list.add(seed, {.key = "seed", .help = "of the initial weights, batches and noise"});
  }
};

/// Losses of the last iteration.
struct AttentionLosses {
  double wasserstein = 0;     ///< mean D(real) - mean D(fake) of the last critic step
  double penalty = 0;         ///< mean (|gradient| - 1)^2; 0 with weight clipping
  double adversarial = 0;     ///< -mean D(fake) of the last generator step
  double skeleton = 0;        ///< the generator's L_skel, unweighted; 0 if its weight is 0
  double blend = 0;           ///< the generator's L_blend, likewise
  double classification = 0;  ///< the generator's L_class, likewise
  double classifier = 0;      ///< the classifier's own loss on real motion
  double accuracy = 0;        ///< the classifier's accuracy on that batch, 0..1
  double gamma = 0;           ///< gamma of the generator's attention (eq. 3); 0 without attention

  /// The columns of the log.
  std::vector<NamedLoss> named() const {
    return {{"wasserstein", wasserstein}, {"penalty", penalty},   {"adversarial", adversarial},
            {"skeleton", skeleton},       {"blend", blend},       {"classification", classification},
            {"classifier", classifier},   {"accuracy", accuracy}, {"gamma", gamma}};
  }
};

/// Fraction of the rows of logits [B, Y] whose maximum is at the label.
inline double accuracy_of(const Tensor& logits, std::span<const std::size_t> labels) {
  const std::vector<double> values = logits.to_host<double>();
  const std::size_t classes = values.size() / labels.size();
  std::size_t right = 0;
  for (std::size_t b = 0; b < labels.size(); ++b) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(b * classes);
    right += static_cast<std::size_t>(std::max_element(row, row + static_cast<std::ptrdiff_t>(classes)) -
                                      row) == labels[b];
  }
  return static_cast<double>(right) / static_cast<double>(labels.size());
}

namespace detail {

/// The sizes of the critic that trains a model.
inline AttentionCriticOptions critic_sizes(const ActionGan& model, const Bones& bones,
                                           const AttentionTrainOptions& options) {
  return {.dof = model.format().dof() + (options.critic_directions ? 3 * bones.count() : 0),
          .hidden = model.options().hidden,
          .classes = options.critic_classes ? model.format().classes.size() : 0,
          .attention = model.options().attention};
}

/// What the critic sees of a motion: its values, and if it sees directions, the bones' unit vectors, scaled
/// to vary about as much.
inline Var critic_view(const Bones& bones, const AttentionTrainOptions& options, const Var& motion) {
  return options.critic_directions ? concatenate({motion, affine(bones.directions(motion), 2)}, 2) : motion;
}

}  // namespace detail

/// Trains the attention generator of an ActionGan. Critic, classifier and generator steps can also be called
/// one by one.
class AttentionTrainer : public ModelTrainer<ActionGan, AttentionTrainOptions, AttentionLosses> {
 public:
  /// Throws Error if the model is the LSTM baseline, or if the data set's format or an option does not fit.
  AttentionTrainer(ActionGan& model, const motion::ActionDataset& data, const AttentionTrainOptions& options)
      : ModelTrainer(model, options),
        windows_(model.context(), data, data.train, options.balanced),
        bones_(model.context(), model.format()),
        critic_(Initializer(model.context(), model.options().seed + 1),
                detail::critic_sizes(model, bones_, options)),
        classifier_(Initializer(model.context(), model.options().seed + 2),
                    {.dof = model.format().dof(),
                     .classes = model.format().classes.size(),
                     .hidden = model.options().hidden,
                     .attention = model.options().attention}),
        skeleton_loss_(model.context(), model.format(), options.skeleton_vectors),
        generator_adam_(named_parameters(model), options.adam),
        critic_adam_(named_parameters(critic_), options.adam),
        classifier_adam_(named_parameters(classifier_), options.adam) {
    model.generator();  // throws for the baseline
    if (options.ema > 0) mean_.emplace(generator_adam_, options.ema);
    detail::require_same_format(data.format, model.format());
    if (options.body.contact > 0)
      require(model.format().layout.root_track(),
              "the contact loss needs the height of the feet above the ground, which a model without the "
              "root's track (--no-root) does not know");
    if (options.body.any())
      body_losses_.emplace(model.format(), options.body, windows_.draw(options.seed, 0, 256).future);
  }

  AttentionCritic& critic() { return critic_; }
  AttentionClassifier& classifier() { return classifier_; }
  std::vector<TrainedPart> parts() override {
    return {{"generator", named_parameters(model_), &generator_adam_, mean_ ? &*mean_ : nullptr},
            {"critic", named_parameters(critic_), &critic_adam_},
            {"classifier", named_parameters(classifier_), &classifier_adam_}};
  }

  /// One iteration: critic_steps critic steps, one classifier step, generator_steps generator steps.
  void iterate() override {
    follow_schedule(options_.adam.schedule);
    const KeepPacked weights_packed;
    auto step = static_cast<std::uint32_t>(iteration_ * options_.steps());
    for (std::size_t i = 0; i < options_.critic_steps; ++i) critic_step(step++);
    classifier_step(step++);
    for (std::size_t i = 0; i < options_.generator_steps; ++i) generator_step(step++);
    ++iteration_;
  }

  /// One update of the critic (eq. 6 and 7); `step` selects its random numbers. The fakes pair the outputs of
  /// rollouts r - 1 and r, with r uniform in 1..rollouts, so that later rollouts are in the critic's training
  /// distribution.
  void critic_step(std::uint32_t step) {
    const std::vector<Var> told =
        parallel_step(critic_adam_, parallel_, options_.batch,
                      [&](const BatchPart& part) { return critic_loss_of(step, part); });
    if (options_.weight_clip > 0) critic_adam_.clip(options_.weight_clip);
    wasserstein_ = told[0];
    penalty_ = told.size() > 1 ? told[1] : Var();
  }

  /// One update of the classifier (eq. 11), on real futures only.
  void classifier_step(std::uint32_t step) {
    const std::vector<Var> told =
        parallel_step(classifier_adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
          const ActionBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
          const Var logits = classifier_(Var::constant(batch.future));
          const Var loss = cross_entropy(logits, Var::constant(batch.classes));
          logits_ = logits.value();
          labels_ = batch.labels;
          if (part.count == options_.batch) return {loss, {loss}};
          const Tensor right =
              Tensor::from(model_.context(), {1}, std::vector{accuracy_of(logits_, labels_)});
          return {loss, {loss, Var::constant(right)}};
        });
    classifier_loss_ = told[0];
    accuracy_ = told.size() > 1 ? told[1] : Var();
  }

  /// The generator's loss (eq. 8) and its terms, each [1]; terms with weight 0 are empty.
  struct GeneratorLoss {
    Var total, adversarial, skeleton, blend, classification;
  };

  /// The generator's loss on a batch, averaged over the rollouts; `step` selects the noise, of samples
  /// `first` and following. Critic and classifier are frozen.
  GeneratorLoss generator_loss_of(const ActionBatch& batch, std::uint32_t step, std::size_t first = 0) {
    const Frozen critic_fixed(named_parameters(critic_)), classifier_fixed(named_parameters(classifier_));
    const RandomKey key = key_of(step, first);
    const Var classes = Var::constant(batch.classes), real_prior = Var::constant(batch.prior);
    std::vector<Var> priors, futures;
    for (std::size_t r = 0; r < options_.rollouts; ++r) {
      priors.push_back(r == 0 ? real_prior : futures.back());
      futures.push_back(model_.forward(priors.back(), classes, noise_key(key, r)));
    }
    // All rollouts concatenated along the batch: the mean over the batch averages over rollouts too.
    const auto repeated = [&](const Var& x, std::size_t axis) {
      return concatenate(std::vector<Var>(options_.rollouts, x), axis);
    };
    const Var fed = concatenate(priors, 1), made = concatenate(futures, 1),
              all_classes = repeated(classes, 0);
    GeneratorLoss loss;
    loss.adversarial = generator_loss(score(seen(concatenate({fed, made}, 0)), all_classes));
    loss.total = loss.adversarial;
    const auto add = [&](Var& part, double weight, const Var& value) {
      part = value;
      loss.total = weighted_sum(loss.total, 1, value, weight);
    };
    if (options_.skeleton_weight > 0)
      add(loss.skeleton, options_.skeleton_weight,
          skeleton_loss_(repeated(slice(real_prior, 0, 0, 1), 1), made));
    if (options_.blend_weight > 0) add(loss.blend, options_.blend_weight, blend_loss(fed, made));
    if (body_losses_)
      loss.total = loss.total +
                   (*body_losses_)(with_seam(fed, made), with_seam(real_prior, Var::constant(batch.future)));
    if (options_.class_weight > 0)
      add(loss.classification, options_.class_weight, cross_entropy(classifier_(made), all_classes));
    return loss;
  }

  /// One update of the generator; no gradient flows to critic and classifier.
  void generator_step(std::uint32_t step) {
    const Frozen critic_fixed(named_parameters(critic_)), classifier_fixed(named_parameters(classifier_));
    const std::vector<Var> told =
        parallel_step(generator_adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
          const GeneratorLoss loss =
              generator_loss_of(windows_.draw(options_.seed, step, part.count, part.first), step, part.first);
          PartLoss out{loss.total};
          for (const Var& term :
               {loss.total, loss.adversarial, loss.skeleton, loss.blend, loss.classification})
            if (!term.empty()) out.told.push_back(term);
          return out;
        });
    if (mean_) mean_->update();
    std::size_t at = 0;
    const auto next = [&](bool has) { return has ? told[at++] : Var(); };
    generator_loss_.total = next(true), generator_loss_.adversarial = next(true);
    generator_loss_.skeleton = next(options_.skeleton_weight > 0);
    generator_loss_.blend = next(options_.blend_weight > 0);
    generator_loss_.classification = next(options_.class_weight > 0);
  }

  AttentionLosses losses() const override {
    require(!generator_loss_.total.empty(), "no iteration has run yet");
    const auto value = [](const Var& part) { return part.empty() ? 0.0 : part.item(); };
    const auto& attention = model_.generator().attention();
    return {.wasserstein = wasserstein_.item(),
            .penalty = value(penalty_),
            .adversarial = generator_loss_.adversarial.item(),
            .skeleton = value(generator_loss_.skeleton),
            .blend = value(generator_loss_.blend),
            .classification = value(generator_loss_.classification),
            .classifier = classifier_loss_.item(),
            .accuracy = accuracy_.empty() ? accuracy_of(logits_, labels_) : accuracy_.item(),
            .gamma = attention ? attention->gamma.item() : 0};
  }

 private:
  RandomKey key_of(std::uint32_t step, std::size_t first) const {
    return {.seed = options_.seed, .step = step, .first_sample = static_cast<std::uint32_t>(first)};
  }

  /// The critic's loss on a part of a batch.
  PartLoss critic_loss_of(std::uint32_t step, const BatchPart& part) {
    const RandomKey key = key_of(step, part.first);
    const ActionBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
    const Var classes = Var::constant(batch.classes);
    Var prior = Var::constant(batch.prior), future;
    {
      const NoGrad values_only;
      // One number for all parts of a batch.
      const std::size_t times =
          1 + random_below(key_of(step, 0).with(RandomStream::rollout), 0, options_.rollouts);
      for (std::size_t r = 0; r < times; ++r) {
        if (r > 0) prior = future;
        future = model_.forward(prior, classes, noise_key(key, r));
      }
      future = concatenate({prior, future}, 0);
    }
    const CriticFn critic = [&](const Var& x) { return score(x, classes); };
    const CriticFn critic_of_pairs = [&](const Var& x) {
      return score(x, concatenate({classes, classes}, 0));
    };
    Tensor real, fake;
    {
      const NoGrad values_only;
      real = seen(Var::constant(batch.motion)).value(), fake = seen(future).value();
    }
    if (options_.weight_clip > 0) {
      const CriticLoss loss = critic_loss(critic_of_pairs, real, fake);
      return {loss.loss, {loss.wasserstein}};
    }
    const CriticLoss loss =
        critic_loss(critic_of_pairs, critic, real, fake,
                    random_uniform(model_.context(), key.with(RandomStream::interpolation), part.count),
                    options_.lambda_gp);
    return {loss.loss, {loss.wasserstein, loss.penalty}};
  }

  /// A different noise for each rollout of a step.
  static RandomKey noise_key(RandomKey key, std::size_t rollout) {
    key.first_frame = static_cast<std::int32_t>(rollout);
    return key;
  }

  /// A future with the last frames of the motion before it, of which the jerk at the seam is made.
  static Var with_seam(const Var& prior, const Var& future) {
    const std::size_t frames = std::min<std::size_t>(prior.dim(0), 3);
    return concatenate({slice(prior, 0, prior.dim(0) - frames, frames), future}, 0);
  }

  Var seen(const Var& motion) const { return detail::critic_view(bones_, options_, motion); }

  Var score(const Var& motion, const Var& classes) const {
    return options_.critic_classes ? critic_(motion, classes) : critic_(motion);
  }

  ActionSampler windows_;
  Bones bones_;
  AttentionCritic critic_;
  AttentionClassifier classifier_;
  SkeletonLoss skeleton_loss_;
  std::optional<BodyLosses> body_losses_;
  Adam generator_adam_, critic_adam_, classifier_adam_;
  std::optional<WeightMean> mean_;  // of the generator
  Var wasserstein_, penalty_, classifier_loss_;
  Var accuracy_;  // of the last batch, if it was divided; else that of the logits
  GeneratorLoss generator_loss_;
  Tensor logits_;
  std::vector<std::size_t> labels_;
};

/// Trains the attention generator: a whole run, see run_training(). The model then has the running mean of
/// its weights, as the file of the run's generator has.
inline RunResult train(ActionGan& model, const motion::ActionDataset& data,
                       const AttentionTrainOptions& options, const RunOptions& run = {}) {
  AttentionTrainer trainer(model, data, options);
  const RunResult result = run_training(
      trainer, [&](const std::filesystem::path& path) { data.write_split(path); }, run);
  use_means(trainer);
  return result;
}

}  // namespace motiongan
