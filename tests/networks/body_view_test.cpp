// Places and velocities of the joints beside those of the decoded motion, for every root form.
#include "motiongan/networks/body_view.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "../support/small_actions.hpp"
#include "../support/walking_data.hpp"

namespace body_view_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::RootRotation;
using motion::Vec3;

namespace {

/// Checks what is seen, [frames, batch, size], of motion `b`, whose joints are at `world` [frames, joints]
/// and whose root heads for `yaw` in each frame.
void check_seen(const std::vector<double>& seen, std::size_t batch, std::size_t b,
                const std::vector<Vec3>& world, const std::vector<double>& yaw, double leg, double rate,
                double tolerance) {
  const std::size_t frames = yaw.size(), joints = world.size() / frames, size = 6 * joints - 2;
  REQUIRE(seen.size() == frames * batch * size);  // all but x and z of the root
  const auto in_heading = [&](Vec3 v, std::size_t f) {
    motion::turn_ground(v[0], v[2], -yaw[f]);
    return v;
  };
  for (std::size_t f = 0; f < frames; ++f) {
    const double* row = &seen[(f * batch + b) * size];
    const auto check_next = [&](double expected) { CHECK(std::abs(*row++ - expected) < tolerance); };
    const std::size_t now = std::max<std::size_t>(f, 1);
    for (const std::size_t axis : {0, 1, 2})
      for (std::size_t j = 0; j < joints; ++j) {
        if (j == 0 && axis != 1) continue;
        const Vec3 at = world[f * joints + j], from = in_heading(motion::subtract(at, world[f * joints]), f);
        check_next(3 / leg * (axis == 1 ? at[1] : from[axis]));
      }
    for (const std::size_t axis : {0, 1, 2})
      for (std::size_t j = 0; j < joints; ++j)
        check_next(rate / leg *
                   in_heading(motion::subtract(world[now * joints + j], world[(now - 1) * joints + j]),
                              now - 1)[axis]);
  }
}

}  // namespace

TEST_CASE("places and velocities are those of the motion" * doctest::test_suite("double")) {
  for (const RootRotation form : root_forms) {
    CAPTURE(static_cast<int>(form));
    const motion::Dataset data = walking_data(form);
    const motion::MotionFormat& format = data.format;
    const std::vector<double> seen =
        BodyView(double_context(), format)(Var::constant(windows_of(data, double_context(), 2)))
            .value()
            .to_host<double>();
    for (std::size_t b = 0; b < 2; ++b) {
      const motion::Motion made = format.to_motion(window_of(data, b));
      std::vector<double> yaw(format.frames);
      for (std::size_t f = 0; f < yaw.size() && form != RootRotation::expmap; ++f)
        yaw[f] = motion::heading_from_quat(made.rotation(f, 0))[1];
      check_seen(seen, 2, b, motion::joint_positions(made), yaw, motion::leg_length(format.skeleton()), 5,
                 1e-9);
    }
  }
}

TEST_CASE("those of poses of positions too" * doctest::test_suite("double")) {
  const motion::PositionFormat& format = small_actions().format;
  const std::size_t dof = format.dof(), frames = 9;
  const motion::ActionClip& clip = small_actions().train.back();
  const std::vector<float> poses(clip.poses.begin(),
                                 clip.poses.begin() + static_cast<std::ptrdiff_t>(frames * dof));
  const BodyView view(double_context(), format);
  const std::vector<Vec3> world = format.decode(poses);
  std::vector<double> yaw;
  for (const motion::RootTrack& at : format.layout.places(world)) yaw.push_back(at.yaw);
  check_seen(
      view(Var::constant(Tensor::from(double_context(), {frames, 1, dof}, poses))).value().to_host<double>(),
      1, 0, world, yaw, motion::leg_length(format.skeleton()), format.rate, 1e-5);  // turns are rounded
  CHECK(check_grads(
            double_context(), [&](auto& v) { return view(v[0]); }, {randn({3, 2, dof})}, 2) < 1e-7);
}

TEST_CASE("first and second derivatives, with and without the root's position" *
          doctest::test_suite("double")) {
  for (const RootRotation form : root_forms)
    for (const bool position : {true, false}) {
      CAPTURE(static_cast<int>(form));
      CAPTURE(position);
      const motion::Dataset data = walking_data(form, position);
      const BodyView view(double_context(), data.format);
      const std::size_t dof = data.format.dof();
      CHECK(check_grads(
                double_context(), [&](auto& v) { return view(v[0]); }, {randn({3, 2, dof})}, 2) < 1e-7);
    }
}

TEST_CASE("what cannot be seen is an error" * doctest::test_suite("double")) {
  const motion::Dataset data = walking_data(RootRotation::heading);
  const BodyView view(double_context(), data.format);
  CHECK_THROWS_WITH_AS(view(Var::constant(Tensor(double_context(), {1, 2, data.format.dof()}))),
                       doctest::Contains("expected [2 or more frames, batch, "), Error);
}

}  // namespace body_view_test
