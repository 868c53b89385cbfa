// Training a ranker (Lin & Amer, section 4.1; SPEC 7): of K descriptions, the right one for a motion.
#pragma once
#include <set>

#include "motiongan/models/ranker.hpp"
#include "motiongan/data/descriptions.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/train/checkpoint.hpp"
#include "motiongan/train/run.hpp"
#include "motiongan/train/windows.hpp"

namespace motiongan {

struct RankerTrainOptions {
  std::size_t iterations = 2000;
  std::size_t batch = 64;
  std::size_t descriptions = 250;  ///< K of a step: those of its clips, and others drawn
  AdamOptions adam{.learning_rate = 1e-4, .beta1 = 0.9, .beta2 = 0.999};
  std::uint64_t seed = 1;
};

/// What a checkpoint keeps of them: all but `iterations`, which a resumed run may have more of.
inline nlohmann::json to_json(const RankerTrainOptions& o) {
  return {{"batch", o.batch},      {"descriptions", o.descriptions}, {"learning_rate", o.adam.learning_rate},
          {"beta1", o.adam.beta1}, {"beta2", o.adam.beta2},          {"epsilon", o.adam.epsilon},
          {"seed", o.seed}};
}

/// What the last iteration came to; reading it waits for the device.
struct RankerLosses {
  double loss = 0;     ///< mean -log p(right description), nats
  double recall1 = 0;  ///< share of the batch whose best description is right
};

/// As they stand in the log.
inline std::vector<LossColumn> columns(const RankerLosses& losses) {
  return {{"loss", losses.loss}, {"recall1", losses.recall1}};
}

/// Trains a Ranker on the training clips of a data set. A window of a clip with several descriptions has them
/// all for right answers, in equal parts.
class RankerTrainer {
 public:
  RankerTrainer(Ranker& model, const motion::Dataset& data, const RankerTrainOptions& options)
      : model_(model),
        options_(options),
        windows_(model.context(), data),
        descriptions_(motion::distinct_descriptions(data.train)),
        adam_(named_parameters(model), options.adam) {
    require(options.batch > 0, "batch must be positive");
    require(descriptions_.size() >= 2, "all ", data.train.size(),
            " training clips have the same description; a ranker needs at least two to choose from");
    require(options.descriptions >= 2, options.descriptions,
            " descriptions to choose from were asked for, expected at least 2");
    require(data.format.dof() == model.format().dof() && data.format.frames == model.format().frames &&
                data.format.vocabulary.size() == model.format().vocabulary.size(),
            "the data set (", data.format.dof(), " dof, ", data.format.frames, " frames, ",
            data.format.vocabulary.size(), " words) does not fit the ranker (", model.format().dof(), ", ",
            model.format().frames, ", ", model.format().vocabulary.size(), ")");
    require(options.iterations < (std::size_t{1} << 24), options.iterations,
            " iterations are more than the random numbers' counter holds (2^24 steps)");
    for (const std::string& text : descriptions_.texts)
      sentences_.push_back(data.format.vocabulary.encode(text));
  }

  Ranker& model() { return model_; }
  const RankerTrainOptions& options() const { return options_; }
  const motion::Descriptions& descriptions() const { return descriptions_; }
  std::size_t iteration() const { return iteration_; }
  void set_iteration(std::size_t iteration) { iteration_ = iteration; }
  std::vector<TrainedPart> parts() { return {{"ranker", named_parameters(model_), &adam_}}; }

  /// The descriptions that step `step` chooses among: all that the clips have, and others by chance until
  /// there are K; in increasing order.
  std::vector<std::size_t> candidates(std::span<const std::size_t> clips, std::uint32_t step) const {
    std::set<std::size_t> chosen;
    for (const std::size_t c : clips)
      chosen.insert(descriptions_.of_clip[c].begin(), descriptions_.of_clip[c].end());
    std::vector<std::size_t> others;
    for (std::size_t d = 0; d < descriptions_.size(); ++d)
      if (!chosen.contains(d)) others.push_back(d);
    const RandomKey key{.seed = options_.seed, .stream = RandomStream::interpolation, .step = step};
    for (std::uint32_t i = 0; i < others.size() && chosen.size() < options_.descriptions; ++i) {
      std::swap(others[i], others[i + random_below(key, i, others.size() - i)]);
      chosen.insert(others[i]);
    }
    return {chosen.begin(), chosen.end()};
  }

  /// One update.
  void iterate() {
    const auto step = static_cast<std::uint32_t>(iteration_);
    const CaptionedBatch batch = windows_.draw(options_.seed, step, options_.batch);
    const std::vector<std::size_t> asked = candidates(batch.clips, step);
    std::vector<std::vector<int>> sentences;
    for (const std::size_t d : asked) sentences.push_back(sentences_[d]);
    right_.assign(options_.batch * asked.size(), 0);
    for (std::size_t b = 0; b < options_.batch; ++b) {
      const std::vector<std::size_t>& of = descriptions_.of_clip[batch.clips[b]];
      for (std::size_t i = 0; i < asked.size(); ++i)
        if (std::binary_search(of.begin(), of.end(), asked[i]))
          right_[b * asked.size() + i] = 1 / static_cast<float>(of.size());
    }
    const Context& context = model_.context();
    const Var text = model_.describe(Sentences(context, sentences, model_.format().vocabulary.size()));
    const Var scores = model_.scores(Var::constant(batch.motion), text);
    const Var loss =
        cross_entropy(scores, Var::constant(Tensor::from(context, {options_.batch, asked.size()}, right_)));
    adam_.step(grad(loss, adam_.parameters()));
    loss_ = loss.detach();
    scores_ = scores.detach();
    ++iteration_;
  }

  RankerLosses losses() const {
    require(!loss_.empty(), "no iteration has run yet");
    const std::vector<float> scores = scores_.value().to_host();
    const std::size_t count = scores_.dim(1);
    double found = 0;
    for (std::size_t b = 0; b < options_.batch; ++b) {
      const auto row = scores.begin() + static_cast<std::ptrdiff_t>(b * count);
      const auto best = std::max_element(row, row + static_cast<std::ptrdiff_t>(count)) - scores.begin();
      found += right_[static_cast<std::size_t>(best)] > 0 ? 1 : 0;
    }
    return {loss_.item(), found / static_cast<double>(options_.batch)};
  }

 private:
  Ranker& model_;
  RankerTrainOptions options_;
  WindowSampler windows_;
  motion::Descriptions descriptions_;
  std::vector<std::vector<int>> sentences_;
  Adam adam_;
  Var loss_, scores_;
  std::vector<float> right_;  // of the last step, [B, K]
  std::size_t iteration_ = 0;
};

using RankerRunOptions = BasicRunOptions<RankerLosses>;

/// Trains until options.iterations are done, time is up or should_stop() says so; then saves, the ranker as
/// `ranker.safetensors`. Columns of the log: iteration, seconds (of this run), iterations_per_second, loss,
/// recall1.
inline RunResult train(Ranker& model, const motion::Dataset& data, const RankerTrainOptions& options,
                       const RankerRunOptions& run = {}) {
  RankerTrainer trainer(model, data, options);
  return detail::run_training(trainer, data, options.iterations, run);
}

}  // namespace motiongan
