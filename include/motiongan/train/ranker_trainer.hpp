// Training of a ranker (Lin & Amer, section 6.2): cross-entropy over K candidate descriptions of a motion.
#pragma once
#include <set>

#include "motiongan/data/descriptions.hpp"
#include "motiongan/models/ranker.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/train/run.hpp"
#include "motiongan/train/windows.hpp"

namespace motiongan {

/// Options of RankerTrainer.
struct RankerTrainOptions {
  std::size_t iterations = 2000;   ///< steps
  std::size_t batch = 64;          ///< windows in a step
  std::size_t descriptions = 250;  ///< K, candidates in a step: those of its clips, and random others
  AdamOptions adam{.learning_rate = 1e-4, .beta1 = 0.9, .beta2 = 0.999};
  std::uint64_t seed = 1;  ///< of the initial weights and batches

  /// Update steps in an iteration.
  std::size_t steps() const { return 1; }

  void list_fields(FieldList& list) {
    list.add(iterations,
             {.key = "iterations", .help = "how long to train", .range = Range::at_least(1), .saved = false});
    list.add(batch, {.key = "batch", .help = "motions in a step", .range = Range::at_least(1)});
    list.add(descriptions, {.key = "descriptions",
                            .help = "largest number of descriptions to choose among in a step",
                            .range = Range::at_least(2)});
    adam.list_fields(list);
    list.add(seed, {.key = "seed", .help = "of the initial weights and batches"});
  }
};

/// Losses of the last iteration.
struct RankerLosses {
  double loss = 0;     ///< mean -log p(right description), nats
  double recall1 = 0;  ///< fraction of the batch whose top-ranked description is right

  /// The columns of the log.
  std::vector<NamedLoss> named() const { return {{"loss", loss}, {"recall1", recall1}}; }
};

/// Trains a Ranker on the training clips of a data set. If a clip has several descriptions, the target
/// probability is uniform over them.
class RankerTrainer : public ModelTrainer<Ranker, RankerTrainOptions, RankerLosses> {
 public:
  /// Throws Error if the data set's format or an option does not fit, or if it has fewer than two distinct
  /// descriptions.
  RankerTrainer(Ranker& model, const motion::Dataset& data, const RankerTrainOptions& options)
      : ModelTrainer(model, options),
        windows_(model.context(), data),
        descriptions_(motion::distinct_descriptions(data.train)),
        adam_(named_parameters(model), options.adam) {
    require(descriptions_.size() >= 2, "all ", data.train.size(),
            " training clips have the same description; a ranker needs at least two to choose from");
    detail::require_same_format(data.format, model.format());
    for (const std::string& text : descriptions_.texts)
      sentences_.push_back(data.format.vocabulary.encode(text));
  }

  /// The distinct descriptions of the training clips.
  const motion::Descriptions& descriptions() const { return descriptions_; }
  std::vector<TrainedPart> parts() override { return {{"ranker", named_parameters(model_), &adam_}}; }

  /// The candidate descriptions of a step, in increasing order: all descriptions of its clips, and random
  /// others up to K in all.
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
  void iterate() override {
    follow_schedule(options_.adam.schedule);
    const KeepPacked weights_packed;
    const auto step = static_cast<std::uint32_t>(iteration_);
    const std::vector<std::size_t> asked =
        candidates(windows_.clips_of(options_.seed, step, options_.batch), step);
    std::vector<std::vector<int>> sentences;
    for (const std::size_t d : asked) sentences.push_back(sentences_[d]);
    const Context& context = model_.context();
    const std::vector<Var> told =
        parallel_step(adam_, parallel_, options_.batch, [&](const BatchPart& part) -> PartLoss {
          const CaptionedBatch batch = windows_.draw(options_.seed, step, part.count, part.first);
          right_.assign(part.count * asked.size(), 0);
          for (std::size_t b = 0; b < part.count; ++b) {
            const std::vector<std::size_t>& of = descriptions_.of_clip[batch.clips[b]];
            for (std::size_t i = 0; i < asked.size(); ++i)
              if (std::binary_search(of.begin(), of.end(), asked[i]))
                right_[b * asked.size() + i] = 1 / static_cast<float>(of.size());
          }
          const Var text = model_.describe(Sentences(context, sentences, model_.format().vocabulary.size()));
          const Var scores = model_.scores(Var::constant(batch.motion), text);
          const Var loss =
              cross_entropy(scores, Var::constant(Tensor::from(context, {part.count, asked.size()}, right_)));
          scores_ = scores.detach();
          if (part.count == options_.batch) return {loss, {loss}};
          return {loss, {loss, Var::constant(Tensor::from(context, {1}, std::vector{share_found()}))}};
        });
    loss_ = told[0];
    found_ = told.size() > 1 ? told[1] : Var();
    ++iteration_;
  }

  RankerLosses losses() const override {
    require(!loss_.empty(), "no iteration has run yet");
    return {loss_.item(), found_.empty() ? share_found() : found_.item()};
  }

 private:
  /// The share of the samples of scores_ whose best description is one of theirs.
  double share_found() const {
    const std::vector<float> scores = scores_.value().to_host();
    const std::size_t size = scores_.dim(0), count = scores_.dim(1);
    double found = 0;
    for (std::size_t b = 0; b < size; ++b) {
      const auto row = scores.begin() + static_cast<std::ptrdiff_t>(b * count);
      const auto best = std::max_element(row, row + static_cast<std::ptrdiff_t>(count)) - scores.begin();
      found += right_[static_cast<std::size_t>(best)] > 0 ? 1 : 0;
    }
    return found / static_cast<double>(size);
  }

  WindowSampler windows_;
  motion::Descriptions descriptions_;
  std::vector<std::vector<int>> sentences_;
  Adam adam_;
  Var loss_, scores_;
  Var found_;                 // the share of the last batch, if it was divided; else that of scores_
  std::vector<float> right_;  // targets of scores_, [B, K]
};

/// Trains a ranker: a whole run, see run_training(). The ranker is saved as ranker.safetensors.
inline RunResult train(Ranker& model, const motion::Dataset& data, const RankerTrainOptions& options,
                       const RunOptions& run = {}) {
  RankerTrainer trainer(model, data, options);
  return run_training(
      trainer, [&](const std::filesystem::path& path) { data.write_split(path); }, run);
}

}  // namespace motiongan
