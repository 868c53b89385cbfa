// Whole clips of the attention model: schedules, priors, synthetic clips.
#include <doctest/doctest.h>

#include <filesystem>
#include <motiongan/procedural/procedural.hpp>
#include <motiongan/sample/action_generate.hpp>

#include "../support/messages.hpp"

namespace action_generate_test {

using namespace motiongan;
using namespace motiongan::testing;
using motion::ActionDataset;
using motion::PositionClip;

namespace {

const Context& context() {
  static const Context c;
  return c;
}

const ActionDataset& data(bool root = true) {
  const auto make = [](bool track) {
    auto motions = motion::procedural_motions({.clips = 34, .seconds = 3.7, .rate = 10});
    for (auto& m : motions) m.captions = {m.id.substr(0, m.id.find('_'))};
    return ActionDataset::from_motions(
        motions,
        {.frames = 8, .rate = 10, .root_track = track, .train_share = 1, .classes = {"walk", "run", "jump"}});
  };
  static const ActionDataset with = make(true), without = make(false);
  return root ? with : without;
}

double apart(const motion::Vec3& a, const motion::Vec3& b) { return motion::length(motion::subtract(a, b)); }

}  // namespace

TEST_CASE("schedules are parsed, and errors name the piece") {
  const motion::PositionFormat& format = data().format;  // jump run walk, 10 per second
  const auto read = [&](const char* text, double seconds = 0) {
    return parse_action_schedule(text, format, seconds);
  };
  CHECK(read("walk:3s,run:5s") == ActionSchedule{{2, 30}, {1, 50}});
  CHECK(read("walk:90, jump:0.25s") == ActionSchedule{{2, 90}, {0, 3}});
  CHECK(read("run", 2.5) == ActionSchedule{{1, 25}});
  CHECK(read("walk:1s,run", 3) == ActionSchedule{{2, 10}, {1, 20}});
  CHECK(read("walk:1s,run:2s", 3) == ActionSchedule{{2, 10}, {1, 20}});
  const auto refused = [&](const char* text, const char* part, double seconds = 0) {
    CHECK_THROWS_WITH_AS(read(text, seconds), doctest::Contains(part), Error);
  };
  refused("", "the schedule is empty");
  refused("walk:3s,,run:1s", "piece 2 of the schedule");
  refused("walk:3s,", "is empty");
  refused("walk", "has no length");
  refused("walk,run:3s", "only the last piece", 5);
  refused("walk:3s,rum:3s", "there is no class 'rum'; did you mean 'run'?");
  refused("walk:3s,run:x", "found the length 'x'");
  refused("walk:", "found the length ''");
  refused("walk:2.5", "found the length '2.5'");
  refused("walk:-3s", "found the length '-3s'");
  refused("walk:0s", "found the length '0s'");
  refused("walk:0.001s", "expected at least 1");
  refused("walk:1e300s", "less than 2^31");
  refused("walk:3s,run", "nothing of the 3 seconds", 3);
  refused("walk:3s", "but 5 were requested", 5);
}

TEST_CASE("classes change on the scheduled frame; the prior comes first") {
  const ActionGan model(context(), data().format, {.hidden = 8});
  std::vector<ActionPrior> priors;
  for (std::size_t i = 0; i < 3; ++i) priors.push_back(data().prior(data().train[i]));
  const ActionSchedule schedule{{2, 13}, {1, 20}};
  const std::vector<PositionClip> clips = model.generate(priors, schedule);
  REQUIRE(clips.size() == 3);
  const std::size_t joints = data().format.skeleton().size();
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(clips[i].frames == 8 + 33);
    CHECK(clips[i].positions.size() == 41 * joints);
    CHECK(clips[i].id == priors[i].id);
    CHECK(std::equal(priors[i].positions.begin(), priors[i].positions.end(), clips[i].positions.begin()));
    // One clip by hand: 8 and 5 frames of the first class, 8, 8 and 4 of the second.
    ActionStream stream(model);
    const auto id = stream.add({.prior = &priors[i], .label = 2});
    std::vector<motion::Vec3> expected;
    for (const std::size_t frames : {8u, 5u, 8u, 8u, 4u}) {
      if (expected.size() == 13 * joints) stream.set_class(id, "run");
      stream.step(frames);
      const PositionClip made = stream.clip(id);
      expected.insert(expected.end(), made.positions.begin(), made.positions.end());
    }
    CHECK(std::equal(expected.begin(), expected.end(),
                     clips[i].positions.begin() + static_cast<std::ptrdiff_t>(8 * joints)));
  }
  const auto bare = model.generate({priors[0]}, schedule, {.with_prior = false});
  CHECK(bare.front().frames == 33);
  CHECK(std::equal(bare.front().positions.begin(), bare.front().positions.end(),
                   clips.front().positions.begin() + static_cast<std::ptrdiff_t>(8 * joints)));
  CHECK_THROWS_WITH_AS(model.generate(priors, ActionSchedule{}), doctest::Contains("schedule has no frames"),
                       Error);
}

