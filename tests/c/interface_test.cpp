// The C interface beside the C++ that it wraps: the same bits, in several threads too.
#include <doctest/doctest.h>
#include <motiongan.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <motiongan/core/os.hpp>
#include <motiongan/formats/read_motion.hpp>
#include <motiongan/sample/action_generate.hpp>
#include <motiongan/sample/character_stream.hpp>
#include <thread>

#include "calls.hpp"

namespace interface_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::Motion;

namespace {

const Context& context() {
  static const Context c;
  return c;
}
const Dvgan& texts() {
  static const Dvgan model = Dvgan::load(context(), files().rnn());
  return model;
}
const ActionGan& actions() {
  static const ActionGan model = ActionGan::load(context(), files().classes());
  return model;
}
const Motion& prior() {
  static const Motion motion = motion::read_motion(files().prior()).motion;
  return motion;
}

Values values_of(motiongan_clip clip) {
  std::size_t frames = 0, joints = 0;
  REQUIRE_OK(motiongan_clip_frames(clip, &frames));
  REQUIRE_OK(motiongan_joint_count(clip, &joints));
  Values out{std::vector<float>(4 * frames * joints), std::vector<float>(3 * frames * joints),
             std::vector<float>(3 * frames * joints)};
  REQUIRE_OK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_ROTATIONS, out.rotations.data(), out.rotations.size()));
  REQUIRE_OK(motiongan_clip_get(clip, MOTIONGAN_LOCAL_POSITIONS, out.positions.data(), out.positions.size()));
  REQUIRE_OK(motiongan_clip_get(clip, MOTIONGAN_GLOBAL_POSITIONS, out.global.data(), out.global.size()));
  return out;
}

/// The frame of all characters of a stream.
Values values_of(motiongan_stream stream, std::size_t joints) {
  std::size_t count = 0;
  REQUIRE_OK(motiongan_stream_count(stream, &count));
  Values out{std::vector<float>(4 * count * joints), std::vector<float>(3 * count * joints),
             std::vector<float>(3 * count * joints)};
  const auto get = [&](motiongan_quantity quantity, std::vector<float>& to) {
    REQUIRE_OK(motiongan_stream_get(stream, nullptr, count, quantity, to.data(), to.size()));
  };
  get(MOTIONGAN_LOCAL_ROTATIONS, out.rotations);
  get(MOTIONGAN_LOCAL_POSITIONS, out.positions);
  get(MOTIONGAN_GLOBAL_POSITIONS, out.global);
  return out;
}

/// Twenty frames of a stream of three characters, of which one leaves and one is added and told something
/// else.
std::vector<Values> script(motiongan_model model, motiongan_clip from) {
  std::size_t joints = 0;
  REQUIRE_OK(motiongan_joint_count(model, &joints));
  Handle stream;
  REQUIRE_OK(motiongan_stream_create(model, &stream.value));
  std::array<motiongan_start, 3> starts{start_of("run", 0, from), start_of("jump", 1, from),
                                        start_of("run", 2, from)};
  starts[1].placed = 1, starts[1].x = 100, starts[1].z = -50, starts[1].yaw = 1;
  std::array<std::uint64_t, 3> ids{};
  REQUIRE_OK(motiongan_stream_add(stream, starts.data(), 3, ids.data()));
  std::vector<Values> out;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 4) REQUIRE_OK(motiongan_stream_remove(stream, ids[0]));
    if (frame == 8) REQUIRE_OK(motiongan_stream_add(stream, starts.data(), 1, ids.data()));
    if (frame == 9) REQUIRE_OK(motiongan_stream_set_prompt(stream, ids[2], "jump"));
    REQUIRE_OK(motiongan_stream_step(stream));
    out.push_back(values_of(stream, joints));
  }
  return out;
}

/// The same by C++.
template <class Model>
std::vector<Values> expected_script(const Model& model, const Motion* from) {
  CharacterStream stream(model);
  const std::array<CharacterStart, 3> starts{
      CharacterStart{.prompt = "run", .seed = 7, .sample = 0, .prior = from},
      CharacterStart{
          .prompt = "jump", .seed = 7, .sample = 1, .prior = from, .at = motion::RootTrack{100, -50, 1}},
      CharacterStart{.prompt = "run", .seed = 7, .sample = 2, .prior = from}};
  const auto ids = stream.add(starts);
  std::vector<Values> out;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 4) stream.remove(ids[0]);
    if (frame == 8) stream.add(starts[0]);
    if (frame == 9) stream.set_prompt(ids[2], "jump");
    stream.step();
    Values& all = out.emplace_back();
    for (const CharacterStream::Id id : stream.ids()) append(all, stream.motion(id));
  }
  return out;
}

}  // namespace

