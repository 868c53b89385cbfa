// Evaluation of action models: the choice of windows, and the measures of models with known errors.
#include "motiongan/experiments/action_evaluation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "../support/messages.hpp"

namespace action_evaluation_test {

using namespace motiongan;
using motion::Vec3;
using motiongan::testing::message_of;
using motiongan::testing::says;

namespace {

constexpr std::size_t prior_frames = 4;

/// A leg of two bones of length 1 that moves along x by `step` per frame and bends its knee by 2 degrees per
/// frame, starting at `bend`. It has no lateral bones, so its yaw is 0.
motion::PositionClip leg(const std::string& id, std::size_t frames, double bend, double step) {
  motion::PositionClip clip{id, {}, 10, frames, {}};
  clip.skeleton.joints = {
      {"Hip", -1, {0, 0, 0}, {}, {}}, {"Knee", 0, {0, -1, 0}, {}, {}}, {"Foot", 1, {0, -1, 0}, {}, {}}};
  for (std::size_t f = 0; f < frames; ++f) {
    const double angle = motion::radians(bend + 2 * double(f)),
                 x = step * double(f) + 0.05 * std::sin(double(f));
    // The whole leg also swings a little, so that no channel is constant.
    const double swing = 0.1 * std::sin(0.7 * double(f));
    const Vec3 hip{x, 2 + 0.01 * std::sin(double(f)), 0.02 * std::cos(double(f))};
    const Vec3 knee = motion::add(hip, {std::sin(swing), -std::cos(swing), 0});
    const Vec3 foot = motion::add(knee, {std::sin(swing + angle), -std::cos(swing + angle), 0});
    clip.positions.insert(clip.positions.end(), {hip, knee, foot});
  }
  return clip;
}

/// Clips of two classes, with three times as many of "bent"; half are for testing.
motion::ActionDataset legs(std::size_t frames = 20) {
  std::vector<motion::PositionClip> clips;
  motion::ActionLabels labels;
  for (std::size_t i = 0; i < 16; ++i) {
    const std::string id = "leg" + std::to_string(i);
    const bool stretched = i % 4 == 0;
    clips.push_back(leg(id, i == 0 || i % 3 == 1 ? frames : prior_frames * 2, stretched ? 10 : 40, 0.5));
    labels[id] = stretched ? "stretched" : "bent";
  }
  motion::ActionDatasetOptions options;
  options.frames = prior_frames;
  options.rate = 10;
  options.train_share = 0.5;
  return motion::ActionDataset::from_positions(clips, labels, options);
}

/// A model that returns the real future, each pose modified by `change`.
template <class Change>
FutureMaker truth_with(const ActionEvaluation& evaluation, Change change) {
  return [&evaluation, change](std::span<const std::vector<float>> priors, std::span<const std::size_t>,
                               std::size_t frames) {
    std::vector<std::vector<float>> out;
    for (std::size_t i = 0; i < priors.size(); ++i) {
      std::vector<Vec3> all = evaluation.real()[i];
      for (std::size_t f = 0; f < frames; ++f) change(i, f, &all[(prior_frames + f) * 3]);
      const std::vector<float> poses = evaluation.format().encode(all);
      out.emplace_back(poses.begin() + std::ptrdiff_t(prior_frames * evaluation.format().dof()), poses.end());
    }
    return out;
  };
}

/// Rotates the shank about the knee so that the knee bends by `degrees` more.
void bend(Vec3* pose, double degrees) {
  const Vec3 shank = motion::subtract(pose[2], pose[1]);
  const double a = motion::radians(degrees);
  pose[2] = motion::add(pose[1], {std::cos(a) * shank[0] - std::sin(a) * shank[1],
                                  std::sin(a) * shank[0] + std::cos(a) * shank[1], shank[2]});
}

}  // namespace

TEST_CASE("windows: from long test clips only, balanced, distinct, reproducible") {
  const motion::ActionDataset data = legs();
  std::size_t fitting = 0;
  for (const auto& clip : data.test) fitting += clip.frames >= prior_frames + 10;
  REQUIRE(fitting > 2);
  REQUIRE(fitting < data.test.size());
  const EvaluationWindows w = choose_windows(data, 10, 8, 5);
  CHECK(w.clips == data.test.size());
  CHECK(w.long_clips == fitting);
  CHECK(w.windows.size() == 8);
  CHECK(w.per_class == std::vector<std::size_t>{4, 4});
  CHECK(w.clips_per_class[0] + w.clips_per_class[1] == std::min<std::size_t>(fitting, 8));
  std::set<std::pair<std::size_t, std::size_t>> seen;
  for (std::size_t i = 0; i < w.windows.size(); ++i) {
    const EvaluationWindow& window = w.windows[i];
    CHECK(window.label == i % 2);
    CHECK(data.test[window.clip].label == window.label);
    CHECK(window.start + prior_frames + 10 <= data.test[window.clip].frames);
    CHECK(seen.insert({window.clip, window.start}).second);
  }
  const EvaluationWindows again = choose_windows(data, 10, 8, 5), other = choose_windows(data, 10, 8, 6);
  bool same = true;
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(again.windows[i].clip == w.windows[i].clip);
    CHECK(again.windows[i].start == w.windows[i].start);
    same = same && other.windows[i].clip == w.windows[i].clip && other.windows[i].start == w.windows[i].start;
  }
  CHECK_FALSE(same);
  // More than exist: every start of every long clip once.
  CHECK(choose_windows(data, 10, 1000).windows.size() == fitting * (20 - prior_frames - 10 + 1));
  CHECK(says(message_of([&] { choose_windows(data, 17, 8); }), "lasts 21 frames"));
  CHECK(says(message_of([&] { choose_windows(data, 17, 8); }), "the longest has 20"));
  CHECK_THROWS_AS(choose_windows(data, 0, 8), Error);
}

