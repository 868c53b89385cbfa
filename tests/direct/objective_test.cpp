// The loss of constraints: nothing where they are met, with the right derivatives, and as large as what is
// measured on the motion itself.
#include "motiongan/direct/objective.hpp"

#include <doctest/doctest.h>

#include "../support/check_grads.hpp"
#include "../support/walking_data.hpp"
#include "motiongan/direct/errors.hpp"

namespace objective_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Motion;
using motion::RootRotation;

namespace {

/// A motion of the data set in the world: moved and turned.
struct Placed {
  motion::Dataset data;
  motion::RootTrack anchor{3, -2, 0.8, true};
  Motion motion;
  double seconds = 7 / 5.0;

  explicit Placed(RootRotation form) : data(walking_data(form)) {
    motion = motion::placed_at(data.format.to_motion(window_of(data, 0)), root(), anchor, true);
  }
  std::size_t root() const { return data.format.layout.root(); }
  WorldPose pose(std::size_t frame) const { return world_pose(motion, frame, root()); }

  /// Constraints of every kind that the motion itself meets; a loop is not one of them.
  std::vector<Constraint> met() const {
    const std::size_t foot = motion::find_feet(motion.skeleton).front();
    std::vector<PathPoint> timed, untimed;
    for (std::size_t f = 0; f < 8; ++f) {
      const WorldPose p = pose(f);
      timed.push_back({p.x, p.z, static_cast<double>(f) / 5, p.yaw});
      if (f % 7 == 0) untimed.push_back({p.x, p.z});
    }
    return {PoseConstraint{.time = 0.6, .pose = slice(motion, 3, 2)},
            PoseConstraint{.time = 0.6, .pose = slice(motion, 3, 1), .joints = {1, foot}, .placed = true},
            JointConstraint{.joint = foot, .from = 1, .to = 1, .position = pose(5).joint(foot)},
            JointConstraint{.joint = 1, .from = 0.4, .to = 0.4, .rotation = motion.rotation(2, 1)},
            PathConstraint{.points = timed}};
  }
};

Var loss_of(const Placed& from, const std::vector<Constraint>& constraints, const Var& motion) {
  DirectObjective objective(double_context(), from.data.format, motion.dim(0), motion.dim(1));
  for (std::size_t b = 0; b < motion.dim(1); ++b) objective.add(b, constraints, from.anchor, from.seconds);
  objective.finish(double_context());
  return objective(motion);
}

}  // namespace

TEST_CASE("a motion meets what is taken from it, and a moved one does not" * doctest::test_suite("double")) {
  for (const RootRotation form : root_forms) {
    CAPTURE(static_cast<int>(form));
    const Placed from(form);
    const Var own = Var::constant(windows_of(from.data, double_context(), 1));
    for (const Constraint& c : from.met()) {
      CAPTURE(c.index());
      CHECK(loss_of(from, {c}, own).item() < 1e-9);
      const ConstraintError error = constraint_errors(from.motion, from.root(), {c}, 0, from.seconds).front();
      CHECK(error.worst < 1e-6);
      CHECK(error.angle < 1e-6);
      CHECK(error.met());
      CHECK(error.name.size() > 4);
      // Another motion of the data set is elsewhere, and its joints are turned.
      Motion other = motion::placed_at(from.data.format.to_motion(window_of(from.data, 1)), from.root(),
                                       {from.anchor.x + 1, from.anchor.z, 2, true}, true);
      for (std::size_t f = 0; f < other.frames; ++f)
        for (std::size_t j = 1; j < other.skeleton.size(); ++j)
          other.rotation(f, j) = motion::multiply(other.rotation(f, j), motion::axis_rotation(0, 0.3));
      CHECK(constraint_errors(other, from.root(), {c}, 0, from.seconds).front().excess() > 1);
    }
  }
}

TEST_CASE("the loss of a pose is its squared error in legs, whatever the batch" *
          doctest::test_suite("double")) {
  const Placed from(RootRotation::support);
  const double leg = motion::body_unit(from.motion.skeleton);
  const std::vector<Constraint> pose{PoseConstraint{.time = 0.6, .pose = slice(from.motion, 5, 1)}};
  const Var two = Var::constant(windows_of(from.data, double_context(), 2)), one = slice(two, 1, 0, 1),
            other = slice(two, 1, 1, 1);
  const double far = constraint_errors(from.motion, from.root(), pose, 0, from.seconds).front().worst / leg;
  CHECK(loss_of(from, pose, one).item() == doctest::Approx(far * far));
  CHECK(loss_of(from, pose, two).item() ==
        doctest::Approx(loss_of(from, pose, one).item() + loss_of(from, pose, other).item()));
}

