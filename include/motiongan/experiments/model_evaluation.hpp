// A text-conditioned generator beside the real motion that it was to learn (Lin & Amer, Table 2; SPEC 7), and
// by the measures of today.
#pragma once
#include "motiongan/metrics/diversity.hpp"
#include "motiongan/metrics/drift.hpp"
#include "motiongan/metrics/frechet_distance.hpp"
#include "motiongan/metrics/inception_score.hpp"
#include "motiongan/metrics/motion_quality.hpp"
#include "motiongan/metrics/retrieval.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/ranker.hpp"
#include "motiongan/data/descriptions.hpp"

namespace motiongan {

struct ModelEvaluationOptions {
  std::size_t descriptions = 250;  ///< K: the most popular ones of the test clips, or all there are
  std::size_t samples = 16;        ///< motions of each description, made and real; at least 2
  std::uint64_t seed = 1;          ///< of the motions made, and of random pairs
  std::size_t diversity_pairs = 200, multimodality_pairs = 20;
  FootSkateOptions feet{};
  double drift_seconds = 30;  ///< how long the motions last that drift is measured on; RNN generators only
  std::size_t drift_motions = 8;  ///< how many, one for each of the most popular descriptions in turn
};

/// Measures of K * samples motions, `samples` of each description, through one ranker.
struct MotionSetMeasures {
  std::size_t motions = 0;
  double inception_score = 0;  ///< nats, over the K descriptions
  Retrieval retrieval;         ///< of a motion's own description among the K
  double diversity = 0;        ///< between the ranker's embeddings of length 1: 0 .. 2
  double multimodality = 0;    ///< the same among motions of one description
  MotionQuality quality;
};

/// The real motion that generators are measured against: the real-sample row, and what they all need.
struct RealEvaluation {
  motion::Descriptions descriptions;  ///< of the test clips, K of them
  std::size_t clips = 0;              ///< test clips that have one of them
  std::vector<float> features;        ///< [K * samples, k], the first description's first
  MotionSetMeasures measures;
  /// Of windows of the training clips from windows of the test clips, of the descriptions that both have: how
  /// far real motion is from real motion. Not set where there are none in common.
  std::optional<FrechetDistance> training;
  std::size_t training_descriptions = 0;  ///< so many
};

/// A generator's row.
struct ModelEvaluation {
  MotionSetMeasures measures;
  FrechetDistance distance;  ///< FID: from the real windows, in the ranker's embedding
  /// Mean over the long motions; not set for CNN generators, which make windows alone.
  std::optional<DriftSummary> drift;
};

namespace model_evaluation_detail {

/// `samples` windows of the clips, in turn and evenly spread over each.
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

/// `features` are those of `motions`, `samples` of each description.
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

/// The summaries' mean.
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

/// Real windows of the test clips: `samples` of each description, so that descriptions count alike, as they
/// do among the motions that a generator is asked for; a description's clips take turns, and windows of one
/// clip may overlap. The windows are those of `data` (its frames and rate), and go through its format as
/// generated motion does. Whatever clips a window's description has in common with others, all descriptions
/// of its own clip are right for it.
///
/// Do this once for all generators of one data set. Error if there are no test clips, fewer than 2 samples
/// were asked for, or the ranker needs longer motions.
inline RealEvaluation evaluate_real(const Ranker& ranker, const motion::Dataset& data,
                                    const ModelEvaluationOptions& options = {}) {
  namespace detail = model_evaluation_detail;
  require(!data.test.empty(), "there are no test clips to evaluate on; lower the training share");
  require(
      options.descriptions > 0 && options.samples >= 2, "an evaluation over ", options.descriptions,
      " descriptions with ", options.samples,
      " motions of each was asked for, expected at least 1 and 2: one motion says nothing of how much they "
      "differ");
  RealEvaluation out;
  out.descriptions = motion::distinct_descriptions(data.test).most_popular(options.descriptions);
  for (const auto& of : out.descriptions.of_clip) out.clips += of.empty() ? 0 : 1;
  const auto clips = detail::clips_of(data.test, out.descriptions);
  std::vector<motion::Motion> motions;
  std::vector<std::vector<std::size_t>> right;
  for (std::size_t d = 0; d < clips.size(); ++d) {
    detail::add_windows(data, clips[d], options.samples, motions);
    for (std::size_t c = 0; c < clips[d].size(); ++c) {
      // Its own description comes first: it counts among that one's.
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

  // The descriptions that training clips have too, and windows of those.
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

/// Asks the generator for `samples` motions of each description of `real` and measures them as the real
/// windows were; `options` must be those of evaluate_real. Motion of another rate than the ranker's is
/// resampled. Error where the ranker cannot take the generator's motion: another skeleton, or fewer frames
/// than its windows at its rate.
inline ModelEvaluation evaluate_model(const Dvgan& model, const Ranker& ranker, const RealEvaluation& real,
                                      const ModelEvaluationOptions& options = {}) {
  namespace detail = model_evaluation_detail;
  const std::size_t count = real.descriptions.size() * options.samples;
  require(count > 0 && real.features.size() == count * ranker.options().hidden, "the real motion has ",
          real.features.size(), " numbers of features, expected ", count, " motions of ",
          ranker.options().hidden, "; evaluate_real() it with the same ranker and options");
  std::vector<motion::Motion> motions;
  std::vector<std::vector<std::size_t>> right;
  for (std::size_t d = 0; d < real.descriptions.size(); ++d) {
    // Sample numbers go on from one description to the next, so that no two share their noise.
    const GenerateOptions wanted{
        .count = options.samples, .seed = options.seed, .first_sample = d * options.samples};
    for (motion::Motion& made : model.generate(real.descriptions.texts[d], wanted)) {
      motions.push_back(std::move(made));
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

/// Both at once, for a single generator.
inline ModelEvaluation evaluate_model(const Dvgan& model, const Ranker& ranker, const motion::Dataset& data,
                                      const ModelEvaluationOptions& options = {}) {
  return evaluate_model(model, ranker, evaluate_real(ranker, data, options), options);
}

}  // namespace motiongan