TEST_CASE("measures of the real motion") {
  const motion::ActionDataset data = legs();
  const ActionEvaluation evaluation(data, {.windows = 6, .frames = 10, .unit_metres = 0.1});
  const ActionMeasures& truth = evaluation.truth();
  REQUIRE(truth.angles.size() == 10);
  for (std::size_t f = 0; f < 10; ++f) {
    double mean = 0;
    for (const EvaluationWindow& w : evaluation.windows().windows)
      mean += ((w.label == 0 ? 40 : 10) + 2 * double(w.start + prior_frames + f)) / 6;
    CHECK(truth.angles[f] == doctest::Approx(mean).epsilon(1e-4));
  }
  CHECK(truth.curve_error == 0);
  CHECK(truth.window_error == 0);
  CHECK(truth.bone_error < 1e-3);
  CHECK(truth.speed ==
        doctest::Approx(0.5 * 10 * 0.1).epsilon(1e-3));  // per frame, frames per second, metres
  CHECK(truth.distance == doctest::Approx(0.5 * 10 * 0.1).epsilon(0.03));
  CHECK(truth.seam > 0.05);
  CHECK(truth.seam == doctest::Approx(truth.step).epsilon(0.2));
}

TEST_CASE("models with known errors") {
  const motion::ActionDataset data = legs();
  const ActionEvaluation evaluation(data, {.windows = 6, .frames = 10, .unit_metres = 0.1});
  const ActionMeasures exact =
      evaluation.measure(truth_with(evaluation, [](std::size_t, std::size_t, Vec3*) {}));
  CHECK(exact.curve_error < 1e-3);
  CHECK(exact.window_error < 1e-3);
  CHECK(exact.step == doctest::Approx(evaluation.truth().step).epsilon(1e-4));
  CHECK(exact.seam == doctest::Approx(evaluation.truth().seam).epsilon(1e-4));

  // Knees bent 3 degrees too far, 9 from frame 6 on: the error of the last 4 frames is 9.
  const ActionMeasures bent = evaluation.measure(
      truth_with(evaluation, [](std::size_t, std::size_t f, Vec3* pose) { bend(pose, f < 6 ? 3 : 9); }));
  CHECK(bent.curve_error == doctest::Approx((6 * 3 + 4 * 9) / 10.0).epsilon(1e-3));
  CHECK(bent.curve_error_first == doctest::Approx(3).epsilon(1e-3));
  CHECK(bent.curve_error_last == doctest::Approx(9).epsilon(1e-3));
  CHECK(bent.window_error == doctest::Approx(bent.curve_error).epsilon(1e-3));
  CHECK(bent.window_error_deviation < 1e-3);
  CHECK(bent.bone_error < 1e-3);

  // Too far in half of the windows and too little in the others: no curve error, but window errors.
  const ActionMeasures both = evaluation.measure(truth_with(
      evaluation, [](std::size_t i, std::size_t, Vec3* pose) { bend(pose, i % 2 == 0 ? 4 : -4); }));
  CHECK(both.curve_error < 1e-3);
  CHECK(both.window_error == doctest::Approx(4).epsilon(1e-3));

  // Shanks 10% too long: one of two bones.
  const ActionMeasures longer =
      evaluation.measure(truth_with(evaluation, [](std::size_t, std::size_t, Vec3* pose) {
        pose[2] = motion::add(pose[1], motion::scale(motion::subtract(pose[2], pose[1]), 1.1));
      }));
  CHECK(longer.bone_error == doctest::Approx(5).epsilon(1e-3));
  CHECK(longer.curve_error < 1e-2);
  CHECK(longer.broken == 0);
  // One of six windows is broken, in its last four frames only: its thigh is far too long.
  const ActionMeasures apart =
      evaluation.measure(truth_with(evaluation, [](std::size_t i, std::size_t f, Vec3* pose) {
        if (i != 2 || f < 6) return;
        for (const std::size_t j : {1u, 2u}) pose[j] = motion::add(pose[j], {0, -4, 0});
      }));
  CHECK(apart.broken == doctest::Approx(1 / 6.0));

  // Feet that jump up by 3 at frame 4 and stay there: one of three seams (frames 0, 4 and 8), by 3 in one of
  // three joints, in addition to the real motion.
  const auto lift = [](std::size_t, std::size_t f, Vec3* pose) {
    if (f >= 4) pose[2][1] += 3;
  };
  const ActionMeasures jump = evaluation.measure(truth_with(evaluation, lift));
  CHECK(jump.first_seam == doctest::Approx(evaluation.truth().first_seam).epsilon(1e-3));
  CHECK(jump.seam - evaluation.truth().seam == doctest::Approx(0.1 * 3 / 3.0 / 3).epsilon(0.15));
  CHECK(jump.seam_body - evaluation.truth().seam_body == doctest::Approx(0.1 * 3 / 3.0 / 3).epsilon(0.15));

  // The prior's last pose held: no displacement, and a constant angle.
  const ActionMeasures still = evaluation.measure(stand_still(data.format));
  CHECK(still.step < 1e-5);
  CHECK(still.speed < 1e-4);
  CHECK(still.window_error == doctest::Approx(2 * (1 + 10) / 2.0).epsilon(1e-3));
  const ActionMeasures alone = evaluation.measure_alone(evaluation.positions(stand_still(data.format), 50));
  CHECK(alone.angles.size() == 50);
  CHECK(alone.curve_error == 0);
  CHECK(alone.bone_error < 1e-3);
}

