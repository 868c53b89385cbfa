// Directed motion by class-conditioned models.
#include "motiongan/direct/action_direct.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "../support/check_grads.hpp"
#include "../support/small_actions.hpp"
#include "motiongan/direct/pace.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "motiongan/train/saved_critic.hpp"

namespace action_direct_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Vec3;

namespace {

const Context& context() {
  static const Context made;
  return made;
}

const motion::PositionFormat& format() { return small_actions().format; }

/// A model of random weights.
ActionGan model_of(std::size_t noise_dim, ActionGenerator kind = ActionGenerator::attention) {
  const bool exact = kind == ActionGenerator::attention;
  return {context(),
          format(),
          {.generator = kind,
           .hidden = 16,
           .noise_dim = noise_dim,
           .continues = exact,
           .exact_bones = exact,
           .seed = 3}};
}

ActionPrior prior(std::size_t clip = 1) { return small_actions().prior(small_actions().train[clip], 4); }

double leg() { return motion::body_unit(format().skeleton()); }

/// A real second as the objective sees it, and the same in the world.
struct Placed {
  motion::ActionDataset const& data = small_actions();
  ActionPrior own = prior();
  std::vector<WorldPose> poses = world_poses(format().layout, own.positions);
  motion::Motion motion =
      motion::motion_from_positions({"own", own.skeleton, format().rate, 6, own.positions});
  motion::RootTrack anchor{poses[0].x, poses[0].z, poses[0].yaw, true};
  double seconds = 5 / format().rate;

  std::vector<Constraint> met() const {
    const std::size_t foot = motion::find_feet(own.skeleton).front();
    const double rate = format().rate;
    std::vector<PathPoint> points;
    for (std::size_t f = 0; f < 6; ++f)
      points.push_back({poses[f].x, poses[f].z, static_cast<double>(f) / rate, poses[f].yaw});
    return {
        PoseConstraint{.time = 3 / rate, .pose = slice(motion, 3, 2)},
        PoseConstraint{.time = 3 / rate, .pose = slice(motion, 3, 1), .joints = {1, foot}, .placed = true},
        JointConstraint{.joint = foot, .from = 5 / rate, .to = 5 / rate, .position = poses[5].joint(foot)},
        PathConstraint{.points = points}};
  }
};

Var loss_of(const Placed& from, const std::vector<Constraint>& constraints, const Var& motion) {
  DirectObjective objective(double_context(), format(), motion.dim(0), motion.dim(1));
  for (std::size_t b = 0; b < motion.dim(1); ++b) objective.add(b, constraints, from.anchor, from.seconds);
  objective.finish(double_context());
  return objective(motion);
}

std::vector<ConstraintError> errors_of(const std::vector<Vec3>& positions, const motion::Skeleton& skeleton,
                                       const std::vector<Constraint>& constraints) {
  return constraint_errors(
      format(), {"", skeleton, format().rate, positions.size() / skeleton.size(), positions}, constraints);
}

double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, motion::length(motion::subtract(a[i], b[i])));
  return most;
}

}  // namespace

