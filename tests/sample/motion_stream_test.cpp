// MotionStream: the model's motion, placed in the world.
#include <doctest/doctest.h>

#include <motiongan/sample/motion_stream.hpp>

#include "../support/small_data.hpp"

namespace motion_stream_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Motion;
using motion::RootRotation;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

/// Clips with arbitrary positions and headings, as recorded.
std::vector<motion::LabelledMotion> clips() {
  auto all = motion::procedural_motions({.clips = 6, .seconds = 6, .rate = 8, .seed = 3});
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i].motion = motion::placed_at(all[i].motion, 0, {100, -40, 2.0 + static_cast<double>(i)}, true);
  return all;
}

Dvgan make_model(RootRotation form, bool position = true) {
  const auto data = motion::Dataset::from_motions(
      clips(), {.frames = 8, .rate = 4, .root_position = position, .root_rotation = form});
  return Dvgan(context(), data.format, {.generator = GeneratorKind::rnn, .hidden = 8});
}

const Dvgan& model() {
  static const Dvgan m = make_model(RootRotation::velocity);
  return m;
}

/// The root's position, in the prior's unit, and the angle between two frames' rotations over all joints.
double ground_step(const Motion& m, std::size_t a, std::size_t b) {
  return motion::length(motion::subtract(m.position(b, 0), m.position(a, 0)));
}
double largest_turn(const Motion& m, std::size_t a, std::size_t b) {
  double largest = 0;
  for (std::size_t j = 0; j < m.skeleton.size(); ++j)
    largest = std::max(largest, motion::length(motion::expmap_from_quat(
                                    motion::multiply(motion::inverse(m.rotation(a, j)), m.rotation(b, j)))));
  return largest;
}

bool same(const Motion& a, const Motion& b) {
  return a.frames == b.frames && a.rotations == b.rotations && a.positions == b.positions;
}

const RootRotation all_forms[] = {RootRotation::velocity, RootRotation::support, RootRotation::heading,
                                  RootRotation::expmap};

}  // namespace

TEST_CASE("without a prior: the motion of Dvgan::generate, in any steps, for every root form") {
  for (const RootRotation form : all_forms) {
    CAPTURE(static_cast<int>(form));
    const Dvgan m = make_model(form);
    const Motion whole = m.generate("walk", {.seed = 5, .first_sample = 3, .frames = 30}).front();
    MotionStream stream(m);
    const CharacterId first = stream.add({.text = "jump high", .seed = 9});
    stream.step(2);
    const CharacterId id = stream.add({.text = "walk", .seed = 5, .sample = 3});
    CHECK(stream.size() == 2);
    CHECK(stream.rate() == 4);
    CHECK(stream.skeleton() == whole.skeleton);
    stream.step();
    Motion pieces = stream.motion(id);
    CHECK(pieces.frames == 1);
    stream.step(14);
    CHECK(same(stream.motion(id), stream.motion(id)));  // reading does not advance
    pieces = join(pieces, stream.motion(id));
    stream.remove(first);
    CHECK(stream.motion(id).frames == 14);
    stream.step(15);
    pieces = join(pieces, stream.motion(id));
    CHECK(same(pieces, whole));
    const std::size_t size = 15 * m.format().dof();
    const auto poses = m.generate_poses("walk", {.seed = 5, .first_sample = 3, .frames = 30}).front();
    CHECK(std::equal(poses.end() - static_cast<std::ptrdiff_t>(size), poses.end(), stream.poses(id).begin(),
                     stream.poses(id).end()));
  }
}

TEST_CASE("a character starts at the given place") {
  for (const RootRotation form : all_forms) {
    CAPTURE(static_cast<int>(form));
    const Dvgan m = make_model(form);
    MotionStream stream(m);
    const motion::RootTrack at{30, -7, 1.1};
    const auto ids = stream.add({{.text = "walk"}, {.text = "walk", .at = at}});
    stream.step(10);
    const Motion here = stream.motion(ids[0]), there = stream.motion(ids[1]);
    const bool turned = form != RootRotation::expmap;
    // The same motion except for position and, if the form has it, heading.
    CHECK(ground_step(here, 0, 9) == doctest::Approx(ground_step(there, 0, 9)));
    const auto first = m.format().layout.track_of(here, 0), moved = m.format().layout.track_of(there, 0);
    double x = first.x, z = first.z;
    if (turned) motion::turn_ground(x, z, at.yaw);
    CHECK(moved.x == doctest::Approx(x + at.x));
    CHECK(moved.z == doctest::Approx(z + at.z));
    CHECK(std::remainder(moved.yaw - first.yaw - (turned ? at.yaw : 0), 2 * motion::pi) ==
          doctest::Approx(0));
  }
}