TEST_CASE("clips are those of C++, bit for bit") {
  const Handle rnn(open(files().rnn())), window(open(files().window())), classes(open(files().classes())),
      given(read(files().prior()));
  const auto check = [](motiongan_model model, const char* prompt, std::size_t frames, motiongan_clip from,
                        const Motion& wanted) {
    Handle clip;
    REQUIRE_OK(motiongan_clip_make(model, prompt, frames, 5, 3, from, &clip.value));
    Values values;
    append(values, wanted);
    CHECK(values_of(clip) == values);
    double rate = 0;
    CHECK_OK(motiongan_clip_rate(clip, &rate));
    CHECK(rate == wanted.rate);
  };
  const Dvgan cnn = Dvgan::load(context(), files().window());
  check(window, "wave", 0, 0, cnn.generate("wave", {.seed = 5, .first_sample = 3}).front());
  check(rnn, "run", 0, 0, texts().generate("run", {.seed = 5, .first_sample = 3}).front());
  check(rnn, "run", 30, 0, texts().generate("run", {.seed = 5, .first_sample = 3, .frames = 30}).front());
  MotionStream continued(texts());
  const CharacterId id = continued.add({.text = "run", .seed = 5, .sample = 3, .prior = &prior()});
  continued.step(17);
  check(rnn, "run", 17, given, continued.motion(id));

  const Motion seed = motion::resample_to_end(prior(), 10);
  const motion::PositionClip positions = motion::clip_for(seed, actions().format(), "seed");
  const motion::PositionClip made =
      actions()
          .generate({prior_from(positions, actions().format(), positions.frames - 6)}, "run:6",
                    {.with_prior = false, .seed = 5, .first_sample = 3})
          .front();
  check(classes, "run", 6, given,
        motion::motion_from_positions(made, std::span(seed.rotations).last(seed.skeleton.size())));
  Values read_values;
  append(read_values, prior());
  CHECK(values_of(given) == read_values);
}

TEST_CASE("a clip from arrays is as good a prior as the clip itself") {
  const Handle rnn(open(files().rnn())), given(read(files().prior()));
  const Values arrays = values_of(given);
  Handle copied, a, b;
  REQUIRE_OK(motiongan_clip_from_arrays(rnn, prior().rate, prior().frames, arrays.rotations.data(),
                                        arrays.rotations.size(), arrays.positions.data(),
                                        arrays.positions.size(), &copied.value));
  const Values again = values_of(copied);
  CHECK(again.positions == arrays.positions);
  for (std::size_t i = 0; i < again.rotations.size(); ++i)
    CHECK(again.rotations[i] == doctest::Approx(arrays.rotations[i]).epsilon(1e-6).scale(1));
  REQUIRE_OK(motiongan_clip_make(rnn, "run", 10, 1, 0, given, &a.value));
  REQUIRE_OK(motiongan_clip_make(rnn, "run", 10, 1, 0, copied, &b.value));
  const Values from_file = values_of(a), from_arrays = values_of(b);
  for (std::size_t i = 0; i < from_file.global.size(); ++i)
    CHECK(from_arrays.global[i] == doctest::Approx(from_file.global[i]).epsilon(1e-4).scale(10));
}

TEST_CASE("a prior of another size is scaled to the model's") {
  const Handle rnn(open(files().rnn())), given(read(files().prior()));
  const std::string path = (files().folder / "in metres.bvh").string();
  motion::write_bvh(path, motion::scaled(prior(), 0.01));
  const Handle small(read(path));
  Handle a, b;
  REQUIRE_OK(motiongan_clip_make(rnn, "run", 5, 1, 0, given, &a.value));
  REQUIRE_OK(motiongan_clip_make(rnn, "run", 5, 1, 0, small, &b.value));
  const Values wanted = values_of(a), found = values_of(b);
  double worst = 0;  // a BVH file in metres has micrometres, and rounds the ratio of the bones
  for (std::size_t i = 0; i < wanted.global.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(wanted.global[i] - found.global[i])));
  CHECK(worst < 0.5);
}

TEST_CASE("streams are those of C++, bit for bit, in one thread and in several at once") {
  const Handle given(read(files().prior()));
  const Handle rnn(open(files().rnn())), other_rnn(open(files().rnn())), classes(open(files().classes()));
  const std::vector<Values> wanted = expected_script(texts(), nullptr),
                            wanted_with_prior = expected_script(texts(), &prior()),
                            wanted_classes = expected_script(actions(), &prior());
  CHECK(script(rnn, 0) == wanted);
  CHECK(script(rnn, given) == wanted_with_prior);
  CHECK(script(classes, given) == wanted_classes);
  CHECK(wanted.front().global != wanted.back().global);
  // Two streams of one model, which take turns, and two models at the same time.
  std::array<std::vector<Values>, 4> found;
  std::vector<std::thread> threads;
  threads.emplace_back([&] { found[0] = script(rnn, 0); });
  threads.emplace_back([&] { found[1] = script(rnn, given); });
  threads.emplace_back([&] { found[2] = script(other_rnn, 0); });
  threads.emplace_back([&] { found[3] = script(classes, given); });
  for (std::thread& thread : threads) thread.join();
  CHECK(found[0] == wanted);
  CHECK(found[1] == wanted_with_prior);
  CHECK(found[2] == wanted);
  CHECK(found[3] == wanted_classes);
}