TEST_CASE("a synthetic clip has the real one's prior, class and length") {
  for (const bool root : {true, false}) {
    const ActionDataset& d = data(root);
    for (const ActionGenerator kind : {ActionGenerator::attention, ActionGenerator::lstm}) {
      const ActionGan model(context(), d.format, {.generator = kind, .hidden = 8});
      const std::vector<SyntheticClip> made = synthesise(model, d, d.train);
      REQUIRE(made.size() == d.train.size());
      const std::size_t joints = d.format.skeleton().size();
      for (std::size_t i = 0; i < made.size(); ++i) {
        const PositionClip &real = d.clip(d.train[i]), &fake = made[i].clip;
        CHECK(fake.id == real.id);
        CHECK(fake.frames == real.frames);
        REQUIRE(fake.positions.size() == real.positions.size());
        CHECK(made[i].label == d.train[i].label);
        double before = 0, after = 0, roots = 0;
        for (std::size_t k = 0; k < fake.positions.size(); ++k) {
          const double gap = apart(fake.positions[k], real.positions[k]);
          (k < 8 * joints ? before : after) += gap;
          if (k % joints == 0) roots += gap;
        }
        CHECK(before == 0);
        CHECK(after > 1);
        CHECK((roots < 1e-6) == !root);  // without root channels it follows the real clip
      }
      // Equal to synthesising the clip alone.
      const auto alone = synthesise(model, d, std::span(d.train).subspan(1, 1));
      CHECK(alone.front().clip.positions == made[1].clip.positions);
    }
  }
  auto fewer = motion::procedural_motions({.clips = 17, .seconds = 3, .rate = 10});
  for (auto& m : fewer) m.captions = {m.id.substr(0, m.id.find('_'))};
  const auto other =
      ActionDataset::from_motions(fewer, {.frames = 8, .rate = 10, .train_share = 1, .classes = {"kick"}});
  const ActionGan model(context(), data().format, {.hidden = 8});
  CHECK_THROWS_WITH_AS(synthesise(model, other, other.train), doctest::Contains("there is no class 'kick'"),
                       Error);
}

TEST_CASE("bones keep the prior's lengths if they are exact, also from a file; the LSTM has none") {
  const Context& c = context();
  ActionGan model(c, data().format, {.hidden = 8, .continues = true, .exact_bones = true});
  const auto file = std::filesystem::temp_directory_path() / "motiongan_exact_bones.safetensors";
  model.save(file);
  const ActionGan loaded = ActionGan::load(c, file);
  std::filesystem::remove(file);
  CHECK(loaded.options().exact_bones);
  const ActionPrior prior = data().prior(data().train[0]);
  const auto made = model.generate({prior}, "walk:10s,run:2s"),
             again = loaded.generate({prior}, "walk:10s,run:2s");
  CHECK(made[0].positions == again[0].positions);
  const std::size_t joints = model.format().skeleton().size(), frames = made[0].positions.size() / joints;
  REQUIRE(frames > 100);
  for (const motion::Bone& bone : model.format().bones()) {
    const auto length_in = [&](std::size_t f) {
      return apart(made[0].positions[f * joints + bone.joint], made[0].positions[f * joints + bone.parent]);
    };
    for (std::size_t f = 0; f < frames; ++f)
      CHECK(length_in(f) == doctest::Approx(length_in(0)).epsilon(1e-3));
  }
  CHECK(says(message_of([&] {
               ActionGan(c, data().format, {.generator = ActionGenerator::lstm, .exact_bones = true});
             }),
             "keeps bones"));
}

}  // namespace action_generate_test
