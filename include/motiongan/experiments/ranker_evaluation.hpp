// Evaluation of a ranker on held-out clips (Lin & Amer, Table 1).
#pragma once
#include "motiongan/data/dataset.hpp"
#include "motiongan/data/descriptions.hpp"
#include "motiongan/metrics/inception_score.hpp"
#include "motiongan/metrics/retrieval.hpp"
#include "motiongan/models/ranker.hpp"

namespace motiongan {

/// Options of evaluate_ranker().
struct RankerEvaluationOptions {
  std::size_t descriptions = 250;    ///< K: the most frequent descriptions of the test clips, at most all
  std::size_t windows_per_clip = 8;  ///< evenly spaced; the same number for each clip
};

/// Real windows of the test clips that have one of the K descriptions.
struct RealWindows {
  motion::Descriptions descriptions;            ///< of the test clips, K of them
  std::vector<motion::Motion> motions;          ///< windows_per_clip of each clip
  std::vector<std::vector<std::size_t>> right;  ///< the correct descriptions of each window
  std::size_t clips = 0;                        ///< number of clips that they come from
};

/// The windows to evaluate a ranker on. Throws Error if there are no test clips or an option is 0.
inline RealWindows real_windows(const motion::Dataset& data, const RankerEvaluationOptions& options = {}) {
  require(!data.test.empty(), "there are no test clips to evaluate on; lower the training share");
  require(options.descriptions > 0 && options.windows_per_clip > 0, "descriptions is ", options.descriptions,
          " and windows_per_clip is ", options.windows_per_clip, ", expected at least 1 of each");
  RealWindows out;
  out.descriptions = motion::distinct_descriptions(data.test).most_popular(options.descriptions);
  std::vector<float> window(data.format.frames * data.format.dof());
  for (std::size_t c = 0; c < data.test.size(); ++c) {
    if (out.descriptions.of_clip[c].empty()) continue;
    ++out.clips;
    const std::size_t starts = data.starts(data.test[c]), count = options.windows_per_clip;
    for (std::size_t i = 0; i < count; ++i) {
      data.window(data.test[c], count == 1 ? starts / 2 : i * (starts - 1) / (count - 1), window);
      out.motions.push_back(data.to_motion(window));
      out.right.push_back(out.descriptions.of_clip[c]);
    }
  }
  return out;
}

/// The measures of a ranker on n real windows.
struct RankerEvaluation {
  RealWindows real;
  std::vector<float> features;  ///< unit-length embeddings of the windows, [n, k]
  std::vector<float> scores;    ///< [n, K]
  Retrieval retrieval;          ///< R@k among the K descriptions
  double inception_score = 0;   ///< of the real windows, nats
};

/// Measures how well the ranker retrieves the descriptions of the test clips. Throws Error as real_windows(),
/// or if the windows do not fit the ranker.
inline RankerEvaluation evaluate_ranker(const Ranker& ranker, const motion::Dataset& data,
                                        const RankerEvaluationOptions& options = {}) {
  RankerEvaluation out;
  out.real = real_windows(data, options);
  out.features = ranker.features(out.real.motions);
  out.scores = ranker.scores(out.features, out.real.descriptions.texts);
  out.retrieval = retrieval(out.scores, out.real.descriptions.size(), out.real.right);
  out.inception_score = inception_score(out.scores, out.real.descriptions.size());
  return out;
}

}  // namespace motiongan
