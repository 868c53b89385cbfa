// Evaluation of a text-conditioned generator against real motion: inception score and retrieval (Lin & Amer,
// Table 2), FID, diversity, multimodality and motion quality.
#pragma once
#include <functional>

#include "motiongan/data/dataset.hpp"
#include "motiongan/data/descriptions.hpp"
#include "motiongan/metrics/diversity.hpp"
#include "motiongan/metrics/drift.hpp"
#include "motiongan/metrics/frechet_distance.hpp"
#include "motiongan/metrics/inception_score.hpp"
#include "motiongan/metrics/motion_quality.hpp"
#include "motiongan/metrics/retrieval.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/ranker.hpp"

namespace motiongan {

/// Options of evaluate_real() and evaluate_model().
struct ModelEvaluationOptions {
  std::size_t descriptions = 250;  ///< K: the most frequent descriptions of the test clips, at most all
  std::size_t samples = 16;        ///< motions of each description, generated and real; at least 2
  std::uint64_t seed = 1;          ///< seed of the generated motions and of random pairs
  std::size_t diversity_pairs = 200, multimodality_pairs = 20;  ///< pairs of motions that are compared
  FootSkateOptions feet{};                                      ///< how foot skating is measured
  double drift_seconds = 30;      ///< length of the motions that drift is measured on; RNN generators only
  std::size_t drift_motions = 8;  ///< their number; they cycle through the most frequent descriptions
  /// Makes the motions of a description in place of the model. Unset: Dvgan::generate.
  std::function<std::vector<motion::Motion>(const std::string& text, const GenerateOptions& wanted)> make =
      {};
  /// Applied to every generated motion before it is measured, such as motion::clean(); but not to those that
  /// drift is measured on. Unset: nothing.
  std::function<motion::Motion(motion::Motion)> finish = {};
};

/// Measures of K * samples motions, `samples` of each description, with one ranker.
struct MotionSetMeasures {
  std::size_t motions = 0;
  double inception_score = 0;  ///< nats, over the K descriptions
  Retrieval retrieval;         ///< of a motion's own description among the K
  double diversity = 0;        ///< mean distance between unit-length embeddings of the ranker, 0..2
  double multimodality = 0;    ///< the same between motions of the same description
  MotionQuality quality;
};

/// The real motion that generators are compared with, and its own measures.
struct RealEvaluation {
  motion::Descriptions descriptions;  ///< of the test clips, K of them
  std::size_t clips = 0;              ///< number of test clips with one of these descriptions
  std::vector<float> features;        ///< [K * samples, k], ordered by description
  MotionSetMeasures measures;
  /// FID between windows of training clips and of test clips, over the descriptions that both have: a
  /// reference for the FID between real and generated motion. Not set if they have none in common.
  std::optional<FrechetDistance> training;
  std::size_t training_descriptions = 0;  ///< number of descriptions in common
};

/// The measures of a generator.
struct ModelEvaluation {
  MotionSetMeasures measures;
  FrechetDistance distance;  ///< FID to the real windows, in the ranker's embedding
  /// Mean over the long motions; not set for CNN generators, which cannot make them.
  std::optional<DriftSummary> drift;
};

namespace model_evaluation_detail {

/// Appends `samples` windows, distributed over the clips and evenly spaced in each.
inline void add_windows(const motion::Dataset& data, const std::vector<const motion::DatasetClip*>& clips,
                        std::size_t samples, std::vector<motion::Motion>& out) {
  std::vector<float> window(data.format.frames * data.format.dof());
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const std::size_t count = samples / clips.size() + (c < samples % clips.size() ? 1 : 0);
    const std::size_t starts = data.starts(*clips[c]);
    for (std::size_t i = 0; i < count; ++i) {
      data.window(*clips[c], count == 1 ? starts / 2 : i * (starts - 1) / (count - 1), window);
      out.push_back(data.to_motion(window));
    }
  }
}

/// The clips of each description.
inline std::vector<std::vector<const motion::DatasetClip*>> clips_of(
    const std::vector<motion::DatasetClip>& clips, const motion::Descriptions& descriptions) {
  std::vector<std::vector<const motion::DatasetClip*>> out(descriptions.size());
  for (std::size_t c = 0; c < clips.size(); ++c)
    for (const std::size_t d : descriptions.of_clip[c]) out[d].push_back(&clips[c]);
  return out;
}

/// Measures `motions`, options.samples of each description, with their `features`. right[i]: the descriptions
/// that are correct for motion i.
inline MotionSetMeasures measure_set(const Ranker& ranker, const std::vector<std::string>& descriptions,
                                     std::span<const motion::Motion> motions, std::span<const float> features,
                                     const std::vector<std::vector<std::size_t>>& right,
                                     const ModelEvaluationOptions& options) {
  MotionSetMeasures out;
  const std::size_t width = ranker.options().hidden;
  const std::vector<float> scores = ranker.scores(features, descriptions);
  out.motions = motions.size();
  out.inception_score = inception_score(scores, descriptions.size());
  out.retrieval = retrieval(scores, descriptions.size(), right);
  out.diversity = diversity(features, width, options.diversity_pairs, options.seed);
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < motions.size(); ++i) of.push_back(i / options.samples);
  out.multimodality = multimodality(features, width, of, options.multimodality_pairs, options.seed);
  out.quality = measure_quality(motions, options.feet);
  return out;
}

