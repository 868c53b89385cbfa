// RnnStream: motion equals the generator's, whatever else is in the stream.
#include <doctest/doctest.h>

#include <motiongan/networks/rnn_stream.hpp>

#include "../support/messages.hpp"
#include "../support/precision.hpp"

namespace rnn_stream_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr std::size_t dof = 7, hidden = 20, words = 9;

const Context& context() {
  static const Context c;
  return c;
}

RnnGenerator made(double leak) {
  return RnnGenerator(Initializer(context(), 3),
                      {.vocabulary = words, .dof = dof, .frames = 12, .hidden = hidden, .leak = leak});
}
const RnnGenerator& model() {
  static const RnnGenerator generator = made(0);
  return generator;
}
const RnnGenerator& leaky() {
  static const RnnGenerator generator = made(0.1);
  return generator;
}

/// Motion [frames, dof] of the generator in one call.
std::vector<float> at_once(const StreamStart& start, std::size_t frames, const std::vector<float>& prior = {},
                           const RnnGenerator& generator = model()) {
  const NoGrad values_only;
  const Var z = generator.noise(context(), {.seed = start.seed, .first_sample = start.sample}, 1, frames);
  const Var seed =
      prior.empty() ? Var() : Var::constant(Tensor::from(context(), {prior.size() / dof, 1, dof}, prior));
  return generator(Sentences(context(), {start.sentence}, words), z, {}, seed).value().to_host();
}

/// Collects a stream's frames by motion.
struct Recorder {
  explicit Recorder(const RnnGenerator& generator = model()) : stream(generator) {}
  RnnStream stream;
  std::map<StreamId, std::vector<float>> motions;
  void step(std::size_t frames) {
    const std::span<const float> made = stream.step(frames);
    for (std::size_t f = 0; f < frames; ++f)
      for (std::size_t row = 0; row < stream.size(); ++row) {
        const auto first = made.begin() + static_cast<std::ptrdiff_t>((f * stream.size() + row) * dof);
        auto& motion = motions[stream.id_of(row)];
        motion.insert(motion.end(), first, first + dof);
      }
  }
};

const StreamStart a{{1, 2, 3}, 5, 0}, b{{4}, 5, 7}, c{{1, 2, 3}, 0x1234567890ull, 2};

std::vector<float> prior(std::size_t frames) {
  std::vector<float> values;
  for (std::size_t i = 0; i < frames * dof; ++i) values.push_back(std::sin(0.1f * static_cast<float>(i)));
  return values;
}

}  // namespace

TEST_CASE("steps equal one call, bit for bit, while others are added and removed") {
  Recorder r;
  const StreamId first = r.stream.add({a})[0];
  r.step(3);
  const auto later = r.stream.add({b, c});
  r.step(1);
  r.step(20);
  r.stream.remove(first);
  r.step(9);
  CHECK(r.motions[first] == at_once(a, 24));
  CHECK(r.motions[later[0]] == at_once(b, 30));
  CHECK(r.motions[later[1]] == at_once(c, 30));
}

TEST_CASE("16-bit weights: steps equal one call of the rounded generator, near the first one") {
  for (const Precision precision : testing::precisions()) {
    const Context c(ContextOptions{.precision = precision});
    RnnGenerator generator(Initializer(c, 3),
                           {.vocabulary = words, .dof = dof, .frames = 12, .hidden = hidden});
    const auto motion_of = [&](bool in_one_call) {
      const NoGrad values_only;
      if (in_one_call)
        return generator(Sentences(c, {b.sentence}, words),
                         generator.noise(c, {.seed = b.seed, .first_sample = b.sample}, 1, 20))
            .value()
            .to_host();
      RnnStream stream(generator);
      const StreamId id = stream.add({a, b, rnn_stream_test::c})[1];
      REQUIRE(stream.row_of(id) == 1);
      std::vector<float> motion;
      for (int t = 0; t < 20; ++t) {
        const std::span<const float> made = stream.step();
        motion.insert(motion.end(), made.begin() + dof, made.begin() + 2 * dof);
      }
      return motion;
    };
    const std::vector<float> before = motion_of(true);
    generator.bfloat16();
    const std::vector<float> rounded = motion_of(false);
    CHECK(rounded == motion_of(true));
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < rounded.size(); ++i)
      difference += std::pow(rounded[i] - before[i], 2), size += std::pow(before[i], 2);
    CHECK(std::sqrt(difference / size) < 0.02);
    CHECK(difference > 0);
  }
}

