// Joints in the world beside those of the decoded motion, for every root form.
#include "motiongan/networks/world_view.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "../support/walking_data.hpp"
#include "motiongan/direct/world_pose.hpp"

namespace world_view_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::RootRotation;
using motion::Vec3;

TEST_CASE("joints are where the motion has them, seen from its first frame" * doctest::test_suite("double")) {
  for (const RootRotation form : root_forms) {
    CAPTURE(static_cast<int>(form));
    const motion::Dataset data = walking_data(form);
    const motion::MotionFormat& format = data.format;
    const std::size_t joints = format.skeleton().size(), batch = 2;
    const Tensor windows = windows_of(data, double_context(), batch);
    const WorldRows seen = WorldView(double_context(), format)(Var::constant(windows));
    const auto host = [](const Var& v) { return v.value().to_host<double>(); };
    const std::vector<double> x = host(seen.x), y = host(seen.y), z = host(seen.z), bx = host(seen.body.x),
                              bz = host(seen.body.z), c = host(seen.cosine), s = host(seen.sine);
    for (std::size_t b = 0; b < batch; ++b) {
      const motion::Motion made =
          motion::placed_at(format.to_motion(window_of(data, b)), format.layout.root(), {}, true);
      for (std::size_t f = 0; f < format.frames; ++f) {
        const WorldPose pose = world_pose(made, f, format.layout.root());
        const std::size_t at = f * batch + b, poses = format.frames * batch;
        CHECK(std::abs(c[at] - std::cos(pose.yaw)) < 1e-9);
        CHECK(std::abs(s[at] - std::sin(pose.yaw)) < 1e-9);
        const std::vector<Vec3> world = motion::joint_positions(made);
        for (std::size_t j = 0; j < joints; ++j) {
          const Vec3 place = pose.joint(j);
          CHECK(motion::length(motion::subtract(place, world[f * joints + j])) < 1e-9);
          CHECK(motion::length(motion::subtract(
                    place, Vec3{x[j * poses + at], y[j * poses + at], z[j * poses + at]})) < 1e-7);
          CHECK(std::abs(bx[j * poses + at] - pose.body[j][0]) < 1e-7);
          CHECK(std::abs(bz[j * poses + at] - pose.body[j][2]) < 1e-7);
        }
      }
    }
  }
}

TEST_CASE("first and second derivatives of the places and the heading" * doctest::test_suite("double")) {
  for (const RootRotation form : root_forms) {
    CAPTURE(static_cast<int>(form));
    const motion::Dataset data = walking_data(form);
    const WorldView view(double_context(), data.format);
    const auto all = [&](const std::vector<Var>& in) {
      const WorldRows rows = view(in[0]);
      return concatenate({rows.x, rows.y, rows.z, rows.body.x, rows.body.z, rows.cosine, rows.sine}, 0);
    };
    CHECK(check_grads(double_context(), all, {randn({3, 2, data.format.dof()})}, 2) < 1e-7);
  }
}

}  // namespace world_view_test