/// The mean of the summaries.
inline DriftSummary mean_of(std::span<const DriftSummary> all) {
  DriftSummary out = all.front();
  const auto add = [&](DriftRow DriftSummary::*part) {
    DriftRow& row = out.*part;
    row.mean = row.spread = row.speed = row.outside = 0;
    for (const DriftSummary& one : all) {
      const double share = 1 / static_cast<double>(all.size());
      row.mean += share * (one.*part).mean;
      row.spread += share * (one.*part).spread;
      row.speed += share * (one.*part).speed;
      row.outside += share * (one.*part).outside;
    }
  };
  add(&DriftSummary::whole), add(&DriftSummary::first), add(&DriftSummary::last);
  return out;
}

}  // namespace model_evaluation_detail

/// Measures real windows of the test clips, options.samples of each description, so that descriptions have
/// equal weight, as in generated motion. The samples of a description are distributed over its clips; windows
/// of a clip may overlap. Windows have the frames and rate of `data` and are encoded and decoded with its
/// format, as generated motion is. For retrieval, all descriptions of a window's clip are correct.
///
/// The result can be reused for all generators of a data set. Throws Error if there are no test clips, if
/// `samples` is below 2 or `descriptions` is 0, or if the windows are too short for the ranker.
inline RealEvaluation evaluate_real(const Ranker& ranker, const motion::Dataset& data,
                                    const ModelEvaluationOptions& options = {}) {
  namespace detail = model_evaluation_detail;
  require(!data.test.empty(), "there are no test clips to evaluate on; lower the training share");
  require(options.descriptions > 0 && options.samples >= 2, "descriptions is ", options.descriptions,
          " and samples is ", options.samples,
          ", expected at least 1 and 2 (multimodality needs two motions of a description)");
  RealEvaluation out;
  out.descriptions = motion::distinct_descriptions(data.test).most_popular(options.descriptions);
  for (const auto& of : out.descriptions.of_clip) out.clips += of.empty() ? 0 : 1;
  const auto clips = detail::clips_of(data.test, out.descriptions);
  std::vector<motion::Motion> motions;
  std::vector<std::vector<std::size_t>> right;
  for (std::size_t d = 0; d < clips.size(); ++d) {
    detail::add_windows(data, clips[d], options.samples, motions);
    for (std::size_t c = 0; c < clips[d].size(); ++c) {
      // The first is the description that the window is counted under.
      std::vector<std::size_t> of{d};
      for (const std::size_t other :
           out.descriptions.of_clip[static_cast<std::size_t>(clips[d][c] - data.test.data())])
        if (other != d) of.push_back(other);
      const std::size_t n = clips[d].size();
      for (std::size_t i = 0; i < options.samples / n + (c < options.samples % n ? 1 : 0); ++i)
        right.push_back(of);
    }
  }
  out.features = ranker.features(motions);
  out.measures = detail::measure_set(ranker, out.descriptions.texts, motions, out.features, right, options);

  // Windows of training clips with the same descriptions.
  const motion::Descriptions trained = motion::distinct_descriptions(data.train);
  const auto training_clips = detail::clips_of(data.train, trained);
  std::map<std::vector<std::string>, std::size_t> by_words;
  for (std::size_t d = 0; d < trained.size(); ++d) by_words[motion::split_words(trained.texts[d])] = d;
  const std::size_t block = options.samples * ranker.options().hidden;
  std::vector<float> test;
  motions.clear();
  for (std::size_t d = 0; d < clips.size(); ++d) {
    const auto at = by_words.find(motion::split_words(out.descriptions.texts[d]));
    if (at == by_words.end()) continue;
    detail::add_windows(data, training_clips[at->second], options.samples, motions);
    const std::span<const float> rows = std::span(out.features).subspan(d * block, block);
    test.insert(test.end(), rows.begin(), rows.end());
    ++out.training_descriptions;
  }
  if (!motions.empty())
    out.training = frechet_distance(ranker.features(motions), test, ranker.options().hidden);
  return out;
}

