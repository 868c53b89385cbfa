// Directed motion by small models: what they make themselves is found again, reruns give the same bits, and
// what cannot be met is not claimed to be.
#include "motiongan/direct/direct.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <optional>

#include "../support/walking_data.hpp"
#include "motiongan/direct/between.hpp"
#include "motiongan/direct/pace.hpp"
#include "motiongan/train/saved_critic.hpp"

namespace direct_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Motion;
using motion::RootRotation;

namespace {

const Context& context() {
  static const Context made;
  return made;
}

/// A model of random weights whose motion is lively enough to be told apart.
Dvgan model_of(GeneratorKind kind, RootRotation form = RootRotation::support,
               std::optional<bool> final_cut = {}) {
  static std::map<RootRotation, motion::Dataset> data;
  if (!data.contains(form)) data.emplace(form, walking_data(form));
  return Dvgan(context(), data.at(form).format,
               {.generator = kind, .hidden = 16, .final_cut = final_cut, .seed = 3});
}

double leg(const Dvgan& model) { return motion::body_unit(model.format().skeleton()); }

Motion own(const Dvgan& model, std::size_t sample) {
  const Motion made = model.generate("walk", {.first_sample = sample}).front();
  return motion::placed_at(made, model.format().layout.root(), {}, true);
}

bool same(const Motion& a, const Motion& b) {
  const auto equal = [](const motion::Quat& p, const motion::Quat& q) {
    return p.w == q.w && p.x == q.x && p.y == q.y && p.z == q.z;
  };
  return a.frames == b.frames && a.positions == b.positions &&
         std::equal(a.rotations.begin(), a.rotations.end(), b.rotations.begin(), equal);
}

}  // namespace

TEST_CASE("a motion that the model made is found again by its poses") {
  for (const GeneratorKind kind : {GeneratorKind::cnn, GeneratorKind::rnn})
    for (const RootRotation form : {RootRotation::expmap, RootRotation::heading, RootRotation::support}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(static_cast<int>(form));
      Dvgan model = model_of(kind, form);
      const Motion wanted = own(model, 500);
      DirectTask task{.text = "walk"};
      for (const std::size_t f : {1u, 4u, 7u})
        task.constraints.push_back(PoseConstraint{.time = static_cast<double>(f) / model.format().rate,
                                                  .pose = slice(wanted, f, 1),
                                                  .placed = true,
                                                  .tolerance = 1e-3 * leg(model)});
      const auto before = constraint_errors(own(model, 0), model.format().layout.root(), task.constraints);
      const DirectedMotion made = direct(model, {task}, {.starts = 2, .iterations = 400, .stay = 0}).front();
      for (std::size_t i = 0; i < made.errors.size(); ++i)
        CHECK(made.errors[i].worst < 0.1 * before[i].worst);
      CHECK(made.motion.frames == model.format().frames);
    }
}

TEST_CASE("without anything to meet the motion is that of its noise, after the warm-up of an RNN") {
  for (const GeneratorKind kind : {GeneratorKind::cnn, GeneratorKind::rnn})
    for (const bool final_cut : {false, true}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(final_cut);
      Dvgan model = model_of(kind, RootRotation::support, final_cut);
      const DirectedMotion made = direct(model, {{.text = "walk"}}, {.starts = 1}).front();
      CHECK(made.met());
      CHECK(made.iterations == 0);
      const Motion plain = own(model, 0);
      for (std::size_t i = 0; i < plain.positions.size(); ++i)
        REQUIRE(motion::length(motion::subtract(plain.positions[i], made.motion.positions[i])) < 1e-4);
    }
}

TEST_CASE("reruns give the same bits, other seeds other motion, and weights stay") {
  for (const GeneratorKind kind : {GeneratorKind::cnn, GeneratorKind::rnn}) {
    Dvgan model = model_of(kind);
    const std::vector<float> weights = named_parameters(model).front().value->value().to_host();
    const Motion wanted = own(model, 7);
    const DirectTask task{
        .text = "walk",
        .constraints = {PoseConstraint{.time = 1, .pose = slice(wanted, 5, 1)}, LoopConstraint{}}};
    const DirectOptions options{.frames = 20, .starts = 2, .iterations = 20};
    const std::vector<DirectedMotion> once = direct(model, {task, task}, options),
                                      again = direct(model, {task, task}, options);
    for (std::size_t i = 0; i < 2; ++i) CHECK(same(once[i].motion, again[i].motion));
    CHECK_FALSE(same(once[0].motion, once[1].motion));  // their noises differ
    DirectOptions other = options;
    other.seed = 2;
    CHECK_FALSE(same(direct(model, {task}, other).front().motion, once[0].motion));
    CHECK(named_parameters(model).front().value->value().to_host() == weights);
    CHECK(once[0].motion.frames == 20);
  }
}

