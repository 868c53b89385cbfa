// The auxiliary generator losses, against values computed by hand.
#include <doctest/doctest.h>

#include <motiongan/networks/motion_losses.hpp>
#include <motiongan/ops/cross_entropy.hpp>

#include "../support/check_grads.hpp"
#include "../support/messages.hpp"

namespace motion_losses_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

motion::Joint joint(const char* name, int parent, double below) {
  motion::Joint made;
  made.name = name;
  made.parent = parent;
  made.offset = {0, below, 0};
  return made;
}

/// A root, a knee 2 below it, a foot 4 below the knee, and a toe of zero length. Mean bone length 3.
motion::PositionFormat leg() {
  motion::Skeleton skeleton;
  skeleton.joints = {joint("root", -1, 0), joint("knee", 0, -2), joint("foot", 1, -4), joint("toe", 2, 0)};
  motion::PositionFormat format;
  format.layout = motion::PositionLayout(skeleton, false);
  // The root's three dimensions are constant and dropped. 9 are kept.
  std::vector<double> mean(12, 0.0), deviation(12, 0.5);
  mean[4] = -2, mean[7] = -6, mean[10] = -6;
  deviation[0] = deviation[1] = deviation[2] = 0;
  format.normalizer = motion::Normalizer(mean, deviation);
  format.classes = {"walk"};
  format.check();
  return format;
}

/// Frames of one sample from the heights of knee, foot and toe, normalised as by leg().
Var along_y(const std::vector<std::array<double, 3>>& frames) {
  std::vector<double> values;
  for (const auto& [knee, foot, toe] : frames)
    for (const double v : {0.0, (knee + 2) / 0.5, 0.0, 0.0, (foot + 6) / 0.5, 0.0, 0.0, (toe + 6) / 0.5, 0.0})
      values.push_back(v);
  return Var::constant(Tensor::from(double_context(), {frames.size(), 1, 9}, values));
}

}  // namespace

TEST_CASE("the skeleton loss by hand" * doctest::test_suite("double")) {
  const SkeletonLoss loss(double_context(), leg());
  const Var prior = along_y({{-2, -6, -6}, {-9, -9, -9}});  // only its first frame is used: bones of 2 and 4
  CHECK(loss(prior, along_y({{-2, -6, -6}, {2, 6, 5}})).item() == doctest::Approx(0).epsilon(1e-9));
  // Bones of 3 and 4, then of 2 and 7: errors 1 and 3 in two frames, divided by the mean length 3.
  CHECK(loss(prior, along_y({{-3, -7, -7}, {-2, -9, -9}})).item() == doctest::Approx((1 + 9) / 2.0 / 9));
  // Directions matter only for bone vectors: the two flipped bones are off by 4 and 8.
  const SkeletonLoss vectors(double_context(), leg(), true);
  CHECK(vectors(prior, along_y({{2, 6, 6}})).item() == doctest::Approx((16 + 64) / 9.0));
  // The mean over two samples, each against its own prior.
  const Var both = concatenate({along_y({{-3, -7, -7}}), along_y({{-2, -6, -6}})}, 1);
  const Var priors = concatenate({along_y({{-2, -6, -6}}), along_y({{-2, -9, -9}})}, 1);
  CHECK(loss(priors, both).item() == doctest::Approx((1.0 + 9.0) / 2 / 9));
}

TEST_CASE("bones collapsed to a point have a finite gradient" * doctest::test_suite("double")) {
  const SkeletonLoss loss(double_context(), leg());
  const Var prior = along_y({{-2, -6, -6}});
  const Var x = Var::leaf(along_y({{0, 0, 0}}).value());
  for (const double g : grad(loss(prior, x), {x})[0].value().to_host<double>()) CHECK(std::isfinite(g));
}

TEST_CASE("derivatives of the losses" * doctest::test_suite("double")) {
  const SkeletonLoss lengths(double_context(), leg()), vectors(double_context(), leg(), true);
  const Input prior = randn({2, 2, 9}), future = randn({3, 2, 9});
  CHECK(check_grads(
            double_context(), [&](auto& v) { return lengths(v[0], v[1]); }, {prior, future}, 2) < 1e-6);
  CHECK(check_grads(
            double_context(), [&](auto& v) { return vectors(v[0], v[1]); }, {prior, future}, 2) < 1e-6);
  CHECK(check_grads(
            double_context(), [&](auto& v) { return blend_loss(v[0], v[1]); }, {prior, future}, 2) < 1e-6);
}

TEST_CASE("the blend loss by hand" * doctest::test_suite("double")) {
  const auto frames = [](const std::vector<double>& values, std::size_t count) {
    return Var::constant(Tensor::from(double_context(), {count, 2, 2}, values));
  };
  const Var prior = frames({9, 9, 9, 9, /* last */ 1, 2, 3, 4}, 2);
  const Var future = frames({/* first */ 2, 4, 3, 1, 7, 7, 7, 7}, 2);
  CHECK(blend_loss(prior, future).item() == doctest::Approx(((1 + 4) + (0 + 9)) / 2.0));
}

TEST_CASE("cross-entropy by hand, and for large logits" * doctest::test_suite("double")) {
  const Var logits =
      Var::constant(Tensor::from(double_context(), {2, 2}, std::vector<double>{0, 0, 1000, 0}));
  const auto against = [&](std::vector<std::size_t> labels) {
    return cross_entropy(logits, Var::constant(one_hot(double_context(), labels, 2))).item();
  };
  CHECK(against({0, 0}) == doctest::Approx(std::log(2) / 2));
  CHECK(against({1, 1}) == doctest::Approx((std::log(2) + 1000) / 2));
  CHECK(says(message_of([&] {
               one_hot(double_context(), std::vector<std::size_t>{0, 2}, 2);
             }),
             "label 2 of sample 1, expected less than 2"));
}

TEST_CASE("a skeleton without bones is rejected" * doctest::test_suite("double")) {
  motion::PositionFormat format = leg();
  motion::Skeleton point;
  point.joints = {joint("root", -1, 0)};
  format.layout = motion::PositionLayout(point, true);
  format.normalizer = motion::Normalizer(std::vector<double>(7, 0.0), std::vector<double>(7, 1.0));
  CHECK(says(message_of([&] { SkeletonLoss(double_context(), format); }), "no bone of non-zero length"));
}

}  // namespace motion_losses_test