TEST_CASE("places in the world are those that the format decodes" * doctest::test_suite("double")) {
  const PlaceView view(double_context(), format());
  const std::size_t joints = format().skeleton().size(), dof = format().dof(), frames = 6;
  // What no real body does: turned against its track.
  const std::vector<double> noise = randn({frames, 1, dof}).values;
  std::vector<float> poses(noise.begin(), noise.end());
  const WorldRows seen = view(Var::constant(Tensor::from(double_context(), {frames, 1, dof}, poses)));
  motion::RootTrack track;
  const std::vector<WorldPose> made = world_poses(format().layout, format().decode(poses, &track));
  const auto host = [](const Var& v) { return v.value().to_host<double>(); };
  const std::vector<double> x = host(seen.x), y = host(seen.y), z = host(seen.z), bx = host(seen.body.x),
                            bz = host(seen.body.z), c = host(seen.cosine), s = host(seen.sine);
  for (std::size_t f = 0; f < frames; ++f) {
    const double yaw = made[f].yaw - made[0].yaw;
    CHECK(std::abs(c[f] - std::cos(yaw)) < 1e-6);
    CHECK(std::abs(s[f] - std::sin(yaw)) < 1e-6);
    for (std::size_t j = 0; j < joints; ++j) {
      Vec3 place = made[f].joint(j);
      place[0] -= made[0].x, place[2] -= made[0].z;
      motion::turn_ground(place[0], place[2], -made[0].yaw);
      const std::size_t at = j * frames + f;
      CHECK(motion::length(motion::subtract(place, Vec3{x[at], y[at], z[at]})) < 1e-4 * leg());
      CHECK(std::abs(bx[at] - made[f].body[j][0]) < 1e-4 * leg());
      CHECK(std::abs(bz[at] - made[f].body[j][2]) < 1e-4 * leg());
    }
  }
  CHECK(
      check_grads(
          double_context(),
          [&](const auto& v) {
            const WorldRows rows = view(v[0]);
            return concatenate({rows.x, rows.y, rows.z, rows.body.x, rows.body.z, rows.cosine, rows.sine}, 0);
          },
          {randn({3, 2, dof})}, 2) < 1e-6);
}

TEST_CASE("a motion of positions meets what is taken from it, and another does not" *
          doctest::test_suite("double")) {
  const Placed from;
  const Var own = Var::constant(Tensor::from(double_context(), {6, 1, format().dof()}, from.own.poses));
  const ActionPrior other = placed_at(prior(2), {from.anchor.x + leg(), from.anchor.z, 2, true});
  for (const Constraint& c : from.met()) {
    CAPTURE(c.index());
    CHECK(loss_of(from, {c}, own).item() < 1e-6);
    const ConstraintError error = errors_of(from.own.positions, from.own.skeleton, {c}).front();
    CHECK(error.worst < 1e-3 * leg());
    CHECK(error.met());
    CHECK(errors_of(other.positions, other.skeleton, {c}).front().excess() > 1);
  }
}

TEST_CASE("first and second derivatives of the constraints on positions" * doctest::test_suite("double")) {
  const Placed from;
  std::vector<Constraint> all = from.met();
  all.push_back(LoopConstraint{});
  all.push_back(ContactConstraint{.joint = 3, .from = 0.1, .to = 0.4});
  for (const Constraint& c : all) {
    CAPTURE(c.index());
    CHECK(check_grads(
              double_context(), [&](const auto& v) { return loss_of(from, {c}, v[0]); },
              {randn({6, 2, format().dof()})}, 2) < 1e-5);
  }
}

TEST_CASE("without anything to meet the motion is that of the schedule") {
  for (const std::size_t noise : {0u, 4u}) {
    ActionGan model = model_of(noise);
    const ActionSchedule schedule{{1, 9}, {0, 6}};
    const motion::PositionClip plain = model.generate({prior()}, schedule).front();
    const DirectedAction made = direct(model, {{.prior = prior()}}, schedule, {.starts = 1}).front();
    CHECK(made.met());
    CHECK(made.given == 6);
    CHECK(made.clip.frames == 6 + 15);
    CHECK(made.iterations == 0);
    CHECK(apart(plain.positions, made.clip.positions) < 2e-3 * leg());
  }
}

TEST_CASE("what the model makes of another noise is found again") {
  ActionGan model = model_of(8);
  const ActionSchedule schedule{{1, 30}};  // in two parts
  const motion::PositionClip wanted =
      model.generate({prior()}, schedule, {.with_prior = false, .first_sample = 77}).front();
  const std::size_t joints = wanted.skeleton.size();
  ActionDirectTask task{.prior = prior()};
  for (const std::size_t f : {11u, 29u})
    task.constraints.push_back(JointConstraint{.joint = 0,
                                               .from = static_cast<double>(f + 1) / format().rate,
                                               .to = static_cast<double>(f + 1) / format().rate,
                                               .position = wanted.positions[f * joints],
                                               .tolerance = 0.01 * leg()});
  const DirectedAction free = direct(model, {task}, schedule, {.starts = 1, .iterations = 1}).front();
  const DirectedAction made = direct(model, {task}, schedule, {.starts = 4, .stay = 0}).front();
  for (std::size_t i = 0; i < 2; ++i) {
    CAPTURE(free.errors[i].worst / leg());
    CHECK(made.errors[i].worst < 0.3 * free.errors[i].worst);
  }
}

