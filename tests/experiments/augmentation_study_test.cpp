// The augmentation study: what it measures, and that the classifiers differ only in their clips.
#include <doctest/doctest.h>

#include <motiongan/experiments/augmentation_study.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/messages.hpp"

namespace augmentation_study_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::ActionDataset;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

/// Three clips each of a walk, a jump and a wave.
const ActionDataset& data() {
  static const ActionDataset d = [] {
    auto motions = motion::procedural_motions({.clips = 51, .seconds = 4, .rate = 10});
    return ActionDataset::from_motions(
        motions, {.frames = 8, .rate = 10, .pattern = "{label}_*", .classes = {"walk", "jump", "wave"}});
  }();
  return d;
}

const AugmentationStudyOptions small{
    .seeds = 2, .iterations = 40, .batch = 8, .hidden = 8, .adam = {.learning_rate = 3e-3}};

}  // namespace

TEST_CASE("mean and spread") {
  const std::vector<double> values{1, 2, 6}, one{4};
  CHECK(mean_spread(values).mean == doctest::Approx(3));
  CHECK(mean_spread(values).spread == doctest::Approx(std::sqrt(7.0)));
  CHECK(mean_spread(one).spread == 0);
  CHECK_THROWS_AS(mean_spread({}), Error);
}

TEST_CASE("a classifier learns its training clips; accuracy over windows and clips") {
  const ActionDataset& d = data();
  const AttentionClassifier fresh =
      train_classifier(context(), d, d.train, 1, {.iterations = 1, .batch = 8, .hidden = 8});
  AugmentationStudyOptions longer = small;
  longer.iterations = 120;
  std::vector<std::size_t> told;
  longer.report = [&](std::size_t step, double loss) {
    told.push_back(step);
    CHECK(std::isfinite(loss));
  };
  const AttentionClassifier learnt = train_classifier(context(), d, d.train, 1, longer, 1000);
  CHECK(told == std::vector<std::size_t>{1020, 1040, 1060, 1080, 1100, 1120});
  const StudyAccuracy before = accuracy_on(context(), fresh, d, d.train),
                      after = accuracy_on(context(), learnt, d, d.train);
  CHECK(after.windows > 0.8);
  CHECK(after.windows > before.windows);
  // The accuracy over windows is the weighted mean of the clips' accuracies.
  double share = 0;
  std::size_t windows = 0;
  for (const motion::ActionClip& clip : d.train) {
    const std::size_t n = (clip.frames - 8) / 4 + 1;
    share += accuracy_on(context(), learnt, d, {clip}).windows * static_cast<double>(n);
    windows += n;
  }
  CHECK(after.windows == doctest::Approx(share / static_cast<double>(windows)));
  CHECK_THROWS_WITH_AS(accuracy_on(context(), learnt, d, {}), doctest::Contains("no held-out clips"), Error);
}

TEST_CASE("the study compares the same classifier on two training sets") {
  const ActionDataset& d = data();
  const ActionGan model(context(), d.format, {.hidden = 8});
  const auto synthetic = as_clips_of(d, model, synthesise(model, d, d.train));
  REQUIRE(synthetic.size() == d.train.size());
  CHECK(synthetic.front().id == d.train.front().id + "_synthetic");
  CHECK(synthetic.front().label == d.train.front().label);
  CHECK(synthetic.front().poses.size() == d.train.front().poses.size());
  for (std::size_t i = 0; i < 8 * d.format.dof(); ++i)
    CHECK(synthetic.front().poses[i] == doctest::Approx(d.train.front().poses[i]).epsilon(1e-3).scale(1));

  const auto rows = study_augmentation(context(), d, synthetic, small);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].seed == 1);
  CHECK(rows[1].seed == 2);
  for (const AugmentationStudyRow& row : rows)
    for (const double share : {row.real.windows, row.real.clips, row.augmented.windows, row.augmented.clips})
      CHECK((share >= 0 && share <= 1));
  // The classifier of real clips does not depend on the synthetic ones.
  const StudyAccuracy alone =
      accuracy_on(context(), train_classifier(context(), d, d.train, 1, small), d, d.test);
  CHECK(rows[0].real.windows == alone.windows);
  CHECK(rows[0].real.clips == alone.clips);

  AugmentationStudyOptions stopped = small;
  stopped.should_stop = [] { return true; };
  CHECK(study_augmentation(context(), d, synthetic, stopped).empty());
  CHECK_THROWS_WITH_AS(study_augmentation(context(), d, {}, small), doctest::Contains("synthetic"), Error);
  ActionDataset all = d;
  all.test.clear();
  CHECK_THROWS_WITH_AS(study_augmentation(context(), all, synthetic, small),
                       doctest::Contains("no clips for testing"), Error);
}

}  // namespace augmentation_study_test
