// ActionStream: characters are independent of each other.
#include <doctest/doctest.h>

#include <motiongan/procedural/procedural.hpp>
#include <motiongan/sample/action_generate.hpp>

#include "../support/messages.hpp"

namespace action_stream_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::ActionDataset;
using motion::PositionClip;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

ActionDataset make_data(bool root) {
  auto motions = motion::procedural_motions({.clips = 17, .seconds = 4, .rate = 20});
  for (auto& m : motions) m.captions = {m.id.substr(0, m.id.find('_'))};
  return ActionDataset::from_motions(
      motions,
      {.frames = 8, .rate = 10, .root_track = root, .train_share = 1, .classes = {"walk", "run", "jump"}});
}
const ActionDataset& data(bool root = true) {
  static const ActionDataset with = make_data(true), without = make_data(false);
  return root ? with : without;
}

ActionGan make_model(const ActionGanOptions& options = {.hidden = 8}, bool root = true) {
  ActionGan model(context(), data(root).format, options);
  for (const NamedParameter& p : named_parameters(model))
    if (p.name == "attention.gamma") p.value->node()->value.write(std::span<const float>({0.7f}));
  return model;
}

ActionPrior prior(std::size_t clip, std::size_t frame = 0, bool root = true) {
  const ActionDataset& d = data(root);
  return d.prior(d.train[clip], frame);
}

std::vector<float> stepped(const ActionStream& stream, ActionStream::Id id) {
  const auto poses = stream.poses(id);
  return {poses.begin(), poses.end()};
}

double apart(const motion::Vec3& a, const motion::Vec3& b) { return motion::length(motion::subtract(a, b)); }

const std::vector<ActionGanOptions> kinds{
    {.hidden = 8},
    {.hidden = 8, .noise_dim = 3},
    {.generator = ActionGenerator::lstm, .hidden = 8},
};

}  // namespace

TEST_CASE("a prior has the clip's own poses, from any frame") {
  const ActionDataset& d = data();
  const motion::ActionClip& clip = d.train.front();
  const PositionClip positions = d.clip(clip);
  for (const std::size_t frame : {0, 5}) {
    const ActionPrior p = prior_from(positions, d.format, frame);
    REQUIRE(p.poses.size() == 8 * d.format.dof());
    for (std::size_t i = 0; i < p.poses.size(); ++i)
      CHECK(p.poses[i] == doctest::Approx(clip.poses[frame * d.format.dof() + i]).epsilon(1e-3).scale(1));
    CHECK(p.places.back().x == doctest::Approx(clip.places[frame + 7].x));
    CHECK(apart(p.positions[3], positions.positions[frame * d.format.skeleton().size() + 3]) == 0);
  }
  PositionClip twice = motion::resample(positions, 20);
  CHECK(prior_from(twice, d.format, 5).positions.size() == 8 * d.format.skeleton().size());
  CHECK_THROWS_WITH_AS(prior_from(positions, d.format, clip.frames - 7),
                       doctest::Contains("has 7 frames (0.70 s) from frame"), Error);
  CHECK_THROWS_WITH_AS(prior_from(positions, d.format, 10000),
                       doctest::Contains("8 frames (0.80 s) are needed"), Error);
  twice.skeleton.joints[2].name = "Tail";
  CHECK_THROWS_WITH_AS(prior_from(twice, d.format), doctest::Contains("Tail"), Error);
}

TEST_CASE("a character moves as it would alone while others are added and removed") {
  for (const ActionGanOptions& kind : kinds) {
    const ActionGan model = make_model(kind);
    std::vector<ActionPrior> priors;
    for (std::size_t i = 0; i < data().train.size(); ++i) priors.push_back(prior(i));
    // Alone: two steps of walk, one of jump, half a step of run, then more.
    const auto run = [&](ActionStream& stream, ActionStream::Id id, std::size_t step) {
      if (step == 2) stream.set_class(id, "jump");
      if (step == 3) stream.set_class(id, "run");
      stream.step(step == 3 ? 5 : 0);
      return stepped(stream, id);
    };
    const ActionCharacterOptions mine{.prior = &priors[0], .label = 2, .sample = 9};
    ActionStream alone(model);
    const auto id = alone.add(mine);
    std::vector<std::vector<float>> expected;
    std::vector<PositionClip> places;
    for (std::size_t step = 0; step < 5; ++step) {
      expected.push_back(run(alone, id, step));
      places.push_back(alone.clip(id));
    }
    CHECK(places[3].frames == 5);
    for (const std::size_t at_once : {256u, 2u}) {
      ActionStream crowd(model, at_once);
      const auto before = crowd.add({.prior = &priors[1], .label = 0, .sample = 1});
      const auto me = crowd.add(mine);
      const auto after = crowd.add({.prior = &priors[1], .label = 1, .sample = 2});
      for (std::size_t step = 0; step < 5; ++step) {
        if (step == 1) crowd.add({.prior = &priors[2], .label = 1, .sample = 3});
        if (step == 2) crowd.remove(before);
        if (step == 4) crowd.remove(after);
        CHECK(run(crowd, me, step) == expected[step]);
        CHECK(crowd.clip(me).positions == places[step].positions);
      }
      CHECK(crowd.size() == 2);
      CHECK_THROWS_WITH_AS(crowd.poses(after), doctest::Contains("no character"), Error);
    }
  }
}