TEST_CASE("the straight way turns evenly from one pose to the other") {
  Dvgan model = model_of(GeneratorKind::cnn);
  const Motion made = own(model, 0), from = slice(made, 0, 1), to = slice(made, 5, 1),
               way = straight_way(from, to, 3);
  REQUIRE(way.frames == 3);
  for (std::size_t j = 0; j < made.skeleton.size(); ++j) {
    const double all = motion::angle_between(from.rotation(0, j), to.rotation(0, j));
    for (std::size_t f = 0; f < 3; ++f)
      CHECK(motion::angle_between(from.rotation(0, j), way.rotation(f, j)) ==
            doctest::Approx(all * static_cast<double>(f + 1) / 4).epsilon(1e-6));
  }
  const motion::Vec3 middle = motion::scale(motion::add(from.position(0, 0), to.position(0, 0)), 0.5);
  CHECK(motion::length(motion::subtract(way.position(1, 0), middle)) < 1e-9 * leg(model));
}

TEST_CASE("what cannot be met reports its error; exact corrections meet it") {
  Dvgan model = model_of(GeneratorKind::cnn);
  // The hand is where no arm gets to, but not too far for the check.
  const WorldPose start = world_pose(own(model, 0), 0, 0);
  const auto hand = model.format().skeleton().size() - 1;
  motion::Vec3 at = start.joint(hand);
  at[1] += 3 * leg(model);
  const DirectTask task{
      .text = "walk",
      .constraints = {JointConstraint{.joint = hand, .from = 0.6, .to = 0.6, .position = at}}};
  DirectOptions options{.starts = 2, .iterations = 20};
  const DirectedMotion made = direct(model, {task}, options).front();
  CHECK_FALSE(made.met());
  CHECK(made.errors.front().worst > leg(model));
  CHECK(made.iterations == 20);
  options.exact = true;
  CHECK(direct(model, {task}, options).front().errors.front().worst < 1e-3 * leg(model));
}

TEST_CASE("progress is reported, a stop is obeyed, and a score chooses among what is met") {
  Dvgan model = model_of(GeneratorKind::cnn);
  std::size_t reports = 0, windows = 0;
  DirectOptions options{.frames = 20, .starts = 4, .iterations = 30};
  options.report = [&](const DirectProgress& p) {
    ++reports, windows = p.windows;
    CHECK(p.iteration <= 30);
  };
  const DirectTask loop{.text = "walk", .constraints = {LoopConstraint{.tolerance = 1e-9}}};
  direct(model, {loop}, options);
  CHECK(windows == 3);  // of 8 frames that overlap by 2
  CHECK(reports >= windows);
  options.should_stop = [] { return true; };
  const DirectedMotion stopped = direct(model, {loop}, options).front();
  CHECK(stopped.iterations == 0);
  CHECK(stopped.motion.frames == 20);
  // A score that likes the last start best.
  const DirectTask free{.text = "walk"};
  const auto chosen = [&](double sign) {
    DirectOptions choosing{.starts = 4};
    choosing.score = [sign](const Var& motion, const Sentences& text) {
      CHECK(motion.dim(1) == text.batch);
      std::vector<float> out;
      for (std::size_t i = 0; i < text.batch; ++i)
        out.push_back(static_cast<float>(sign * static_cast<double>(i)));
      return out;
    };
    return direct(model, {free}, choosing).front().motion;
  };
  CHECK_FALSE(same(chosen(1), chosen(-1)));
}