TEST_CASE("future_maker() equals feeding back the model's output, independent of the other windows") {
  const Context context;
  const motion::ActionDataset data = legs();
  const ActionEvaluation evaluation(data, {.windows = 3, .frames = 10});
  for (const ActionGenerator kind : {ActionGenerator::attention, ActionGenerator::lstm}) {
    const ActionGan model(context, data.format, {.generator = kind, .hidden = 16});
    const auto made = future_maker(model)(evaluation.priors(), evaluation.labels(), 10);
    REQUIRE(made.size() == 3);
    const std::size_t dof = data.format.dof();
    for (std::size_t b = 0; b < 3; ++b) {
      const NoGrad values_only;
      Tensor prior(context, {prior_frames, 1, dof});
      prior.write(std::span<const float>(evaluation.priors()[b]));
      const Var classes =
          Var::constant(one_hot(context, std::vector<std::size_t>{evaluation.labels()[b]}, 2));
      std::vector<float> wanted;
      for (Var fed = Var::constant(prior); wanted.size() < 10 * dof;) {
        fed = model.forward(fed, classes);
        const std::vector<float> values = fed.value().to_host();
        wanted.insert(wanted.end(), values.begin(), values.end());
      }
      REQUIRE(made[b].size() == 10 * dof);
      for (std::size_t k = 0; k < made[b].size(); ++k)
        CHECK(std::abs(made[b][k] - wanted[k]) <= 1e-4 * (1 + std::abs(wanted[k])));
    }
    CHECK(evaluation.measure(future_maker(model)).curve_error > 0);
  }
}

}  // namespace action_evaluation_test
