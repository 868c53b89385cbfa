// Places and velocities of the joints beside those of the decoded motion, for every root form.
#include "motiongan/networks/body_view.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "../support/walking_data.hpp"

namespace body_view_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::RootRotation;
using motion::Vec3;

TEST_CASE("places and velocities are those of the motion" * doctest::test_suite("double")) {
  for (const RootRotation form : root_forms) {
    CAPTURE(static_cast<int>(form));
    const motion::Dataset data = walking_data(form);
    const motion::MotionFormat& format = data.format;
    const std::size_t joints = format.skeleton().size();
    const double leg = motion::leg_length(format.skeleton());
    std::vector<motion::Motion> motions;
    for (std::size_t b = 0; b < 2; ++b) motions.push_back(format.to_motion(window_of(data, b)));
    const BodyView view(double_context(), format);
    REQUIRE(view.size() == 6 * joints - 2);  // but for x and z of the root
    const std::vector<double> seen =
        view(Var::constant(windows_of(data, double_context(), 2))).value().to_host<double>();
    for (std::size_t b = 0; b < 2; ++b) {
      const std::vector<Vec3> world = motion::joint_positions(motions[b]);
      const auto heading = [&](std::size_t f) {
        return form == RootRotation::expmap ? 0 : motion::heading_from_quat(motions[b].rotation(f, 0))[1];
      };
      const auto in_heading = [&](Vec3 v, std::size_t f) {
        motion::turn_ground(v[0], v[2], -heading(f));
        return v;
      };
      for (std::size_t f = 0; f < 8; ++f) {
        const double* row = &seen[(f * 2 + b) * view.size()];
        const auto check_next = [&](double expected) { CHECK(std::abs(*row++ - expected) < 1e-9); };
        const std::size_t now = std::max<std::size_t>(f, 1);
        for (const std::size_t axis : {0, 1, 2})
          for (std::size_t j = 0; j < joints; ++j) {
            if (j == 0 && axis != 1) continue;
            const Vec3 at = world[f * joints + j],
                       from = in_heading(motion::subtract(at, world[f * joints]), f);
            check_next(3 / leg * (axis == 1 ? at[1] : from[axis]));
          }
        for (const std::size_t axis : {0, 1, 2})
          for (std::size_t j = 0; j < joints; ++j)
            check_next(5 / leg *
                       in_heading(motion::subtract(world[now * joints + j], world[(now - 1) * joints + j]),
                                  now - 1)[axis]);
      }
    }
  }
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
