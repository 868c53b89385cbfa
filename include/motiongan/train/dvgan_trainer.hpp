// Training of DVGAN (Lin & Amer, section 5.2). Nothing is read back from the device between steps.
#pragma once
#include "motiongan/models/dvgan.hpp"
#include "motiongan/networks/body_losses.hpp"
#include "motiongan/networks/dvgan_critic.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/train/run.hpp"
#include "motiongan/train/wgan_gp.hpp"
#include "motiongan/train/windows.hpp"

namespace motiongan {

/// Options of DvganTrainer. The defaults are the paper's (Lin & Amer, section 5.2).
struct DvganTrainOptions {
  std::size_t iterations = 20'000;  ///< each is `critic_steps` critic steps and one generator step
  std::size_t critic_steps = 10;    ///< for each step of the generator
  std::size_t batch = 64;           ///< windows in a step
  double lambda_gp = 10;            ///< weight of the gradient penalty (eq. 3)
  AdamOptions adam{};               ///< used for both networks
  bool input_shift = true;          ///< shift each real/fake pair by up to +-N/2 frames at the critic's input
  DvganCriticOptions critic{};      ///< which critic, and what it sees
  BodyLossOptions body{};           ///< not in the paper
  /// Fraction of the steps, 0..1, whose fakes are completions of the first 1 to N/2 frames of the real motion
  /// (the same number for the whole batch). Not in the paper: training on completions improves completion.
  /// Above 0 it requires an RNN generator.
  double completion_share = 0;
  double ema = 0.999;      ///< decay of the running mean of the generator's weights (WeightMean); 0: none
  std::uint64_t seed = 1;  ///< of the initial weights, batches and noise

  /// Update steps in an iteration; each draws its own random numbers.
  std::size_t steps() const { return total_steps({critic_steps, 1}); }

  void list_fields(FieldList& list) {
    list.add(iterations,
             {.key = "iterations", .help = "how long to train", .range = Range::at_least(1), .saved = false});
    list.add(critic_steps,
             {.key = "critic_steps", .help = "critic steps in each iteration", .range = Range::at_least(1)});
    list.add(batch, {.key = "batch", .help = "motions in a step", .range = Range::at_least(1)});
    list.add(lambda_gp, {.key = "lambda_gp",
                         .help = "weight of the gradient penalty",
                         .range = Range::at_least(0),
                         .option = "--lambda"});
    adam.list_fields(list);
    list.add(
        input_shift,
        {.key = "input_shift", .help = "shift motions in time at the critic's input", .option = "--shift"});
    critic.list_fields(list);
    body.list_fields(list);
    list.add(completion_share,
             {.key = "completion_share",
              .help = "fraction of the steps in which the RNN generator completes real first frames; the "
                      "paper: 0",
              .range = Range::between(0, 1),
              .option = "--completions",
              .type = "FRACTION"});
    list_ema(list, ema);
    list.add(seed, {.key = "seed", .help = "of the initial weights, batches and noise"});
  }
};

/// Losses of the last iteration.
struct DvganLosses {
  double wasserstein = 0;  ///< mean D(real) - mean D(fake) of the last critic step
  double penalty = 0;      ///< mean (|gradient| - 1)^2
  double generator = 0;    ///< -mean D(fake) of the generator step

  /// The columns of the log.
  std::vector<NamedLoss> named() const {
    return {{"wasserstein", wasserstein}, {"penalty", penalty}, {"generator_loss", generator}};
  }
};

/// The sizes of a model's critic, which is given `seen` values of a frame.
inline CnnCriticOptions critic_sizes(const Dvgan& model, std::size_t seen) {
  return {.vocabulary = model.format().vocabulary.size(),
          .dof = seen,
          .frames = model.format().frames,
          .hidden = model.options().hidden,
          .taps = model.options().taps};
}

/// Trains a Dvgan on a data set. Critic and generator steps can also be called one by one.
class DvganTrainer : public ModelTrainer<Dvgan, DvganTrainOptions, DvganLosses> {
 public:
  /// Throws Error if the data set's format or an option does not fit the model.
  DvganTrainer(Dvgan& model, const motion::Dataset& data, const DvganTrainOptions& options)
      : ModelTrainer(model, options),
        windows_(model.context(), data),
        sees_(model.context(), model.format(), options.critic.sees),
        critic_(Initializer(model.context(), model.options().seed + 1), critic_sizes(model, sees_.size()),
                options.critic),
        generator_adam_(named_parameters(model), options.adam),
        critic_adam_(named_parameters(critic_), options.adam) {
    if (options.ema > 0) mean_.emplace(generator_adam_, options.ema);
    detail::require_same_format(data.format, model.format());
    if (options.completion_share > 0) model.rnn();  // throws for a CNN
    if (options.body.any())
      body_losses_.emplace(model.format(), options.body, windows_.draw(options.seed, 0, 256).motion);
  }

