// The losses on what is seen of the body: their derivatives, and what they punish.
#include "motiongan/networks/body_losses.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "../support/small_actions.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace body_losses_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

motion::Dataset walks() {
  auto clips = motion::procedural_motions({.clips = 2, .seconds = 6, .rate = 12, .seed = 3});
  return motion::Dataset::from_motions(
      clips, {.frames = 16, .rate = 12, .root_rotation = motion::RootRotation::velocity, .train_share = 1});
}

/// Windows of the first training clip, [frames, batch, dof].
std::vector<double> windows(const motion::Dataset& data, std::size_t batch) {
  const std::size_t frames = data.format.frames, dof = data.format.dof();
  std::vector<double> out(frames * batch * dof);
  std::vector<float> window(frames * dof);
  for (std::size_t b = 0; b < batch; ++b) {
    data.window(data.train[0], 3 * b, window);
    for (std::size_t i = 0; i < window.size(); ++i) out[(i / dof * batch + b) * dof + i % dof] = window[i];
  }
  return out;
}

}  // namespace

TEST_CASE("first and second derivatives of the losses" * doctest::test_suite("double")) {
  const motion::Dataset data = walks();
  const std::vector<double> real = windows(data, 4);
  const Shape shape{16, 4, data.format.dof()};
  const Tensor truth = Tensor::from(double_context(), shape, real);
  for (const BodyLossOptions& options : {BodyLossOptions{.smooth = 1}, BodyLossOptions{.contact = 1}}) {
    const BodyLosses losses(data.format, options, truth);
    Input near = randn(shape);
    for (std::size_t i = 0; i < real.size(); ++i) near.values[i] = real[i] + 0.2 * near.values[i];
    const auto loss = [&](auto& v) { return losses(v[0], Var::constant(truth)); };
    CHECK(check_grads(double_context(), loss, {near}, 2, 1e-5) < 1e-5);
  }
}

TEST_CASE("what trembles or slides costs, what is like the clips does not" * doctest::test_suite("double")) {
  const motion::Dataset data = walks();
  const std::size_t dof = data.format.dof();
  const std::vector<double> real = windows(data, 8);
  const Shape shape{16, 8, dof};
  const Tensor truth = Tensor::from(double_context(), shape, real);
  const auto loss = [&](const BodyLossOptions& options, const std::vector<double>& made) {
    return BodyLosses(data.format, options, truth)(Var::constant(Tensor::from(double_context(), shape, made)),
                                                   Var::constant(truth))
        .item();
  };
  const BodyLossOptions smooth{.smooth = 1}, contact{.contact = 1};
  CHECK(loss(smooth, real) == 0);
  CHECK(loss(contact, real) == 0);
  std::vector<double> trembling = real, calm = real, sliding = real, floating = real;
  const std::size_t step_x = data.format.dof() - 3;
  for (std::size_t i = 0; i < real.size(); ++i) {
    const std::size_t frame = i / dof / 8, d = i % dof;
    trembling[i] += frame % 2 == 0 ? 0.1 : -0.1;
    calm[i] *= 0.5;
    if (d == step_x) sliding[i] += 8;
    if (d == step_x + 1) floating[i] += 3;
  }
  CHECK(loss(smooth, trembling) > 1);
  CHECK(loss(smooth, calm) < 0.05);  // less movement than in the clips is no trembling
  CHECK(loss(contact, sliding) > 0.1);
  CHECK(loss(contact, floating) > 0.02);
  motion::MotionFormat arm = data.format;
  motion::Skeleton s = arm.skeleton();
  for (motion::Joint& joint : s.joints) joint.name = "joint" + joint.name.substr(joint.name.size() / 2);
  arm.layout = motion::PoseLayout(s, true, 0, motion::RootRotation::velocity);
  CHECK_THROWS_WITH_AS(BodyLosses(arm, contact, truth), doctest::Contains("no joint names contain"), Error);
}

TEST_CASE("the losses of poses of positions" * doctest::test_suite("double")) {
  const motion::PositionFormat& format = small_actions().format;
  const std::size_t dof = format.dof(), frames = 8, batch = 4;
  std::vector<double> real(frames * batch * dof);
  for (std::size_t i = 0; i < real.size(); ++i) {
    const std::size_t frame = i / dof / batch, b = i / dof % batch;
    real[i] = small_actions().train[b].poses[(frame + 2 * b) * dof + i % dof];
  }
  const Shape shape{frames, batch, dof};
  const Tensor truth = Tensor::from(double_context(), shape, real);
  const BodyLosses smooth(format, {.smooth = 1}, truth), contact(format, {.contact = 1}, truth);
  const auto loss = [&](const BodyLosses& losses, const std::vector<double>& made) {
    return losses(Var::constant(Tensor::from(double_context(), shape, made)), Var::constant(truth)).item();
  };
  CHECK(loss(smooth, real) == 0);
  CHECK(loss(contact, real) == 0);
  std::vector<double> trembling = real, floating = real;
  const auto& kept = format.normalizer.kept();
  const auto height = static_cast<std::size_t>(
      std::find(kept.begin(), kept.end(), format.layout.track_dim() + 2) - kept.begin());
  REQUIRE(height < dof);
  for (std::size_t i = 0; i < real.size(); ++i) {
    trembling[i] += i / dof / batch % 2 == 0 ? 0.1 : -0.1;
    if (i % dof == height) floating[i] += 5;
  }
  CHECK(loss(smooth, trembling) > 1);
  CHECK(loss(contact, floating) > 0.02);
  for (const BodyLosses* losses : {&smooth, &contact}) {
    Input near = randn(shape);
    for (std::size_t i = 0; i < real.size(); ++i) near.values[i] = real[i] + 0.2 * near.values[i];
    const auto value = [&](auto& v) { return (*losses)(v[0], Var::constant(truth)); };
    CHECK(check_grads(double_context(), value, {near}, 2, 1e-5) < 1e-5);
  }
}

}  // namespace body_losses_test
