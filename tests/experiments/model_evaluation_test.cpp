// Evaluation of a generator against real motion: which motions are measured, and reproducibility.
#include "motiongan/experiments/model_evaluation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "motiongan/procedural/procedural.hpp"

namespace model_evaluation_test {

using namespace motiongan;

namespace {

/// Windows of 8 frames at 4 Hz; some of the clips share a description.
const motion::Dataset& small_data() {
  static const motion::Dataset data = motion::Dataset::from_motions(
      motion::procedural_motions({.clips = 48, .seconds = 6, .rate = 8, .seed = 3}),
      {.frames = 8, .rate = 4});
  return data;
}

ModelEvaluationOptions few() {
  ModelEvaluationOptions options;
  options.samples = 5;
  options.drift_seconds = 6;
  options.drift_motions = 2;
  return options;
}

}  // namespace

TEST_CASE("real windows: the given number for each description") {
  const motion::Dataset& data = small_data();
  const Context context;
  const Ranker ranker(context, data.format, {.kind = RankerKind::rnn, .hidden = 16});
  const RealEvaluation real = evaluate_real(ranker, data, few());
  const std::size_t k = motion::distinct_descriptions(data.test).size();
  CHECK(real.descriptions.size() == k);
  CHECK(real.clips == data.test.size());
  CHECK(real.measures.motions == 5 * k);
  CHECK(real.features.size() == 5 * k * 16);
  REQUIRE(real.measures.retrieval.parts.size() == k);
  for (const Retrieval::Part& part : real.measures.retrieval.parts) CHECK(part.samples >= 5);
  CHECK(real.measures.inception_score >= 0);
  CHECK(real.measures.inception_score <= std::log(static_cast<double>(k)));
  CHECK(real.measures.diversity > real.measures.multimodality);
  REQUIRE(real.measures.quality.feet);
  CHECK(real.measures.quality.length_unit == "legs");
  CHECK(real.measures.quality.bone_error < 1e-3);
  CHECK(real.measures.quality.frames == 5 * k * data.format.frames);

  // Count the descriptions that training clips have too.
  std::set<std::vector<std::string>> trained;
  for (const motion::DatasetClip& clip : data.train)
    for (const std::string& caption : clip.captions) trained.insert(motion::split_words(caption));
  std::size_t common = 0;
  for (const std::string& text : real.descriptions.texts) common += trained.count(motion::split_words(text));
  CHECK(real.training_descriptions == common);
  CHECK(real.training.has_value() == (common > 0));

  // The windows of the first description come from its clips in turn, starting with the first window of one.
  std::vector<float> window(data.format.frames * data.format.dof());
  for (std::size_t c = 0; c < data.test.size(); ++c) {
    const auto& of = real.descriptions.of_clip[c];
    if (std::find(of.begin(), of.end(), 0) == of.end()) continue;
    data.window(data.test[c], 0, window);
    const std::vector<float> expected = ranker.features({data.to_motion(window)});
    for (std::size_t i = 0; i < 16; ++i)
      CHECK(real.features[i] == doctest::Approx(expected[i]).epsilon(1e-4));
    break;
  }
}

TEST_CASE("generated motions: the given number for each description, reproducible") {
  const motion::Dataset& data = small_data();
  const Context context;
  const Ranker ranker(context, data.format, {.kind = RankerKind::rnn, .hidden = 16});
  const ModelEvaluationOptions options = few();
  const RealEvaluation real = evaluate_real(ranker, data, options);
  const Dvgan cnn(context, data.format, {.hidden = 8});
  const ModelEvaluation once = evaluate_model(cnn, ranker, real, options);
  CHECK(once.measures.motions == real.measures.motions);
  CHECK_FALSE(once.drift);
  CHECK(once.distance.dimensions == 16);
  CHECK(once.distance.samples1 == real.measures.motions);
  REQUIRE(real.training);
  CHECK(once.distance.distance > real.training->distance);  // untrained weights

  // The same motions, measured directly.
  std::vector<motion::Motion> motions;
  std::vector<std::vector<std::size_t>> right;
  for (std::size_t d = 0; d < real.descriptions.size(); ++d)
    for (motion::Motion& m : cnn.generate(real.descriptions.texts[d], {.count = 5, .first_sample = 5 * d})) {
      motions.push_back(std::move(m));
      right.push_back({d});
    }
  const std::vector<float> features = ranker.features(motions);
  const std::size_t k = real.descriptions.size();
  CHECK(once.measures.retrieval.recall ==
        retrieval(ranker.scores(features, real.descriptions.texts), k, right).recall);
  CHECK(once.distance.distance == doctest::Approx(frechet_distance(features, real.features, 16).distance));
  CHECK(once.measures.quality.jerk == doctest::Approx(measure_quality(motions).jerk));

  // The single call gives the same.
  const ModelEvaluation again = evaluate_model(cnn, ranker, data, options);
  CHECK(again.distance.distance == doctest::Approx(once.distance.distance));
  CHECK(again.measures.inception_score == doctest::Approx(once.measures.inception_score));
  ModelEvaluationOptions other = options;
  other.seed = 2;
  CHECK(evaluate_model(cnn, ranker, real, other).measures.diversity != once.measures.diversity);
}

TEST_CASE("drift of an RNN generator; metres if the unit is known") {
  const motion::Dataset& data = small_data();
  const Context context;
  const Ranker ranker(context, data.format, {.kind = RankerKind::cnn, .hidden = 16});
  ModelEvaluationOptions options = few();
  options.descriptions = 2;
  options.feet.unit_metres = 0.01;
  const Dvgan rnn(context, data.format, {.generator = GeneratorKind::rnn, .hidden = 8});
  const ModelEvaluation e = evaluate_model(rnn, ranker, data, options);
  CHECK(e.measures.motions == 10);
  CHECK(e.measures.quality.length_unit == "m");
  REQUIRE(e.drift);
  CHECK(e.drift->seconds == doctest::Approx(6));
  CHECK(e.drift->whole.frames == 24);
  CHECK(std::isfinite(e.drift->last.mean));
}

TEST_CASE("invalid options and missing test clips are refused") {
  const motion::Dataset& data = small_data();
  const Context context;
  const Ranker ranker(context, data.format, {.kind = RankerKind::rnn, .hidden = 16});
  ModelEvaluationOptions one = few();
  one.samples = 1;
  CHECK_THROWS_WITH_AS(evaluate_real(ranker, data, one), doctest::Contains("expected at least 1 and 2"),
                       Error);
  const RealEvaluation real = evaluate_real(ranker, data, few());
  const Dvgan cnn(context, data.format, {.hidden = 8});
  ModelEvaluationOptions more = few();
  more.samples = 6;
  CHECK_THROWS_WITH_AS(evaluate_model(cnn, ranker, real, more),
                       doctest::Contains("with the same ranker and options"), Error);
  motion::Dataset no_test = data;
  no_test.test.clear();
  CHECK_THROWS_WITH_AS(evaluate_real(ranker, no_test, few()), doctest::Contains("no test clips"), Error);
}

}  // namespace model_evaluation_test