TEST_CASE("a prior is continued without a jump, in its place and with its skeleton") {
  Motion prior = clips()[0].motion;  // at 8 per second
  for (motion::Joint& joint : prior.skeleton.joints)
    for (double& length : joint.offset) length *= 1.5;
  for (std::size_t f = 0; f < prior.frames; ++f)
    for (std::size_t j = 1; j < prior.skeleton.size(); ++j)
      prior.position(f, j) = prior.skeleton.joints[j].offset;
  for (const RootRotation form : all_forms) {
    for (const bool position : {true, false}) {
      CAPTURE(static_cast<int>(form));
      CAPTURE(position);
      const Dvgan m = make_model(form, position);
      MotionStream stream(m);
      const CharacterId id = stream.add({.text = "walk", .prior = &prior});
      stream.step(6);
      const Motion made = stream.motion(id);
      CHECK(made.skeleton == prior.skeleton);
      const Motion seed = motion::resample_to_end(prior, 4);
      const Motion whole = join(seed, made);
      // The model is untrained and moves little. The step at the seam must not exceed those after it, up to
      // the rounding of a pose in single precision.
      double turn = 0, step = 0;
      for (std::size_t f = seed.frames; f + 1 < whole.frames; ++f) {
        turn = std::max(turn, largest_turn(whole, f, f + 1));
        step = std::max(step, ground_step(whole, f, f + 1));
      }
      CHECK(largest_turn(whole, seed.frames - 1, seed.frames) < 2 * turn + 1e-4);
      // With a support, the root also moves with the legs.
      const double most = form == RootRotation::support ? 3 : 2;
      CHECK(ground_step(whole, seed.frames - 1, seed.frames) < most * step + 1e-3);
      CHECK(made.position(3, 4) == prior.position(0, 4));
    }
  }
}

TEST_CASE("the continuation depends on the prior's last frames, the text and the noise") {
  const Motion whole = clips()[1].motion, prior = slice(whole, 0, 20), other = slice(whole, 4, 16);
  MotionStream stream(model());
  const auto ids = stream.add({{.text = "walk", .prior = &prior},
                               {.text = "walk", .sample = 1, .prior = &prior},
                               {.text = "walk"},
                               {.text = "walk", .prior = &other},
                               {.text = "walk", .prior = &prior}});
  stream.step(4);
  CHECK(same(stream.motion(ids[0]), stream.motion(ids[4])));
  for (const std::size_t i : {1u, 2u, 3u}) CHECK_FALSE(same(stream.motion(ids[0]), stream.motion(ids[i])));
  MotionStream alone(model());
  const CharacterId id = alone.add({.text = "walk", .prior = &other});
  alone.step(4);
  CHECK(same(alone.motion(id), stream.motion(ids[3])));
}

TEST_CASE("a new text changes the motion; unknown words are accepted, empty texts are not") {
  MotionStream stream(model());
  const auto ids = stream.add({{.text = "walk"}, {.text = "walk"}, {.text = "walk"}});
  stream.step(3);
  CHECK(same(stream.motion(ids[0]), stream.motion(ids[1])));
  stream.set_text(ids[1], "jump");
  stream.set_text(ids[2], "frobnicate");
  stream.step();
  CHECK(same(stream.motion(ids[0]), stream.motion(ids[1])));  // had been computed ahead
  stream.step(5);
  CHECK_FALSE(same(stream.motion(ids[0]), stream.motion(ids[1])));
  CHECK_FALSE(same(stream.motion(ids[2]), stream.motion(ids[1])));
  CHECK(says(message_of([&] { stream.set_text(ids[0], "!"); }), "has no words"));
}

TEST_CASE("invalid calls are rejected and change nothing") {
  MotionStream stream(model());
  const CharacterId id = stream.add({.text = "walk"});
  CHECK(says(message_of([&] { stream.motion(id); }), "character 0 has not moved since it was added"));
  CHECK(says(message_of([&] { stream.step(0); }), "frames is 0"));
  CHECK(says(message_of([&] { stream.remove(7); }), "no motion with id 7"));
  CHECK(says(message_of([&] { stream.motion(7); }), "no motion with id 7"));
  CHECK(says(message_of([&] { stream.add({{.text = "walk"}, {.text = ".."}}); }), "has no words"));
  Motion prior = clips()[0].motion;
  prior.skeleton.joints[2].name = "Tail";
  const std::string joints = message_of([&] { stream.add({.text = "walk", .prior = &prior}); });
  CHECK_MESSAGE(says(joints, "the prior has a different skeleton"), joints);
  CHECK_MESSAGE(says(joints, "is called 'Tail'"), joints);
  Motion empty = slice(clips()[0].motion, 0, 0);
  CHECK(says(message_of([&] { stream.add({.text = "walk", .prior = &empty}); }), "the prior has no frames"));
  empty = clips()[0].motion;
  empty.position(1, 0)[1] = std::nan("");
  CHECK(says(message_of([&] { stream.add({.text = "walk", .prior = &empty}); }), "not finite"));
  CHECK(stream.size() == 1);
  stream.remove(id);
  stream.step();
  CHECK(stream.size() == 0);
  const Dvgan cnn(context(), model().format(), {.hidden = 8});
  CHECK(says(message_of([&] { MotionStream refused(cnn); }), "--generator rnn"));
}

TEST_CASE("steps allocate nothing on the device") {
  MotionStream stream(model());
  std::vector<CharacterOptions> crowd;
  for (std::uint32_t i = 0; i < 20; ++i) crowd.push_back({.text = "walk", .sample = i});
  stream.add(crowd);
  stream.step(3);
  const ContextStatistics warm = context().statistics();
  for (int i = 0; i < 200; ++i) stream.step(i % 3 + 1);
  CHECK(context().statistics().allocations == warm.allocations);
  CHECK(context().statistics().bytes_in_use == warm.bytes_in_use);
}

}  // namespace motion_stream_test
