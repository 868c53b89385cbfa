// The C interface with wrong arguments: a status and a message, and no harm.
#include <doctest/doctest.h>
#include <motiongan.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <motiongan/sample/character_stream.hpp>
#include <random>
#include <thread>

#include "../support/messages.hpp"
#include "calls.hpp"

namespace arguments_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("models open by the folder of a run, and errors say what is wrong") {
  const Scratch run;
  motiongan_model model = 0;
  const auto refused = [&](const std::string& path, const char* device, motiongan_status status) {
    CHECK(motiongan_model_open(path.c_str(), device, &model) == status);
    CHECK(model == 0);
    return std::string(motiongan_last_error());
  };
  CHECK(says(refused(run.path.string(), nullptr, MOTIONGAN_FAILED), "holds no generator.safetensors"));
  CHECK(says(refused("nowhere.safetensors", nullptr, MOTIONGAN_FAILED), "nowhere.safetensors: no such file"));
  CHECK(says(refused(files().prior(), nullptr, MOTIONGAN_FAILED), "prior.bvh"));
  CHECK(says(refused(files().rnn(), "no such device", MOTIONGAN_FAILED), "no OpenCL device matches"));
  refused(std::string(100'000, 'x'), nullptr, MOTIONGAN_FAILED);
  io::SafeTensors other;
  other.metadata["motiongan_model"] = "ranker";
  other.write(run.path / "other.safetensors");
  CHECK(says(refused((run.path / "other.safetensors").string(), nullptr, MOTIONGAN_FAILED), "\"ranker\""));
  std::filesystem::copy_file(files().rnn(), run.path / "generator.safetensors");
  const Handle opened(open(run.path.string()));

  std::size_t shipped = 0;
  CHECK_OK(motiongan_shipped_count(&shipped));
  const char* name = nullptr;
  CHECK(motiongan_shipped_name(shipped, &name) == MOTIONGAN_INVALID_ARGUMENT);
  CHECK(name == nullptr);

  motiongan_clip clip = 0;
  CHECK(motiongan_clip_make(opened, "?!", 0, 1, 0, 0, &clip) == MOTIONGAN_FAILED);
  CHECK(says(motiongan_last_error(), "has no words"));
  CHECK(motiongan_clip_make(opened, "run", SIZE_MAX / 2, 1, 0, 0, &clip) == MOTIONGAN_INVALID_ARGUMENT);
  CHECK(motiongan_clip_make(opened, "run", 0, 1, 0, opened, &clip) == MOTIONGAN_INVALID_HANDLE);
  CHECK(says(motiongan_last_error(), "is a model, expected a clip"));
  const Handle classes(open(files().classes()));
  CHECK(motiongan_clip_make(classes, "run", 0, 1, 0, 0, &clip) == MOTIONGAN_FAILED);
  CHECK(says(motiongan_last_error(), "needs a prior"));
  const Handle given(read(files().prior()));
  CHECK(motiongan_clip_make(classes, "wlak", 0, 1, 0, given, &clip) == MOTIONGAN_FAILED);
  CHECK(says(motiongan_last_error(), "did you mean 'walk'?"));
  CHECK(motiongan_clip_write(given, (run.path / "no/folder.bvh").c_str()) == MOTIONGAN_FAILED);
  CHECK(clip == 0);
  const std::vector<float> zeros(7 * 1000, 0);
  CHECK(motiongan_clip_from_arrays(opened, 10, 1, zeros.data(), 4000, zeros.data(), 3000, &clip) ==
        MOTIONGAN_INVALID_ARGUMENT);
  CHECK(says(motiongan_last_error(), "frame 0, joint 0: quaternion"));
}

TEST_CASE("messages are each thread's own") {
  CHECK(motiongan_close(0) == MOTIONGAN_INVALID_HANDLE);
  const std::string mine = motiongan_last_error();
  CHECK(says(mine, "handle 0 was never given out"));
  std::string theirs = "unset";
  std::thread([&] { theirs = motiongan_last_error(); }).join();
  CHECK(theirs.empty());
  CHECK(motiongan_last_error() == mine);
}

TEST_CASE("arbitrary arguments give a status and harm nothing") {
  const Handle rnn(open(files().rnn())), classes(open(files().classes())), given(read(files().prior()));
  Handle stream, class_stream;
  REQUIRE_OK(motiongan_stream_create(rnn, &stream.value));
  REQUIRE_OK(motiongan_stream_create(classes, &class_stream.value));
  const std::array<motiongan_start, 2> two{start_of("run", 0), start_of("run", 1)};
  std::array<std::uint64_t, 2> first{};
  REQUIRE_OK(motiongan_stream_add(stream, two.data(), 2, first.data()));

  std::mt19937 random(3);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  std::uint64_t gone = 0;
  REQUIRE_OK(motiongan_clip_read(files().prior().c_str(), &gone));
  REQUIRE_OK(motiongan_close(gone));
  std::vector<std::uint64_t> handles{0, rnn, classes, given, stream, class_stream, gone, 999'999, UINT64_MAX};
  std::vector<std::string> strings{"",  "run",        "jump", "wlak", ".", files().rnn(), files().prior(),
                                   "/", "x.bvh/y.bvh"};
  for (int i = 0; i < 30; ++i) {
    std::string& text = strings.emplace_back();
    for (std::size_t n = below(60); n > 0; --n) text += static_cast<char>(1 + below(255));
    if (i % 3 == 0) text += ".bvh";
  }
  const auto handle = [&] { return handles[below(handles.size())]; };
  const auto string = [&]() -> const char* {
    return below(8) == 0 ? nullptr : strings[below(strings.size())].c_str();
  };
  std::vector<float> room(2000);
  std::vector<std::uint64_t> ids(8, 5);
  std::vector<std::int32_t> parents(100);
  const std::array<std::size_t, 8> lengths{0, 1, 5, 93, 124, 248, 1000, 2000};
  const auto length = [&] { return lengths[below(lengths.size())]; };
  const auto floats = [&] { return below(6) == 0 ? nullptr : room.data(); };
  const auto quantity = [&] { return static_cast<motiongan_quantity>(below(6)) - 1; };
  std::map<motiongan_status, int> seen;
  std::size_t size = 0;
  double number = 0;
  const char* text = nullptr;
  for (int round = 0; round < 4000; ++round) {
    motiongan_start start =
        start_of(string(), static_cast<std::uint32_t>(below(3)), below(3) == 0 ? handle() : 0);
    start.placed = static_cast<std::uint32_t>(below(3));
    start.yaw = below(5) == 0 ? std::nan("") : 1;
    ids.front() = below(3) == 0 ? first[0] : below(20);
    std::uint64_t made = 0, id = 0;
    motiongan_status status = MOTIONGAN_OK;
    const std::size_t which = below(24);
    switch (which) {
      case 0:
        status = motiongan_clip_read(string(), below(9) ? &made : nullptr);
        break;
      case 1:
        status = motiongan_model_kind(handle(), below(9) ? parents.data() : nullptr);
        break;
      case 2:
        status = motiongan_model_rate(handle(), below(9) ? &number : nullptr);
        break;
      case 3:
        status = motiongan_model_unit(handle(), below(9) ? &number : nullptr);
        break;
      case 4:
        status = motiongan_model_frames(handle(), below(9) ? &size : nullptr);
        break;
      case 5:
        status = motiongan_model_prompt_count(handle(), below(9) ? &size : nullptr);
        break;
      case 6:
        status =
            motiongan_model_prompt(handle(), below(2) ? below(50) : SIZE_MAX, below(9) ? &text : nullptr);
        break;
      case 7:
        status = motiongan_joint_count(handle(), below(9) ? &size : nullptr);
        break;
      case 8:
        status = motiongan_joint_name(handle(), below(2) ? below(50) : SIZE_MAX, below(9) ? &text : nullptr);
        break;
      case 9:
        status = motiongan_joint_parents(handle(), below(9) ? parents.data() : nullptr, below(100));
        break;
      case 10:
        status = motiongan_joint_offsets(handle(), floats(), length());
        break;
      case 11:
        status = motiongan_clip_make(handle(), string(), below(3) ? below(4) : SIZE_MAX - below(4), 1, 0,
                                     below(2) ? handle() : 0, below(9) ? &made : nullptr);
        break;
      case 12:
        status =
            motiongan_clip_from_arrays(handle(), below(3) ? 10 : -1, below(3) ? below(4) : SIZE_MAX, floats(),
                                       length(), floats(), length(), below(9) ? &made : nullptr);
        break;
      case 13:
        status = motiongan_clip_frames(handle(), below(9) ? &size : nullptr);
        break;
      case 14:
        status = motiongan_clip_rate(handle(), below(9) ? &number : nullptr);
        break;
      case 15:
        status = motiongan_clip_get(handle(), quantity(), floats(), length());
        break;
      case 16:
        status = motiongan_clip_write(handle(), "/dev/null/x.bvh");
        break;
      case 17:
        status = motiongan_stream_create(handle(), below(9) ? &made : nullptr);
        break;
      case 18:
        status = motiongan_stream_add(handle(), below(9) ? &start : nullptr, below(3) ? 1 : SIZE_MAX,
                                      below(9) ? &id : nullptr);
        break;
      case 19:
        status = below(2) ? motiongan_stream_remove(handle(), 3 + below(100))
                          : motiongan_stream_set_prompt(handle(), 2 * below(3), string());
        break;
      case 20:
        status = motiongan_stream_step(handle());
        break;
      case 21:
        status = motiongan_stream_count(handle(), below(9) ? &size : nullptr);
        break;
      case 22:
        status = motiongan_stream_ids(handle(), below(9) ? ids.data() : nullptr, below(8));
        break;
      default:
        status = motiongan_stream_get(handle(), below(2) ? ids.data() : nullptr,
                                      below(4) ? below(3) : SIZE_MAX, quantity(), floats(), length());
        break;
    }
    CAPTURE(which);
    CHECK(status >= MOTIONGAN_OK);
    CHECK(status < MOTIONGAN_OUT_OF_MEMORY);
    if (status != MOTIONGAN_OK) {
      CHECK(std::string(motiongan_last_error()) != "");
      CHECK(made == 0);
    }
    if (made != 0) CHECK_OK(motiongan_close(made));
    ++seen[status];
  }
  CHECK(seen.size() == 5);  // among them BUFFER_TOO_SMALL and FAILED; never DEVICE_FAILED
  // Those who were there from the start move as if nothing had happened.
  std::size_t steps = 0;
  const Context context;
  const Dvgan texts = Dvgan::load(context, files().rnn());
  CharacterStream expected(texts);
  const std::array<CharacterStart, 2> starts{CharacterStart{.prompt = "run", .seed = 7, .sample = 0},
                                             CharacterStart{.prompt = "run", .seed = 7, .sample = 1}};
  const auto expected_ids = expected.add(starts);
  std::vector<float> found(4 * texts.format().skeleton().size());
  REQUIRE_OK(motiongan_stream_step(stream));
  REQUIRE_OK(
      motiongan_stream_get(stream, &first[1], 1, MOTIONGAN_LOCAL_ROTATIONS, found.data(), found.size()));
  for (bool same = false; steps < 1000 && !same; ++steps) {
    expected.step();
    Values values;
    append(values, expected.motion(expected_ids[1]));
    same = values.rotations == found;
  }
  CHECK(steps < 1000);
}

}  // namespace arguments_test
