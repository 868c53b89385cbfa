// CharacterStream: the characters of MotionStream and ActionStream, frame by frame.
#include <doctest/doctest.h>

#include <array>
#include <motiongan/procedural/procedural.hpp>
#include <motiongan/sample/character_stream.hpp>

#include "../support/messages.hpp"

namespace character_stream_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Motion;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

const std::vector<motion::LabelledMotion>& clips() {
  static const auto all = motion::procedural_motions({.clips = 17, .seconds = 4, .rate = 20});
  return all;
}
const Motion& clip(std::size_t i) { return clips()[i].motion; }

const Dvgan& texts() {
  static const Dvgan model(
      context(),
      motion::Dataset::from_motions(clips(),
                                    {.frames = 8, .rate = 5, .root_rotation = motion::RootRotation::velocity})
          .format,
      {.generator = GeneratorKind::rnn, .hidden = 8});
  return model;
}

constexpr std::size_t second = 8;  // T of the models of classes

ActionGan make_actions() {
  auto motions = clips();
  for (auto& m : motions) m.captions = {m.id.substr(0, m.id.find('_'))};
  return ActionGan(
      context(),
      motion::ActionDataset::from_motions(
          motions, {.frames = second, .rate = 10, .train_share = 1, .classes = {"walk", "run", "jump"}})
          .format,
      {.hidden = 8, .noise_dim = 3});
}
const ActionGan& actions() {
  static const ActionGan model = make_actions();
  return model;
}

/// The last second of a clip as a model of classes continues it, and its last rotations.
ActionPrior prior_of(const Motion& motion, std::vector<motion::Quat>& reference) {
  const Motion at_rate = motion::resample_to_end(motion, 10);
  const motion::PositionClip positions = motion::clip_for(at_rate, actions().format(), "clip");
  reference.assign(at_rate.rotations.end() - static_cast<std::ptrdiff_t>(at_rate.skeleton.size()),
                   at_rate.rotations.end());
  return prior_from(positions, actions().format(), positions.frames - second);
}

bool same(const Motion& a, const Motion& b) {
  return a.skeleton == b.skeleton && a.rate == b.rate && a.frames == b.frames && a.rotations == b.rotations &&
         a.positions == b.positions;
}

/// Whether two frames are the same, up to the sign of quaternions.
bool alike(const Motion& a, const Motion& b) {
  for (std::size_t j = 0; j < a.rotations.size(); ++j) {
    const motion::Quat &q = a.rotations[j], &r = b.rotations[j];
    if (q != r && q != motion::Quat{-r.w, -r.x, -r.y, -r.z}) return false;
  }
  return a.skeleton == b.skeleton && a.positions == b.positions && a.frames == b.frames;
}

}  // namespace

TEST_CASE("characters of a model of texts are those of MotionStream") {
  MotionStream expected(texts());
  CharacterStream stream(texts());
  CHECK_FALSE(stream.has_classes());
  CHECK(stream.rate() == 5);
  CHECK(stream.skeleton() == expected.skeleton());
  // The stream inside adds those with shorter priors first.
  const std::array<CharacterStart, 2> both{
      CharacterStart{.prompt = "jump", .sample = 2, .prior = &clip(1)},
      CharacterStart{.prompt = "walk", .seed = 5, .at = motion::RootTrack{30, -7, 1}}};
  const std::vector<CharacterStream::Id> ids = stream.add(both);
  const std::vector<CharacterId> others = expected.add(
      {{.text = "jump", .sample = 2, .prior = &clip(1)}, {.text = "walk", .seed = 5, .at = {30, -7, 1}}});
  CHECK(stream.ids() == ids);
  CharacterStream::Id third = 0;
  CharacterId other_third = 0;
  for (int frame = 0; frame < 12; ++frame) {
    if (frame == 3) third = stream.add({.prompt = "run"}), other_third = expected.add({.text = "run"});
    if (frame == 5) stream.set_prompt(ids[1], "wave"), expected.set_text(others[1], "wave");
    if (frame == 8) stream.remove(ids[0]), expected.remove(others[0]);
    stream.step();
    expected.step();
    CHECK(same(stream.motion(ids[1]), expected.motion(others[1])));
    if (frame < 8) CHECK(same(stream.motion(ids[0]), expected.motion(others[0])));
    if (frame >= 3) CHECK(same(stream.motion(third), expected.motion(other_third)));
    CHECK(stream.frames_left(ids[1]) == 0);
  }
  CHECK(stream.ids() == std::vector{ids[1], third});
  CHECK(stream.contains(third));
  CHECK_FALSE(stream.contains(ids[0]));
}