  DvganCritic& critic() { return critic_; }
  Adam& generator_adam() { return generator_adam_; }
  Adam& critic_adam() { return critic_adam_; }
  std::vector<TrainedPart> parts() override {
    return {{"generator", named_parameters(model_), &generator_adam_, mean_ ? &*mean_ : nullptr},
            {"critic", named_parameters(critic_), &critic_adam_}};
  }

  /// One iteration: critic_steps critic steps and one generator step.
  void iterate() override {
    follow_schedule(options_.adam.schedule);
    const KeepPacked weights_packed;
    const std::size_t first = iteration_ * options_.steps();
    for (std::size_t i = 0; i < options_.critic_steps; ++i)
      critic_step(static_cast<std::uint32_t>(first + i));
    generator_step(static_cast<std::uint32_t>(first + options_.critic_steps));
    ++iteration_;
  }

  /// One update of the critic; `step` selects its random numbers.
  void critic_step(std::uint32_t step) {
    const std::vector<Var> told =
        parallel_step(critic_adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
          const RandomKey key = key_of(step, part);
          const CaptionedBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
          Var fake;
          {
            const NoGrad values_only;
            fake = make_fake(batch, key);
          }
          const Indices shift = draw_shift(key, part.count);
          const Tensor real = shifted(sees_(Var::constant(batch.motion)), shift).value();
          const Var h_txt = critic_.encode_text(batch.text), pairs_txt = concatenate({h_txt, h_txt}, 0);
          const CriticLoss loss = critic_loss(
              [&](const Var& x) { return critic_(x, pairs_txt); },
              [&](const Var& x) { return critic_(x, h_txt); }, real, shifted(sees_(fake), shift).value(),
              random_uniform(model_.context(), key.with(RandomStream::interpolation), part.count),
              options_.lambda_gp);
          return {loss.loss, {loss.wasserstein, loss.penalty}};
        });
    wasserstein_ = told[0], penalty_ = told[1];
  }

  /// One update of the generator; no gradient flows to the critic's parameters.
  void generator_step(std::uint32_t step) {
    const Frozen critic_fixed(named_parameters(critic_));
    generator_loss_ =
        parallel_step(generator_adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
          const RandomKey key = key_of(step, part);
          const CaptionedBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
          const Var made = make_fake(batch, key), fake = shifted(sees_(made), draw_shift(key, part.count));
          Var h_txt;
          {
            const NoGrad values_only;  // the critic's text encoding does not depend on the generator
            h_txt = critic_.encode_text(batch.text);
          }
          Var loss = generator_loss(critic_(fake, h_txt));
          if (body_losses_) loss = loss + (*body_losses_)(made, Var::constant(batch.motion));
          return {loss, {loss}};
        }).front();
    if (mean_) mean_->update();
  }

  DvganLosses losses() const override {
    require(!generator_loss_.empty(), "no iteration has run yet");
    return {wasserstein_.item(), penalty_.item(), generator_loss_.item()};
  }

 private:
  RandomKey key_of(std::uint32_t step, const BatchPart& part) const {
    return {.seed = options_.seed, .step = step, .first_sample = static_cast<std::uint32_t>(part.first)};
  }

  /// A fake [N, B, M] with the captions of the batch.
  Var make_fake(const CaptionedBatch& batch, const RandomKey& key) const {
    RandomKey draw = key.with(RandomStream::seeding);
    draw.first_sample = 0;  // one number for all parts of a batch
    const double chance = (static_cast<double>(random_word(draw, 0)) + 0.5) * 0x1p-32;
    if (!(chance < options_.completion_share)) return model_.forward(batch.text, key);
    const std::size_t given =
        1 + random_below(draw, 0, std::max<std::size_t>(1, model_.format().frames / 2), 1);
    return model_.complete(batch.text, slice(Var::constant(batch.motion), 0, 0, given), key);
  }

  /// A uniform shift in frames, [-N/2, N/2], for each of `count` samples; empty if shifting is off.
  Indices draw_shift(const RandomKey& key, std::size_t count) const {
    if (!options_.input_shift) return {};
    const std::size_t frames = model_.format().frames, half = frames / 2;
    return random_integers(model_.context(), key.with(RandomStream::shift), count, -static_cast<int>(half),
                           2 * half + 1);
  }
  Var shifted(const Var& motion, const Indices& shift) const {
    return shift.empty() ? motion : shift_frames(motion, shift, motion.dim(0), {.sign = -1});
  }

  WindowSampler windows_;
  CriticView sees_;
  std::optional<BodyLosses> body_losses_;
  DvganCritic critic_;
  Adam generator_adam_, critic_adam_;
  std::optional<WeightMean> mean_;  // of the generator
  Var wasserstein_, penalty_, generator_loss_;
};

/// Trains a Dvgan: a whole run, see run_training(). The model then has the running mean of its weights, as
/// the file of the run's generator has.
inline RunResult train(Dvgan& model, const motion::Dataset& data, const DvganTrainOptions& options,
                       const RunOptions& run = {}) {
  DvganTrainer trainer(model, data, options);
  const RunResult result = run_training(
      trainer, [&](const std::filesystem::path& path) { data.write_split(path); }, run);
  use_means(trainer);
  return result;
}

}  // namespace motiongan
