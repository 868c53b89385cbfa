// Whether synthetic clips help: a classifier trained on real clips only, and on real and synthetic ones (SPEC
// 5).
#pragma once
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "motiongan/metrics/mean_std.hpp"
#include "motiongan/networks/attention_classifier.hpp"
#include "motiongan/optim/adam.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "motiongan/train/action_windows.hpp"

namespace motiongan {

struct AugmentationStudyOptions {
  std::size_t seeds = 3;         ///< each trains two classifiers, alike but for the clips
  std::uint64_t first_seed = 1;  ///< of weights and batches
  std::size_t iterations = 500;  ///< steps of each classifier
  double max_minutes = 0;        ///< stop each classifier after that long; 0: no limit
  std::size_t batch = 64;
  std::size_t hidden = 256;
  bool attention = true;
  bool balanced = true;  ///< draw classes alike
  AdamOptions adam{};
  std::function<bool()> should_stop = {};  ///< asked after every step
  std::function<void(std::size_t step, double loss)> report =
      {};  ///< every 20 steps, counted over all classifiers
};

/// Share that a classifier gets right.
struct StudyAccuracy {
  double windows = 0;  ///< of seconds of motion
  double clips = 0;    ///< of clips, by the sum of the log-probabilities of their windows
};

struct AugmentationStudyRow {
  std::uint64_t seed = 0;
  StudyAccuracy real, augmented;
};

/// Synthetic clips as clips of the data set: its normalizer, its numbers of classes.
inline std::vector<motion::ActionClip> as_clips_of(const motion::ActionDataset& data,
                                                   const ActionGan& model,
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

/// A classifier trained on the second halves of windows drawn from `clips`; with a should_stop that said so,
/// less than that. `before` steps are counted as done already in what report() is told.
inline AttentionClassifier train_classifier(const Context& context, const motion::ActionDataset& data,
                                            const std::vector<motion::ActionClip>& clips, std::uint64_t seed,
                                            const AugmentationStudyOptions& options, std::size_t before = 0) {
  AttentionClassifier classifier(Initializer(context, seed), {.dof = data.format.dof(),
                                                              .classes = data.format.classes.size(),
                                                              .hidden = options.hidden,
                                                              .attention = options.attention});
  const ActionSampler windows(context, data, clips, options.balanced);
  Adam adam(named_parameters(classifier), options.adam);
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t step = 0; step < options.iterations; ++step) {
    const ActionBatch batch = windows.draw(seed, static_cast<std::uint32_t>(step), options.batch);
    const Var loss = cross_entropy(classifier(Var::constant(batch.future)), Var::constant(batch.classes));
    adam.step(grad(loss, adam.parameters()));
    if (options.report && (step + 1) % 20 == 0) options.report(before + step + 1, loss.item());
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    if (options.max_minutes > 0 && passed.count() > 60 * options.max_minutes) break;
    if (options.should_stop && options.should_stop()) break;
  }
  return classifier;
}

/// On windows of T frames of `clips`, half a window apart.
inline StudyAccuracy accuracy_on(const Context& context, const AttentionClassifier& classifier,
                                 const motion::ActionDataset& data,
                                 const std::vector<motion::ActionClip>& clips) {
  require(!clips.empty(), "there are no clips held out to measure accuracy on");
  const NoGrad values_only;
  const std::size_t frames = data.format.frames, dof = data.format.dof(),
                    classes = data.format.classes.size();
  const std::size_t hop = std::max<std::size_t>(1, frames / 2);
  std::size_t windows = 0, right_windows = 0, right_clips = 0;
  for (const motion::ActionClip& clip : clips) {
    const std::size_t count = (clip.frames - frames) / hop + 1;  // a clip of a data set holds two windows
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

/// For each seed a classifier trained on data.train and one, of the same first weights, on data.train and
/// `synthetic`; both measured on data.test. Rows of seeds that were not finished when should_stop() said so
/// are left out.
inline std::vector<AugmentationStudyRow> study_augmentation(const Context& context,
                                                            const motion::ActionDataset& data,
                                                            const std::vector<motion::ActionClip>& synthetic,
                                                            const AugmentationStudyOptions& options) {
  require(options.seeds > 0 && options.iterations > 0 && options.batch > 0,
          "seeds, iterations and batch of the study must be positive");
  require(!data.test.empty(), "the data set keeps no clips for testing; the study needs some");
  require(!synthetic.empty(), "the study needs synthetic clips");
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