/// Generates options.samples motions of each description of `real` and measures them like the real windows;
/// `options` must be those given to evaluate_real(). Motion is resampled to the ranker's frame rate. Throws
/// Error if the ranker or the options differ from those of `real`, or if the ranker cannot take the motion:
/// another skeleton, or fewer frames than its windows.
inline ModelEvaluation evaluate_model(const Dvgan& model, const Ranker& ranker, const RealEvaluation& real,
                                      const ModelEvaluationOptions& options = {}) {
  namespace detail = model_evaluation_detail;
  const std::size_t count = real.descriptions.size() * options.samples;
  require(count > 0 && real.features.size() == count * ranker.options().hidden, "the real motion has ",
          real.features.size(), " feature values, expected ", count, " motions x ", ranker.options().hidden,
          "; call evaluate_real() with the same ranker and options");
  std::vector<motion::Motion> motions;
  std::vector<std::vector<std::size_t>> right;
  for (std::size_t d = 0; d < real.descriptions.size(); ++d) {
    // Sample numbers continue from one description to the next, so that no two motions share their noise.
    const GenerateOptions wanted{
        .count = options.samples, .seed = options.seed, .first_sample = d * options.samples};
    const std::string& text = real.descriptions.texts[d];
    for (motion::Motion& made : options.make ? options.make(text, wanted) : model.generate(text, wanted)) {
      motions.push_back(options.finish ? options.finish(std::move(made)) : std::move(made));
      right.push_back({d});
    }
  }
  const std::vector<float> features = ranker.features(motions);
  ModelEvaluation out;
  out.measures = detail::measure_set(ranker, real.descriptions.texts, motions, features, right, options);
  out.distance = frechet_distance(features, real.features, ranker.options().hidden);
  if (model.is_recurrent() && options.drift_motions > 0 && options.drift_seconds > 0) {
    std::vector<DriftSummary> summaries;
    const auto frames = static_cast<std::size_t>(std::lround(options.drift_seconds * model.format().rate));
    for (std::size_t i = 0; i < options.drift_motions; ++i) {
      const std::string& text = real.descriptions.texts[i % real.descriptions.size()];
      const GenerateOptions wanted{.count = 1,
                                   .seed = options.seed,
                                   .first_sample = count + i,
                                   .frames = std::max(frames, model.format().frames)};
      DriftMeter meter(model.format());
      const std::vector<float> poses = model.generate_poses(text, wanted).front();
      meter.add(poses, wanted.frames);
      summaries.push_back(meter.summary());
    }
    out.drift = detail::mean_of(summaries);
  }
  return out;
}

/// evaluate_real() and evaluate_model() in one call, for a single generator.
inline ModelEvaluation evaluate_model(const Dvgan& model, const Ranker& ranker, const motion::Dataset& data,
                                      const ModelEvaluationOptions& options = {}) {
  return evaluate_model(model, ranker, evaluate_real(ranker, data, options), options);
}

}  // namespace motiongan