TEST_CASE("frames are read as rotations, positions and world positions") {
  const auto check = [](CharacterStream& stream, CharacterStream::Id id) {
    for (std::size_t frame = 0; frame < second + 2; ++frame) {
      stream.step();
      const Motion made = stream.motion(id);
      CHECK(std::ranges::equal(stream.rotations(id), made.rotations));
      CHECK(std::ranges::equal(stream.positions(id), made.positions));
      CHECK(std::ranges::equal(stream.global_positions(id), motion::joint_positions(made)));
    }
  };
  CharacterStream speaking(texts()), acting(actions());
  check(speaking, speaking.add({.prompt = "walk"}));
  check(acting, acting.add({.prompt = "walk", .prior = &clip(0)}));
}

TEST_CASE("characters of a model of classes are those of ActionStream, each at a frame of its own second") {
  std::vector<motion::Quat> references[2];
  const ActionPrior priors[] = {prior_of(clip(0), references[0]), prior_of(clip(1), references[1])};
  /// What a character alone gets by its seconds; it changes its class before second 2.
  const auto expected = [&](std::size_t which, std::size_t label, std::size_t then) {
    ActionStream alone(actions());
    const auto id = alone.add(
        {.prior = &priors[which], .label = label, .seed = 4, .sample = static_cast<unsigned>(which)});
    Motion all;
    for (int i = 0; i < 4; ++i) {
      if (i == 2) alone.set_class(id, then);
      alone.step();
      const Motion made = motion::motion_from_positions(alone.clip(id), references[which]);
      all = i == 0 ? made : motion::join(all, made);
    }
    return all;
  };
  const Motion first = expected(0, 2, 1), other = expected(1, 0, 0);
  CHECK_FALSE(alike(motion::slice(expected(0, 2, 2), 2 * second, 1), motion::slice(first, 2 * second, 1)));

  CharacterStream stream(actions());
  CHECK(stream.has_classes());
  CHECK(stream.rate() == 10);
  const auto a = stream.add({.prompt = "walk", .seed = 4, .sample = 0, .prior = &clip(0)});
  CharacterStream::Id b = 0, guest = 0;
  Motion before;
  for (std::size_t frame = 0; frame < 3 * second; ++frame) {
    if (frame == 3) b = stream.add({.prompt = "jump", .seed = 4, .sample = 1, .prior = &clip(1)});
    if (frame == 5) guest = stream.add({.prompt = "run", .prior = &clip(2)});
    if (frame == 11) stream.remove(guest);
    if (frame == second + 2) stream.set_prompt(a, "run");  // from the third second
    stream.step();
    CAPTURE(frame);
    CHECK(stream.frames_left(a) == second - 1 - frame % second);
    const Motion made = stream.motion(a);
    CHECK(alike(made, motion::slice(first, frame, 1)));
    if (frame >= 3) CHECK(alike(stream.motion(b), motion::slice(other, frame - 3, 1)));
    for (std::size_t j = 0; frame > 0 && j < made.skeleton.size(); ++j)
      CHECK(dot(before.rotation(0, j), made.rotation(0, j)) >= 0);
    before = made;
  }
}

TEST_CASE("quaternions keep their sign while a character of a model of classes turns round") {
  std::vector<motion::Quat> reference;
  prior_of(clip(0), reference);
  CharacterStream stream(actions());
  const auto id = stream.add({.prompt = "walk", .prior = &clip(0)});
  Motion before;
  bool turned = false;  // a second that begins in the other half, where motion_from_positions() never begins
  for (std::size_t frame = 0; frame < 4000 && !turned; ++frame) {
    stream.step();
    const Motion made = stream.motion(id);
    for (std::size_t j = 0; frame > 0 && j < made.skeleton.size(); ++j)
      CHECK(dot(before.rotation(0, j), made.rotation(0, j)) >= 0);
    turned = frame % second == 0 && dot(made.rotation(0, 0), reference[0]) < -0.1;
    before = made;
  }
  CHECK(turned);
}

