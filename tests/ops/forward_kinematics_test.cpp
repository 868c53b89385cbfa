// The kinematics operation against that of a Motion, in both precisions.
#include "motiongan/ops/forward_kinematics.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace forward_kinematics_test {

using namespace motiongan;

TEST_CASE("positions of a procedural motion are those of its forward kinematics") {
  motion::Motion m = motion::procedural_motions({.clips = 1, .seconds = 2, .rate = 15})[0].motion;
  const std::size_t joints = m.skeleton.size();
  for (std::size_t f = 0; f < m.frames; ++f) m.position(f, 0) = {};
  const double leg = motion::leg_length(m.skeleton);
  const std::vector<motion::Vec3> expected = motion::joint_positions(m);
  std::vector<double> maps(3 * joints * m.frames);
  for (std::size_t f = 0; f < m.frames; ++f)
    for (std::size_t j = 0; j < joints; ++j)
      for (std::size_t c = 0; c < 3; ++c)
        maps[(3 * j + c) * m.frames + f] = motion::expmap_from_quat(m.rotation(f, j))[c];
  for (const Precision precision : testing::precisions()) {
    const Context context({.precision = precision});
    const JointTree tree(context, m.skeleton);
    const std::vector<double> found =
        forward_kinematics(Var::constant(Tensor::from(context, {3 * joints, m.frames}, maps)), tree)
            .value()
            .to_host<double>();
    const double tolerance = precision == Precision::f32 ? 1e-6 : 1e-12;
    for (std::size_t f = 0; f < m.frames; ++f)
      for (std::size_t j = 0; j < joints; ++j)
        for (std::size_t c = 0; c < 3; ++c)
          CHECK(std::abs(found[(3 * j + c) * m.frames + f] - expected[f * joints + j][c]) < tolerance * leg);
  }
}

TEST_CASE("single precision: gradients near no turn keep their digits") {
  motion::Skeleton body;
  body.joints = {{"Hips", -1, {}, {}, {}}, {"Spine", 0, {0.1, 0.8, -0.2}, {}, {}}};
  for (const double turn : {0.0, 1e-4, 0.05, 0.0999, 0.1001, 2.0}) {
    std::vector<double> gradients[2];
    for (const Precision precision : testing::precisions()) {
      const Context context({.precision = precision});
      const Var q = Var::leaf(Tensor::from(
          context, {6, 1}, std::vector<double>{turn * 0.6, -turn * 0.64, turn * 0.48, 0.1, 0.2, 0.3}));
      const Var weights =
          Var::constant(Tensor::from(context, {6, 1}, std::vector<double>{0, 0, 0, 0.3, -0.9, 0.5}));
      gradients[precision == Precision::f64 ? 1 : 0] =
          grad(sum(forward_kinematics(q, JointTree(context, body)) * weights), {q})[0]
              .value()
              .to_host<double>();
    }
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(gradients[0][i] - gradients[1][i]) < 1e-6);
  }
}

TEST_CASE("the lowest joint of every pose is marked, the first of equals") {
  const Context context;
  const std::vector<float> heights{3, 1, 0, 2, 1, -1, 2, 5, -1};
  const Var marked = mark_lowest(Var::constant(Tensor::from(context, {3, 3}, heights)));
  CHECK(marked.value().to_host<float>() == std::vector<float>{0, 1, 0, 1, 0, 1, 0, 0, 0});
}

}  // namespace forward_kinematics_test
