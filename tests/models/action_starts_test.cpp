// Seconds of given motion that a model keeps, and in its file.
#include "motiongan/models/action_starts.hpp"

#include <doctest/doctest.h>

#include "../support/folders.hpp"
#include "../support/small_actions.hpp"
#include "motiongan/sample/action_generate.hpp"

namespace action_starts_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

io::SafeTensors file_with(const std::vector<ActionStart>& starts) {
  io::SafeTensors file;
  add_starts(file, starts, small_actions().format);
  return file;
}

std::vector<ActionStart> some_starts() {
  const motion::ActionDataset& data = small_actions();
  std::vector<ActionStart> out;
  for (const std::size_t c : {0, 1, 2})
    out.push_back({data.prior(data.train[c], 2 + c), data.train[c].label, {}});
  out[1].rotations.assign(data.format.skeleton().size(), {0.6, 0, 0.8, 0});
  return out;
}

}  // namespace

TEST_CASE("starts come back as they were, to rounding") {
  const std::vector<ActionStart> before = some_starts(),
                                 after = starts_in(file_with(before), small_actions().format, "here");
  REQUIRE(after.size() == before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const motion::ActionPrior &x = before[i].prior, &y = after[i].prior;
    CHECK(x.id == y.id);
    CHECK(x.first_frame == y.first_frame);
    CHECK(before[i].label == after[i].label);
    CHECK(x.poses == y.poses);
    REQUIRE(x.positions.size() == y.positions.size());
    for (std::size_t p = 0; p < x.positions.size(); ++p)
      for (std::size_t d = 0; d < 3; ++d) CHECK(x.positions[p][d] == doctest::Approx(y.positions[p][d]));
    REQUIRE(x.places.size() == y.places.size());
    for (std::size_t f = 0; f < x.places.size(); ++f) {
      CHECK(x.places[f].x == doctest::Approx(y.places[f].x));
      CHECK(x.places[f].z == doctest::Approx(y.places[f].z));
      CHECK(x.places[f].yaw == doctest::Approx(y.places[f].yaw));
      CHECK(x.places[f].height == doctest::Approx(y.places[f].height));
      CHECK(x.places[f].started == y.places[f].started);
    }
    for (std::size_t j = 0; j < x.skeleton.size(); ++j) {
      CHECK(x.skeleton.joints[j].name == y.skeleton.joints[j].name);
      for (std::size_t d = 0; d < 3; ++d)
        CHECK(x.skeleton.joints[j].offset[d] == doctest::Approx(y.skeleton.joints[j].offset[d]));
    }
    REQUIRE(before[i].rotations.size() == after[i].rotations.size());
    for (std::size_t j = 0; j < before[i].rotations.size(); ++j)
      CHECK(after[i].rotations[j].y == doctest::Approx(0.8));
  }
  CHECK(starts_in({}, small_actions().format, "here").empty());
}

TEST_CASE("a model keeps its starts in its file, and continues those of a class in turn") {
  const Context context;
  const motion::PositionFormat& format = small_actions().format;
  ActionGan model(context, format, {.hidden = 8});
  CHECK(model.starts().empty());
  CHECK(model.start(0, 0) == nullptr);
  CHECK(says(message_of([&] { model.generate("walk:1s", 1); }), "keeps no motion to continue"));
  std::vector<ActionStart> starts = some_starts();
  starts[0].label = starts[1].label = 1;
  starts[2].label = 0;
  model.set_starts(starts);
  const Scratch folder;
  model.save(folder.path / "m.safetensors", StoredWeights::half);
  const ActionGan loaded = ActionGan::load(context, folder.path / "m.safetensors");
  REQUIRE(loaded.starts().size() == 3);
  CHECK(loaded.start(1, 0) == &loaded.starts()[0]);
  CHECK(loaded.start(1, 3) == &loaded.starts()[1]);
  CHECK(loaded.start(0, 3) == &loaded.starts()[2]);
  // In full precision whatever the weights are stored in.
  CHECK(loaded.starts()[0].prior.poses == starts[0].prior.poses);

  const std::string schedule = format.classes[1] + ":1s";
  const auto made = loaded.generate(schedule, 2, {.first_sample = 1});
  REQUIRE(made.size() == 2);
  const auto given =
      loaded.generate({loaded.starts()[1].prior, loaded.starts()[0].prior}, schedule, {.first_sample = 1});
  for (std::size_t i = 0; i < 2; ++i) CHECK(made[i].positions == given[i].positions);

  starts[0].label = 9;
  CHECK(says(message_of([&] { model.set_starts(starts); }), "is of class 9"));
  starts[0].label = 0;
  starts[0].prior.poses.pop_back();
  CHECK(says(message_of([&] { model.set_starts(starts); }), "expected one of 2 classes and"));
  CHECK(model.starts().size() == 3);
}

TEST_CASE("starts that do not fit are refused by name") {
  const auto refusal = [](const auto& change) {
    io::SafeTensors file = file_with(some_starts());
    change(file);
    return message_of([&] { starts_in(file, small_actions().format, "m.safetensors"); });
  };
  CHECK(refusal([](io::SafeTensors&) {}) == "no error");
  CHECK(says(refusal([](auto& file) { file.tensors.erase("start.1.poses"); }),
             "m.safetensors: the model's starts: there is no tensor \"start.1.poses\""));
  CHECK(says(refusal([](auto& file) {
               file.tensors["start.2.places"] = io::SafeTensor::of({2}, std::vector<float>(2));
             }),
             "\"start.2.places\" has shape [2], expected [6, 4]"));
  CHECK(says(refusal([](auto& file) {
               auto& offsets = file.tensors["start.0.offsets"];
               std::vector<float> values = offsets.template as<float>();
               values[4] = std::numeric_limits<float>::infinity();
               offsets = io::SafeTensor::of(offsets.shape, values);
             }),
             "\"start.0.offsets\" holds inf"));
  CHECK(
      says(refusal([](auto& file) { file.metadata["starts"] = R"([{"clip":"a","frame":0,"class":"fly"}])"; }),
           "start 0 is of no class"));
  for (const char* text : {"[{}]", "[1]", R"([{"clip":1,"frame":0,"class":"walk"}])", "nonsense"})
    CHECK(says(refusal([&](auto& file) { file.metadata["starts"] = text; }),
               "m.safetensors: the model's starts: "));
}

}  // namespace action_starts_test