TEST_CASE("gaps are filled, and the clips on both sides stay as they are") {
  for (const GeneratorKind kind : {GeneratorKind::cnn, GeneratorKind::rnn})
    for (const bool placed : {true, false}) {
      CAPTURE(static_cast<int>(kind));
      CAPTURE(placed);
      Dvgan model = model_of(kind);
      const Motion before = own(model, 1);
      Motion after = own(model, 2);
      for (std::size_t f = 0; f < after.frames; ++f) after.position(f, 0)[0] += 0.2 * leg(model);
      const Gap gap{.text = "walk", .before = before, .after = after, .seconds = 0.8, .placed = placed};
      for (const double seconds : {0.8, 3.0}) {
        Gap wide = gap;
        wide.seconds = seconds;
        const InBetween made = fill_gaps(model, {wide}, {.starts = 2, .iterations = 20}).front();
        const auto between = static_cast<std::size_t>(std::lround(seconds * 5)) - 1;
        REQUIRE(made.count == between);
        REQUIRE(made.motion.frames == before.frames + between + after.frames);
        CHECK(same(slice(made.motion, 0, before.frames), before));
        const Motion end = slice(made.motion, made.first + made.count, after.frames);
        if (placed) CHECK(same(end, after));
        // The same poses, wherever they are.
        for (std::size_t f = 0; f < after.frames; ++f) {
          const WorldPose a = world_pose(end, f, 0), b = world_pose(after, f, 0);
          for (std::size_t j = 0; j < a.body.size(); ++j)
            REQUIRE(motion::length(motion::subtract(a.body[j], b.body[j])) < 1e-6);
        }
      }
    }
  Dvgan model = model_of(GeneratorKind::cnn);
  CHECK_THROWS_WITH_AS(
      fill_gaps(model, {{.text = "walk", .before = own(model, 1), .after = own(model, 2), .seconds = 0.2}},
                {}),
      doctest::Contains("has no frames between"), Error);
}

TEST_CASE("mistakes are named before any work") {
  Dvgan model = model_of(GeneratorKind::cnn);
  const auto refused = [&](Constraint c, const char* message) {
    CHECK_THROWS_WITH_AS(direct(model, {{.text = "walk", .constraints = {std::move(c)}}}),
                         doctest::Contains(message), Error);
  };
  refused(PoseConstraint{.time = 5, .pose = slice(own(model, 0), 0, 1)}, "outside of the motion");
  refused(PoseConstraint{.time = 1}, "has no frames");
  refused(JointConstraint{.joint = 99, .position = motion::Vec3{}}, "not one of the skeleton's");
  refused(JointConstraint{.joint = 1}, "neither a position nor a rotation");
  refused(JointConstraint{.joint = 1, .from = 0.2, .to = 0.2, .position = motion::Vec3{1e4, 0, 0}},
          "the fastest of the training motion");
  refused(PathConstraint{.points = {{0, 0}, {1e5, 0}}}, "the fastest of the training motion");
  refused(LoopConstraint{.seconds = 0.2}, "shorter than two frames");
  refused(ContactConstraint{.joint = 1, .from = 0.2, .to = 0.2}, "less than a frame");
  refused(ContactConstraint{.joint = 1, .from = 0.4, .to = 0.2}, "before it begins");
  CHECK_THROWS_WITH_AS(direct(model, {{.text = "walk",
                                       .constraints = {PathConstraint{.points = {{0, 0}, {0, 0.1}}},
                                                       PathConstraint{.points = {{0, 0}, {0.1, 0}}}}}}),
                       doctest::Contains("follows one path, found 2"), Error);
  CHECK_THROWS_WITH_AS(find_joint(model.format().skeleton(), "no such joint"), doctest::Contains("nearest: "),
                       Error);
  const std::string first = model.format().skeleton().joints.front().name;
  CHECK(find_joint(model.format().skeleton(), first) == 0);
  CHECK(fastest(model.format()).value() > 0);
  CHECK(frames_for_way(model, "walk", 10 * leg(model)) > 5);
}

TEST_CASE("the critic of a run scores as the trainer's does") {
  const motion::Dataset data = walking_data(RootRotation::support);
  Dvgan model(context(), data.format, {.hidden = 16});
  DvganTrainer trainer(
      model, data, {.iterations = 2, .critic_steps = 1, .batch = 2, .critic = {.sees = CriticSees::both}});
  trainer.iterate();
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / "motiongan_saved_critic.safetensors";
  checkpoint_of(trainer).write(file);
  const SavedCritic critic(model, file);
  const Var motion = Var::constant(windows_of(data, context(), 2));
  const Sentences text(context(), {{1}, {1}}, data.format.vocabulary.size());
  const CriticView view(context(), data.format, CriticSees::both);
  const std::vector<float> expected =
      trainer.critic()(view(motion), trainer.critic().encode_text(text)).value().to_host();
  CHECK(critic(motion, text) == expected);
  std::filesystem::remove(file);
}

}  // namespace direct_test