TEST_CASE("the first second is the model's and depends on noise and class") {
  const ActionPrior p = prior(0);
  for (const ActionGanOptions& kind : kinds) {
    const ActionGan model = make_model(kind);
    ActionStream stream(model);
    const auto a = stream.add({.prior = &p, .label = 0, .seed = 5, .sample = 3});
    const auto other_class = stream.add({.prior = &p, .label = 1, .seed = 5, .sample = 3});
    const auto other_sample = stream.add({.prior = &p, .label = 0, .seed = 5, .sample = 4});
    stream.step();
    CHECK(stepped(stream, a) != stepped(stream, other_class));
    CHECK((stepped(stream, a) != stepped(stream, other_sample)) == (kind.noise_dim > 0));
    const NoGrad values_only;
    const Var made = model.forward(
        Var::constant(Tensor::from(context(), {8, 1, data().format.dof()}, p.poses)),
        Var::constant(one_hot(context(), std::vector<std::size_t>{0}, 3)), {.seed = 5, .first_sample = 3});
    const std::vector<float> expected = made.value().to_host(), got = stepped(stream, a);
    for (std::size_t i = 0; i < got.size(); ++i)
      CHECK(got[i] == doctest::Approx(expected[i]).epsilon(1e-4).scale(1));
  }
}

TEST_CASE("the root continues from the end of the prior, or stays there") {
  for (const bool root : {true, false}) {
    const ActionGan model = make_model({.hidden = 8}, root);
    ActionPrior p = prior(0, 4, root);
    p.places.back().x += 1000;
    ActionStream stream(model);
    const auto id = stream.add({.prior = &p, .label = 0});
    CHECK_THROWS_WITH_AS(stream.clip(id), doctest::Contains("call step()"), Error);
    for (int i = 0; i < 3; ++i) {
      const motion::RootTrack at = stream.track(id);
      stream.step();
      const PositionClip clip = stream.clip(id);
      const std::size_t joints = clip.skeleton.size();
      const double step = std::hypot(clip.positions[0][0] - at.x, clip.positions[0][2] - at.z);
      if (root)
        CHECK(step < 200);  // cm: 20 m/s
      else
        CHECK(step == 0);
      CHECK(stream.track(id).x == doctest::Approx(clip.positions[7 * joints][0]));
      CHECK(stream.track(id).height == doctest::Approx(clip.positions[7 * joints][1]));
    }
  }
}

TEST_CASE("invalid priors, classes and steps are rejected") {
  const ActionGan model = make_model();
  ActionStream stream(model);
  const ActionPrior p = prior(0);
  ActionPrior cut = p;
  cut.poses.resize(3);
  CHECK_THROWS_WITH_AS(stream.add({.prior = nullptr}), doctest::Contains("needs a prior"), Error);
  CHECK_THROWS_WITH_AS(stream.add({.prior = &cut}), doctest::Contains("expected 8 frames"), Error);
  CHECK_THROWS_WITH_AS(stream.add({.prior = &p, .label = 3}), doctest::Contains("class number 3"), Error);
  const auto id = stream.add({.prior = &p});
  CHECK_THROWS_WITH_AS(stream.set_class(id, "wlak"), doctest::Contains("did you mean 'walk'?"), Error);
  CHECK_THROWS_WITH_AS(stream.step(9), doctest::Contains("at most 8"), Error);
  CHECK(stream.class_of(id) == "jump");
  CHECK_THROWS_AS(stream.remove(id + 1), Error);
}

}  // namespace action_stream_test