TEST_CASE("a prior is continued as by the generator; several motions may share one") {
  for (std::size_t n : {1u, 5u}) {
    CAPTURE(n);
    const std::vector<float> seed = prior(n);
    Recorder r;
    const auto ids = r.stream.add({a, b}, seed, n);
    r.step(8);
    for (std::size_t i : {0u, 1u}) {
      std::vector<float> whole = seed;
      whole.insert(whole.end(), r.motions[ids[i]].begin(), r.motions[ids[i]].end());
      CHECK(whole == at_once(i == 0 ? a : b, n + 8, seed));
    }
  }
}

TEST_CASE("with a leak: steps equal one call, with a prior and without") {
  Recorder r(leaky());
  const StreamId free = r.stream.add({a})[0];
  r.step(3);
  const StreamId continued = r.stream.add({b}, prior(5), 5)[0];
  r.step(20);
  CHECK(r.motions[free] == at_once(a, 23, {}, leaky()));
  const std::vector<float> whole = at_once(b, 25, prior(5), leaky());
  CHECK(r.motions[continued] == std::vector<float>(whole.begin() + 5 * dof, whole.end()));
  CHECK(at_once(a, 23) != at_once(a, 23, {}, leaky()));
}

TEST_CASE("with a leak a motion stays within a bound, without one it may leave it") {
  // |h| < 1, so a change is at most the sum of |Wd| and |bd|, and a leak of 0.1 holds ten changes.
  const auto farthest = [](const RnnGenerator& generator, const std::vector<float>& motion) {
    std::vector<float> weight = generator.fold().rollout.diff.value().to_host(),
                       bias = generator.fold().rollout.diff_bias.value().to_host();
    double worst = 0;  // in changes
    for (std::size_t i = motion.size() - dof; i < motion.size(); ++i) {
      const std::size_t j = i % dof;
      double change = std::abs(bias[j]);
      for (std::size_t h = 0; h < hidden; ++h) change += std::abs(weight[j * hidden + h]);
      worst = std::max(worst, std::abs(motion[i]) / change);
    }
    return worst;
  };
  std::vector<float> far = prior(1);
  for (float& x : far) x = 1000;
  CHECK(farthest(leaky(), at_once(a, 300, far, leaky())) < 10);
  CHECK(farthest(model(), at_once(a, 300, far)) > 10);
}

TEST_CASE("a new text changes the rest of a motion, and no other motion") {
  Recorder r;
  const auto ids = r.stream.add({a, b});
  r.step(4);
  r.stream.set_sentence(ids[0], {6, 7});
  r.step(6);
  const std::vector<float> before = at_once(a, 10);
  const auto end_of_old = static_cast<std::ptrdiff_t>(5 * dof);  // the fifth frame had been computed ahead
  CHECK(std::equal(before.begin(), before.begin() + end_of_old, r.motions[ids[0]].begin()));
  CHECK_FALSE(std::equal(before.begin() + end_of_old, before.end(), r.motions[ids[0]].begin() + end_of_old));
  CHECK(r.motions[ids[1]] == at_once(b, 10));
}

TEST_CASE("steps allocate nothing on the device") {
  RnnStream stream(model());
  std::vector<StreamStart> many;
  for (std::uint32_t i = 0; i < 50; ++i) many.push_back({{1, 2}, 1, i});
  stream.add(many);
  stream.step(4);
  const ContextStatistics warm = context().statistics();
  for (int i = 0; i < 500; ++i) stream.step(i % 4 + 1);
  CHECK(context().statistics().allocations == warm.allocations);
  CHECK(context().statistics().bytes_in_use == warm.bytes_in_use);
  CHECK(context().statistics().reads == warm.reads + 500);
}

TEST_CASE("a cleared stream starts over") {
  Recorder r;
  r.stream.add({a, b, c});
  r.step(7);
  r.stream.clear();
  CHECK(r.stream.size() == 0);
  CHECK(r.stream.step().empty());
  const StreamId id = r.stream.add({b})[0];
  r.step(9);
  CHECK(r.motions[id] == at_once(b, 9));
}

TEST_CASE("empty streams, removed ids and priors of another size") {
  RnnStream stream(model());
  CHECK(stream.step(3).empty());
  CHECK(stream.add({}).empty());
  const StreamId id = stream.add({a})[0];
  stream.remove(id);
  CHECK(stream.size() == 0);
  CHECK(stream.step().empty());
  CHECK(says(message_of([&] { stream.remove(id); }), "no motion with id 0"));
  CHECK(says(message_of([&] { stream.set_sentence(99, {1}); }), "id 99"));
  CHECK(says(message_of([&] { stream.add({a}, prior(2), 3); }), "a prior of 3 frames has 14 values"));
  CHECK(says(message_of([&] { stream.add({{{}, 1, 0}}); }), "a sentence is empty"));
}

}  // namespace rnn_stream_test
