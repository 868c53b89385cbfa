// Data augmentation study: a classifier trained on real clips, compared with one trained on real and
// synthetic clips (the application of Malek-Podjaski & Deligianni).
#pragma once
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/clock.hpp"
#include "motiongan/metrics/mean_std.hpp"
#include "motiongan/networks/attention_classifier.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "motiongan/train/action_windows.hpp"

namespace motiongan {

/// Options of study_augmentation().
struct AugmentationStudyOptions {
  std::size_t seeds = 3;         ///< each trains two classifiers that differ only in their training clips
  std::uint64_t first_seed = 1;  ///< seed of weights and batches; counts up
  std::size_t iterations = 500;  ///< steps of each classifier
  double max_minutes = 0;        ///< stop each classifier after this time; 0: no limit
  std::size_t batch = 64;        ///< windows in a step of a classifier
  std::size_t hidden = 256;      ///< width of the classifiers
  bool attention = true;         ///< self-attention in the classifiers
  bool balanced = true;          ///< draw classes with equal probability
  AdamOptions adam{};            ///< of the classifiers
  std::function<bool()> should_stop = {};  ///< called after every step; true stops the study
  std::function<void(std::size_t step, double loss)> report =
      {};  ///< called every 20 steps; steps are counted over all classifiers
};

/// Classification accuracy, 0..1.
struct StudyAccuracy {
  double windows = 0;  ///< over windows of T frames
  double clips = 0;    ///< over clips, by the sum of the log-probabilities of their windows
};

/// The result for one seed.
struct AugmentationStudyRow {
  std::uint64_t seed = 0;
  StudyAccuracy real, augmented;  ///< of classifiers trained without and with the synthetic clips
};

/// Converts synthetic clips of `model` to the format of `data`: its frame rate, normalisation and class
/// labels. Throws Error if `data` lacks one of the classes.
inline std::vector<motion::ActionClip> as_clips_of(const motion::ActionDataset& data, const ActionGan& model,
                                                   std::span<const SyntheticClip> synthetic) {
  std::vector<motion::ActionClip> out;
  for (const SyntheticClip& s : synthetic) {
    const motion::PositionClip clip = std::abs(s.clip.rate / data.format.rate - 1) < 1e-6
                                          ? s.clip
                                          : motion::resample(s.clip, data.format.rate);
    out.push_back({.id = clip.id + "_synthetic",
                   .subject = {},
                   .label = data.format.class_index(model.format().classes.at(s.label)),
                   .frames = clip.frames,
                   .poses = data.format.encode(clip.positions),
                   .skeleton = clip.skeleton,
                   .places = data.format.layout.places(clip.positions)});
  }
  return out;
}

/// Trains a classifier on the second halves (futures) of windows drawn from `clips`, until
/// options.iterations, max_minutes or should_stop. `before` is added to the step that report() is given.
inline AttentionClassifier train_classifier(const Context& context, const motion::ActionDataset& data,
                                            const std::vector<motion::ActionClip>& clips, std::uint64_t seed,
                                            const AugmentationStudyOptions& options, std::size_t before = 0) {
  AttentionClassifier classifier(Initializer(context, seed), {.dof = data.format.dof(),
                                                              .classes = data.format.classes.size(),
                                                              .hidden = options.hidden,
                                                              .attention = options.attention});
  const ActionSampler windows(context, data, clips, options.balanced);
  Adam adam(named_parameters(classifier), options.adam);
  const double start = clock_seconds();
  for (std::size_t step = 0; step < options.iterations; ++step) {
    const ActionBatch batch = windows.draw(seed, static_cast<std::uint32_t>(step), options.batch);
    const Var loss = cross_entropy(classifier(Var::constant(batch.future)), Var::constant(batch.classes));
    adam.step(grad(loss, adam.parameters()));
    if (options.report && (step + 1) % 20 == 0) options.report(before + step + 1, loss.item());
    if (options.max_minutes > 0 && clock_seconds() - start > 60 * options.max_minutes) break;
    if (options.should_stop && options.should_stop()) break;
  }
  return classifier;
}

/// The accuracy of a classifier on windows of T frames of `clips`, half a window apart. Throws Error if there
/// are no clips.
inline StudyAccuracy accuracy_on(const Context& context, const AttentionClassifier& classifier,
                                 const motion::ActionDataset& data,
                                 const std::vector<motion::ActionClip>& clips) {
  require(!clips.empty(), "there are no held-out clips to measure accuracy on");
  const NoGrad values_only;
  const std::size_t frames = data.format.frames, dof = data.format.dof(),
                    classes = data.format.classes.size();
  const std::size_t hop = std::max<std::size_t>(1, frames / 2);
  std::size_t windows = 0, right_windows = 0, right_clips = 0;
  for (const motion::ActionClip& clip : clips) {
    const std::size_t count = (clip.frames - frames) / hop + 1;  // clips have at least 2T frames
    std::vector<float> poses(frames * count * dof);
    for (std::size_t f = 0; f < frames; ++f)
      for (std::size_t w = 0; w < count; ++w)
        std::copy_n(&clip.poses[(w * hop + f) * dof], dof, &poses[(f * count + w) * dof]);
    const std::vector<double> scores =
        log_softmax(classifier(Var::constant(Tensor::from(context, {frames, count, dof}, poses))))
            .value()
            .to_host<double>();  // [count, classes]
    const auto best = [&](auto begin) {
      return static_cast<std::size_t>(std::max_element(begin, begin + static_cast<std::ptrdiff_t>(classes)) -
                                      begin);
    };
    std::vector<double> sum(classes, 0.0);
    for (std::size_t w = 0; w < count; ++w) {
      right_windows += best(scores.begin() + static_cast<std::ptrdiff_t>(w * classes)) == clip.label;
      for (std::size_t c = 0; c < classes; ++c) sum[c] += scores[w * classes + c];
    }
    windows += count;
    right_clips += best(sum.begin()) == clip.label;
  }
  return {static_cast<double>(right_windows) / static_cast<double>(windows),
          static_cast<double>(right_clips) / static_cast<double>(clips.size())};
}

/// For each seed trains two classifiers with the same initial weights, one on data.train and one on
/// data.train and `synthetic`, and measures both on data.test. A seed that should_stop() interrupts is left
/// out. Throws Error if an option is 0, or if there are no test or synthetic clips.
inline std::vector<AugmentationStudyRow> study_augmentation(const Context& context,
                                                            const motion::ActionDataset& data,
                                                            const std::vector<motion::ActionClip>& synthetic,
                                                            const AugmentationStudyOptions& options) {
  require(options.seeds > 0 && options.iterations > 0 && options.batch > 0,
          "seeds, iterations and batch of the study must be positive");
  require(!data.test.empty(), "the data set has no clips for testing, expected at least one");
  require(!synthetic.empty(), "there are no synthetic clips, expected at least one");
  std::vector<motion::ActionClip> both = data.train;
  both.insert(both.end(), synthetic.begin(), synthetic.end());
  std::vector<AugmentationStudyRow> rows;
  for (std::size_t s = 0; s < options.seeds; ++s) {
    const std::uint64_t seed = options.first_seed + s;
    const auto measure = [&](const std::vector<motion::ActionClip>& clips, std::size_t before) {
      return accuracy_on(context, train_classifier(context, data, clips, seed, options, before), data,
                         data.test);
    };
    const StudyAccuracy real = measure(data.train, 2 * s * options.iterations);
    const StudyAccuracy augmented = measure(both, (2 * s + 1) * options.iterations);
    if (options.should_stop && options.should_stop()) break;
    rows.push_back({seed, real, augmented});
  }
  return rows;
}

}  // namespace motiongan