TEST_CASE("first and second derivatives of every constraint" * doctest::test_suite("double")) {
  for (const RootRotation form : {RootRotation::expmap, RootRotation::heading, RootRotation::support}) {
    const Placed from(form);
    std::vector<Constraint> all = from.met();
    all.push_back(LoopConstraint{});
    all.push_back(LoopConstraint{.seconds = 1});
    all.push_back(ContactConstraint{.joint = 3, .from = 0.2, .to = 0.8});
    all.push_back(PathConstraint{.points = {{0, 0}, {1, 2}, {2, 5}}});
    for (const Constraint& c : all) {
      CAPTURE(static_cast<int>(form));
      CAPTURE(c.index());
      CHECK(check_grads(
                double_context(), [&](const auto& v) { return loss_of(from, {c}, v[0]); },
                {randn({8, 2, from.data.format.dof()})}, 2) < 1e-6);
    }
  }
}

TEST_CASE("a loop compares its ends and the movement there" * doctest::test_suite("double")) {
  const Placed from(RootRotation::support);
  const Var own = Var::constant(windows_of(from.data, double_context(), 1));
  const double whole = loss_of(from, {LoopConstraint{}}, own).item();
  CHECK(whole > 1e-4);
  CHECK(loss_of(from, {LoopConstraint{.weight = 3}}, own).item() == doctest::Approx(3 * whole));
  // A motion that stands still is a loop.
  std::vector<float> still;
  const std::size_t dof = from.data.format.dof();
  {
    Motion standing = slice(from.motion, 0, 1);
    for (int f = 0; f < 7; ++f) standing = join(std::move(standing), slice(from.motion, 0, 1));
    still = from.data.format.encode_window(standing);
  }
  CHECK(loss_of(from, {LoopConstraint{}}, Var::constant(Tensor::from(double_context(), {8, 1, dof}, still)))
            .item() < 1e-9);
}

TEST_CASE("samples of a batch have loops of their own" * doctest::test_suite("double")) {
  const Placed from(RootRotation::support);
  const Var two = Var::constant(windows_of(from.data, double_context(), 2)), one = slice(two, 1, 0, 1);
  DirectObjective objective(double_context(), from.data.format, 8, 2);
  objective.add(0, {LoopConstraint{}}, from.anchor, from.seconds);
  objective.add(1, {}, from.anchor, from.seconds);
  objective.finish(double_context());
  CHECK(objective(two).item() == doctest::Approx(loss_of(from, {LoopConstraint{}}, one).item()));
  // Standing still costs a loop something, and moving as before nothing.
  DirectObjective lively(double_context(), from.data.format, 8, 1);
  lively.add(0, {LoopConstraint{}}, from.anchor, from.seconds);
  lively.finish(double_context());
  const double before = lively(one).item();
  lively.keep_moving(one);
  CHECK(lively(one).item() == doctest::Approx(before));
  CHECK(lively(affine(one, 0)).item() > 0.001);
}

TEST_CASE("paths have times, directions and distances") {
  const TimedPath path({{0, 0}, {0, 2}, {2, 2}}, 4);
  CHECK(path.length() == 4);
  CHECK_FALSE(path.timed());
  CHECK(path.at(1).z == doctest::Approx(1));
  CHECK(path.at(3).x == doctest::Approx(1));
  CHECK(path.at(3).along_x == doctest::Approx(1));
  CHECK(path.distance(-1, 1) == doctest::Approx(1));
  CHECK(path.distance(3, 2) == doctest::Approx(1));
  CHECK(path.start().yaw == doctest::Approx(0));
  const TimedPath later({{0, 0, 1.0}, {3, 0, 2.0}}, 4);
  CHECK(later.timed());
  CHECK(later.start().x == doctest::Approx(-3));
  CHECK(later.start().yaw == doctest::Approx(motion::pi / 2));
  CHECK_THROWS_WITH_AS(TimedPath({{0, 0}}, 1), doctest::Contains("expected at least 2"), Error);
  CHECK_THROWS_WITH_AS(TimedPath({{1, 0}, {1, 0}}, 1), doctest::Contains("in one place"), Error);
  CHECK_THROWS_WITH_AS(TimedPath({{0, 0, 2.0}, {1, 0, 1.0}}, 4), doctest::Contains("expected more than"),
                       Error);
  CHECK_THROWS_WITH_AS(TimedPath({{0, 0, 0.0}, {1, 0, 5.0}}, 4), doctest::Contains("from 0 to 4 s"), Error);
}

}  // namespace objective_test