TEST_CASE("directed classes: reruns give the same bits, and weights stay") {
  for (const ActionGenerator kind : {ActionGenerator::attention, ActionGenerator::lstm}) {
    ActionGan model = model_of(kind == ActionGenerator::attention ? 4 : 0, kind);
    const auto weights = values_in(model);
    const std::vector<ActionDirectTask> tasks(
        2,
        {.prior = prior(), .constraints = {LoopConstraint{}}, .start = motion::RootTrack{1, 2, 0.5, true}});
    const DirectOptions options{.starts = 2, .iterations = 10};
    const ActionSchedule schedule{{1, 27}};
    const auto once = direct(model, tasks, schedule, options),
               again = direct(model, tasks, schedule, options);
    for (std::size_t i = 0; i < 2; ++i) CHECK(once[i].clip.positions == again[i].clip.positions);
    CHECK(once[0].clip.positions != once[1].clip.positions);
    CHECK(values_in(model) == weights);
    const WorldPose last = world_poses(format().layout, once[0].clip.positions)[5];
    CHECK(last.x == doctest::Approx(1));
    CHECK(last.z == doctest::Approx(2));
    CHECK(last.yaw == doctest::Approx(0.5));
  }
}

TEST_CASE("exact corrections reach a hand and a path that the model does not") {
  ActionGan model = model_of(2);
  const motion::PositionClip own =
      model.generate({prior()}, ActionSchedule{{1, 12}}, {.with_prior = false}).front();
  const std::size_t joints = own.skeleton.size(), hand = find_joint(own.skeleton, "LeftHand");
  Vec3 at = own.positions[8 * joints + hand];
  at[1] += 0.3 * leg();
  const ActionDirectTask task{
      .prior = prior(),
      .constraints = {JointConstraint{.joint = hand, .from = 0.9, .to = 0.9, .position = at}}};
  DirectOptions options{.starts = 2, .iterations = 10};
  const DirectedAction plain = direct(model, {task}, ActionSchedule{{1, 12}}, options).front();
  CHECK_FALSE(plain.met());
  options.exact = true;
  const DirectedAction exact = direct(model, {task}, ActionSchedule{{1, 12}}, options).front();
  CHECK(exact.errors.front().worst < 1e-3 * leg());
  // The given second is left as it is.
  CHECK(std::equal(exact.clip.positions.begin(), exact.clip.positions.begin() + 6 * joints,
                   prior().positions.begin()));
}

TEST_CASE("what cannot be asked of a class-conditioned model is refused") {
  ActionGan model = model_of(2);
  const auto refused = [&](const Constraint& c, const char* part) {
    CHECK_THROWS_WITH_AS(direct(model, {{.prior = prior(), .constraints = {c}}}, ActionSchedule{{1, 12}}),
                         doctest::Contains(part), Error);
  };
  refused(JointConstraint{.joint = 1, .rotation = motion::Quat{}},
          "cannot be given for a model of positions");
  refused(LoopConstraint{.seconds = 9}, "outside of the motion, which is from 0 to 1.2 s");
  refused(PathConstraint{.points = {{0, 0}, {0, 1e5}}}, "leg lengths");
  motion::PositionFormat still = format();
  still.layout = motion::PositionLayout(format().skeleton(), false);
  CHECK_THROWS_WITH_AS(PlaceView(context(), still), doctest::Contains("without the root's track"), Error);
}

}  // namespace action_direct_test