TEST_CASE("a stream may be closed while another thread steps it") {
  const Handle rnn(open(files().rnn()));
  for (int round = 0; round < 20; ++round) {
    motiongan_stream stream = 0;
    REQUIRE_OK(motiongan_stream_create(rnn, &stream));
    const motiongan_start start = start_of("run", 0);
    std::uint64_t id = 0;
    REQUIRE_OK(motiongan_stream_add(stream, &start, 1, &id));
    std::atomic<int> steps{0};
    motiongan_status last = MOTIONGAN_OK;
    std::thread stepping([&] {
      while ((last = motiongan_stream_step(stream)) == MOTIONGAN_OK) ++steps;
    });
    while (steps < 2) std::this_thread::yield();
    CHECK_OK(motiongan_close(stream));
    stepping.join();
    CHECK(last == MOTIONGAN_INVALID_HANDLE);
  }
}

TEST_CASE("characters of a stream are read in any order, and only those asked for") {
  const Handle rnn(open(files().rnn()));
  Handle stream;
  REQUIRE_OK(motiongan_stream_create(rnn, &stream.value));
  const std::array<motiongan_start, 3> starts{start_of("run", 0), start_of("run", 1), start_of("run", 2)};
  std::array<std::uint64_t, 3> ids{};
  REQUIRE_OK(motiongan_stream_add(stream, starts.data(), 3, ids.data()));
  REQUIRE_OK(motiongan_stream_step(stream));
  std::size_t joints = 0;
  REQUIRE_OK(motiongan_joint_count(rnn, &joints));
  const Values all = values_of(stream, joints);
  const std::array<std::uint64_t, 2> two{ids[2], ids[0]};
  std::vector<float> read(8 * joints);
  CHECK_OK(motiongan_stream_get(stream, two.data(), 2, MOTIONGAN_LOCAL_ROTATIONS, read.data(), read.size()));
  const auto row = static_cast<std::ptrdiff_t>(4 * joints);
  CHECK(std::equal(read.begin(), read.begin() + row, all.rotations.begin() + 2 * row));
  CHECK(std::equal(read.begin() + row, read.end(), all.rotations.begin()));
  // Nothing is written where one of them is unknown.
  const std::vector<float> before = read;
  const std::array<std::uint64_t, 2> wrong{ids[1], 77};
  CHECK(motiongan_stream_get(stream, wrong.data(), 2, MOTIONGAN_LOCAL_ROTATIONS, read.data(), read.size()) ==
        MOTIONGAN_INVALID_HANDLE);
  CHECK(read == before);
}

TEST_CASE("a stream outlives the handles that it was made from") {
  Handle stream;
  std::size_t joints = 0;
  {
    const Handle rnn(open(files().rnn())), given(read(files().prior()));
    REQUIRE_OK(motiongan_joint_count(rnn, &joints));
    REQUIRE_OK(motiongan_stream_create(rnn, &stream.value));
    const motiongan_start start = start_of("run", 0, given);
    std::uint64_t id = 0;
    REQUIRE_OK(motiongan_stream_add(stream, &start, 1, &id));
  }
  REQUIRE_OK(motiongan_stream_step(stream));
  CHECK(values_of(stream, joints).rotations.size() == 4 * joints);
}

TEST_CASE("shipped models are listed; one of classes continues motion of its own") {
  std::size_t count = 0;
  REQUIRE_OK(motiongan_shipped_count(&count));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const char* name = nullptr;
    REQUIRE_OK(motiongan_shipped_name(i, &name));
    names.emplace_back(name);
  }
  REQUIRE(std::find(names.begin(), names.end(), "cmu-actions") != names.end());
  const Handle model(open("cmu-actions"));
  motiongan_clip made = 0;
  REQUIRE_OK(motiongan_clip_make(model, "walk", 40, 1, 2, 0, &made));
  const Handle clip(made);
  // This program is not beside the models; the library is.
  const ActionGan loaded = ActionGan::load(
      context(), os::program_path().parent_path().parent_path() / "models" / "cmu-actions.safetensors");
  CharacterStream stream(loaded);
  const auto id = stream.add({.prompt = "walk", .seed = 1, .sample = 2});
  Values expected;
  for (int frame = 0; frame < 40; ++frame) {
    stream.step();
    append(expected, stream.motion(id));
  }
  CHECK(values_of(made).rotations == expected.rotations);
}

}  // namespace interface_test