TEST_CASE("characters with a prior start where they are told") {
  const motion::RootTrack at{300, -70, 0.5};
  std::vector<motion::Quat> reference;
  const motion::RootTrack facing = prior_of(clip(0), reference).places.back();
  CharacterStream speaking(texts()), acting(actions());
  for (CharacterStream* const stream : {&speaking, &acting}) {
    const auto own = stream->add({.prompt = "walk", .prior = &clip(0)});
    const auto moved = stream->add({.prompt = "walk", .prior = &clip(0), .at = at});
    stream->step();
    const motion::Vec3 last = clip(0).position(clip(0).frames - 1, 0), from = stream->positions(own)[0],
                       to = stream->positions(moved)[0];
    const double turn =
        at.yaw - (stream->has_classes()
                      ? facing.yaw
                      : motion::heading_from_quat(clip(0).rotation(clip(0).frames - 1, 0))[1]);
    double x = from[0] - last[0], z = from[2] - last[2];
    motion::turn_ground(x, z, turn);
    CHECK(to[0] - at.x == doctest::Approx(x).epsilon(1e-3).scale(1));
    CHECK(to[2] - at.z == doctest::Approx(z).epsilon(1e-3).scale(1));
    CHECK(to[1] == doctest::Approx(from[1]).epsilon(1e-4));
  }
}

TEST_CASE("without a prior characters continue the seconds that their model keeps") {
  ActionGan model = make_actions();
  std::vector<ActionStart> starts(3);
  for (std::size_t i = 0; i < 3; ++i) {
    starts[i].label = model.format().class_index(i == 2 ? "run" : "walk");
    starts[i].prior = prior_of(clip(i), starts[i].rotations);
  }
  model.set_starts(starts);
  CharacterStream stream(model);
  ActionStream inner(model);
  // Two of a walk in turn, one of a run; a jump has none and takes any.
  for (const auto& [prompt, sample, from] :
       {std::tuple{"walk", 0u, 0u}, {"walk", 1u, 1u}, {"walk", 2u, 0u}, {"run", 5u, 2u}, {"jump", 1u, 1u}}) {
    const auto id = stream.add({.prompt = prompt, .seed = 4, .sample = sample});
    const auto expected = inner.add({.prior = &starts[from].prior,
                                     .label = model.format().class_index(prompt),
                                     .seed = 4,
                                     .sample = sample});
    stream.step();
    inner.step();
    const Motion whole = motion::motion_from_positions(inner.clip(expected), starts[from].rotations);
    CHECK(alike(stream.motion(id), motion::slice(whole, 0, 1)));
    stream.remove(id);
    inner.remove(expected);
  }
}

TEST_CASE("invalid calls are rejected and change nothing") {
  CharacterStream stream(actions()), speaking(texts());
  const Motion short_clip = motion::slice(clip(0), 0, 10);
  Motion tailed = clip(0);
  tailed.skeleton.joints[2].name = "Tail";
  const auto refused = [&](const CharacterStart& start) {
    const std::array<CharacterStart, 2> two{CharacterStart{.prompt = "walk", .prior = &clip(0)}, start};
    return message_of([&] { stream.add(two); });
  };
  CHECK(says(refused({.prompt = "walk"}), "needs a prior: 8 frames at 10 per second"));
  CHECK(says(refused({.prompt = "wlak", .prior = &clip(0)}), "did you mean 'walk'?"));
  CHECK(says(refused({.prompt = "walk", .prior = &short_clip}), "5 frames at 10 per second"));
  CHECK(says(refused({.prompt = "walk", .prior = &tailed}), "'Tail'"));
  CHECK(stream.size() == 0);
  const auto id = stream.add({.prompt = "walk", .prior = &clip(0)});
  CHECK(stream.frames_left(id) == 0);
  CHECK(says(message_of([&] { stream.rotations(id); }), "has not moved"));
  CHECK(says(message_of([&] { stream.positions(id); }), "has not moved"));
  CHECK(says(message_of([&] { stream.global_positions(id); }), "has not moved"));
  CHECK(says(message_of([&] { stream.motion(id + 1); }), "there is no character 1"));
  CHECK(says(message_of([&] { stream.remove(id + 1); }), "there is no character 1"));
  CHECK(says(message_of([&] { stream.set_prompt(id, "fly"); }), "there is no class 'fly'"));
  CHECK(says(message_of([&] { speaking.add({.prompt = "."}); }), "has no words"));
  CHECK(
      says(message_of([&] { speaking.add({.prompt = "walk", .prior = &tailed, .at = motion::RootTrack{}}); }),
           "'Tail'"));
  CHECK(speaking.size() == 0);
  speaking.step();
  const Dvgan cnn(context(), texts().format(), {.hidden = 8});
  CHECK(says(message_of([&] { CharacterStream refuses(cnn); }), "--generator rnn"));
  const std::vector<ActionStream::Id> twice{0, 0};
  ActionStream inner(actions());
  std::vector<motion::Quat> reference;
  const ActionPrior prior = prior_of(clip(0), reference);
  inner.add({.prior = &prior});
  CHECK(says(message_of([&] { inner.step(twice); }), "twice"));
  CHECK_THROWS_AS(inner.poses(0), Error);
}

}  // namespace character_stream_test
