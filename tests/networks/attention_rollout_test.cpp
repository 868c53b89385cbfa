// AttentionRollout against AttentionGenerator: same motion, independent of the rest of the batch.
#include <doctest/doctest.h>

#include <motiongan/networks/attention_rollout.hpp>
#include <motiongan/procedural/procedural.hpp>

#include "../support/messages.hpp"
#include "../support/precision.hpp"

namespace attention_rollout_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

constexpr std::size_t classes = 3;

/// A generator with non-zero gamma.
AttentionGenerator generator(const Context& c, const AttentionGeneratorOptions& options) {
  AttentionGenerator made(Initializer(c, 3), options);
  for (const NamedParameter& p : named_parameters(made))
    if (p.name == "attention.gamma") p.value->node()->value.write(std::span<const float>({0.7f}));
  return made;
}

Tensor prior(const Context& c, std::size_t frames, std::size_t batch, std::size_t dof) {
  return random_normal(c, {.seed = 5}, frames, batch, dof);
}

/// One-hot [batch, classes]; sample b has class (b + first) % classes.
Tensor one_hot(const Context& c, std::size_t batch, std::size_t first = 0) {
  std::vector<float> rows(batch * classes, 0);
  for (std::size_t b = 0; b < batch; ++b) rows[b * classes + (b + first) % classes] = 1;
  return Tensor::from(c, {batch, classes}, rows);
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

double difference(const Tensor& a, const Tensor& b) {
  REQUIRE(a.shape() == b.shape());
  std::vector<double> x = a.to_host<double>();
  const std::vector<double> y = b.to_host<double>();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= y[i];
  return largest(x) / largest(y);
}

}  // namespace

TEST_CASE("equals the generator to rounding over several steps with changing classes") {
  struct Case {
    std::size_t frames, batch, dof, hidden, noise;
    bool attention, continues = false;
  };
  for (const Precision precision : testing::precisions())
    for (const Case& k : {Case{30, 3, 93, 64, 0, true},
                          {7, 1, 5, 20, 0, true},
                          {1, 2, 17, 9, 4, true},
                          {5, 13, 16, 40, 1, false},
                          {33, 2, 31, 256, 0, true},
                          {30, 3, 93, 64, 0, true, true},
                          {6, 2, 5, 20, 2, false, true}}) {
      CAPTURE(k.frames);
      const Context& c = context_of(precision);
      const AttentionGenerator g = generator(c, {.dof = k.dof,
                                                 .classes = classes,
                                                 .hidden = k.hidden,
                                                 .noise_dim = k.noise,
                                                 .attention = k.attention,
                                                 .continues = k.continues});
      AttentionRollout rollout(g);
      Tensor fast = prior(c, k.frames, k.batch, k.dof), plain = fast;
      for (std::size_t step : {0u, 1u, 2u}) {
        const Tensor y = one_hot(c, k.batch, step);
        Tensor z;
        if (k.noise > 0)
          z = random_normal(c, {.seed = step}, 1, k.batch, k.noise).reshape({k.batch, k.noise});
        const NoGrad values_only;
        fast = rollout.step(fast, y, z);
        plain = g(Var::constant(plain), Var::constant(y), z.empty() ? Var() : Var::constant(z)).value();
        CHECK(difference(fast, plain) < (precision == Precision::f64 ? 1e-12 : 1e-5));
      }
    }
}

TEST_CASE("a generator that continues adds its output to the prior's last frame, which fades" *
          doctest::test_suite("double")) {
  const Context& c = context_of(Precision::f64);
  AttentionGeneratorOptions options{.dof = 5, .classes = classes, .hidden = 12};
  const Tensor x = prior(c, 6, 3, 5), y = one_hot(c, 3);
  const std::vector<double> poses =
      generator(c, options)(Var::constant(x), Var::constant(y)).value().to_host<double>();
  options.continues = true;
  const std::vector<double>
      continued = generator(c, options)(Var::constant(x), Var::constant(y)).value().to_host<double>(),
      given = x.to_host<double>();
  for (std::size_t i = 0; i < poses.size(); ++i)
    CHECK(continued[i] == doctest::Approx(poses[i] + (6.0 - double(i / 15)) / 7 * given[5 * 15 + i % 15]));
}

TEST_CASE("with exact bones the rollout equals the generator, and keeps the lengths for an hour") {
  for (const Precision precision : testing::precisions()) {
    const Context& c = context_of(precision);
    const motion::Motion walk = motion::procedural_motion(0, {.seconds = 1}).motion;
    motion::PositionFormat format;
    format.layout = motion::PositionLayout(walk.skeleton);
    format.normalizer =
        motion::Normalizer::fit(format.layout.encode(motion::joint_positions(walk)), format.layout.dof());
    format.classes = {"walk", "run", "jump"};
    const Bones bones(c, format);
    const AttentionGenerator g(
        Initializer(c, 3), {.dof = format.dof(), .classes = classes, .hidden = 16, .continues = true}, bones);
    AttentionRollout rollout(g);
    const std::size_t batch = 2, frames = 5;
    const std::vector<float> poses = format.encode(motion::joint_positions(walk));
    const Var given = Var::constant(Tensor::from(
        c, {frames, batch, format.dof()},
        std::vector<float>(poses.begin(),
                           poses.begin() + std::ptrdiff_t(frames * batch) * std::ptrdiff_t(format.dof()))));
    const auto lengths = [&](const Var& motion) {
      const NoGrad values_only;
      return bones.lengths(bones.vectors(slice(motion, 0, frames - 1, 1))).value();
    };
    Tensor fast = given.value(), plain = fast;
    const Tensor y = one_hot(c, batch);
    for (int step = 0; step < 3; ++step) {
      const NoGrad values_only;
      fast = rollout.step(fast, y);
      plain = g(Var::constant(plain), Var::constant(y)).value();
      CHECK(difference(fast, plain) < (precision == Precision::f64 ? 1e-12 : 1e-5));
    }
    CHECK(difference(lengths(Var::constant(fast)), lengths(given)) < 1e-5);
    if (precision == Precision::f64) continue;
    for (int step = 0; step < 3600; ++step) fast = rollout.step(fast, y);
    CHECK(difference(lengths(Var::constant(fast)), lengths(given)) < 1e-3);
    const Var alone = slice(Var::constant(given.value()), 1, 1, 1);
    Tensor one = alone.value(), both = given.value();
    for (int step = 0; step < 3; ++step)
      one = rollout.step(one, one_hot(c, 1, 1)), both = rollout.step(both, y);
    CHECK(one.to_host() == slice(Var::constant(both), 1, 1, 1).value().to_host());
  }
}

TEST_CASE("a sample is the same alone and in a batch, bit for bit") {
  const Context& c = context_of(Precision::f32);
  constexpr std::size_t frames = 30, dof = 93;
  const AttentionGenerator g = generator(c, {.dof = dof, .classes = classes, .hidden = 256});
  AttentionRollout rollout(g);
  const std::size_t batch = 21;
  const Tensor all = prior(c, frames, batch, dof);
  Tensor together = all;
  for (int step = 0; step < 3; ++step) together = rollout.step(together, one_hot(c, batch));
  for (const std::size_t sample : {0u, 8u, 20u}) {
    const auto only = [&](const Tensor& t) { return slice(Var::constant(t), 1, sample, 1).value(); };
    Tensor alone = only(all);
    for (int step = 0; step < 3; ++step) alone = rollout.step(alone, one_hot(c, 1, sample));
    CHECK(alone.to_host() == only(together).to_host());
  }
}

TEST_CASE("16-bit weights: the motion of the rounded generator, the same alone and in a batch") {
  for (const Precision precision : testing::precisions()) {
    const Context& c = context_of(precision);
    constexpr std::size_t frames = 30, dof = 31, batch = 7;
    AttentionGenerator g = generator(c, {.dof = dof, .classes = classes, .hidden = 128});
    const Tensor x = prior(c, frames, batch, dof), y = one_hot(c, batch);
    const Tensor before = AttentionRollout(g).step(x, y);
    g.bfloat16();
    AttentionRollout rollout(g);
    const NoGrad values_only;
    const Tensor together = rollout.step(x, y);
    CHECK(difference(together, g(Var::constant(x), Var::constant(y)).value()) <
          (precision == Precision::f64 ? 1e-12 : 1e-5));
    CHECK(difference(together, before) > 0);
    CHECK(difference(together, before) < 0.05);
    const auto only = [&](const Tensor& t) { return slice(Var::constant(t), 1, 3, 1).value(); };
    CHECK(rollout.step(only(x), one_hot(c, 1, 3)).to_host() == only(together).to_host());
  }
}

TEST_CASE("weights are read at construction; buffers are allocated once") {
  const Context& c = context_of(Precision::f32);
  AttentionGenerator g = generator(c, {.dof = 6, .classes = classes, .hidden = 16});
  AttentionRollout rollout(g);
  const Tensor x = prior(c, 8, 4, 6), y = one_hot(c, 4);
  const std::vector<float> before = rollout.step(x, y).to_host();
  for (int i = 0; i < 3; ++i) rollout.step(x, y);
  const ContextStatistics warm = c.statistics();
  Tensor motion = x;
  for (int i = 0; i < 20; ++i) motion = rollout.step(motion, y);
  CHECK(c.statistics().allocations <= warm.allocations + 1);  // a result and its prior
  CHECK(c.statistics().writes == warm.writes);
  CHECK(c.statistics().reads == warm.reads);
  for (const NamedParameter& p : named_parameters(g)) {
    std::vector<float> values = p.value->value().to_host();
    for (float& v : values) v *= 1.5f;
    p.value->node()->value.write(std::span<const float>(values));
  }
  CHECK(rollout.step(x, y).to_host() == before);
  CHECK(AttentionRollout(g).step(x, y).to_host() != before);
}

TEST_CASE("inputs of the wrong shape are rejected") {
  const Context& c = context_of(Precision::f32);
  const AttentionGenerator g = generator(c, {.dof = 6, .classes = classes, .hidden = 16, .noise_dim = 2});
  AttentionRollout rollout(g);
  const Tensor x = prior(c, 8, 4, 6), y = one_hot(c, 4);
  const Tensor z = random_normal(c, {.seed = 1}, 1, 4, 2).reshape({4, 2});
  const auto message = [&](const Tensor& p, const Tensor& k, const Tensor& n) {
    return message_of([&] { rollout.step(p, k, n); });
  };
  CHECK(message(prior(c, 8, 4, 5), y, z) == "AttentionRollout: prior [8, 4, 5], expected [frames, batch, 6]");
  CHECK(message(x, one_hot(c, 3), z) == "AttentionRollout: classes [3, 3], expected [4, 3]");
  CHECK(says(message(x, y, {}), "noise [], expected [4, 2]"));
  const AttentionGenerator quiet = generator(c, {.dof = 6, .classes = classes, .hidden = 16});
  AttentionRollout other(quiet);
  CHECK(says(message_of([&] { other.step(x, y, z); }), "the generator takes no noise"));
  CHECK(rollout.step(x, y, z).shape() == Shape{8, 4, 6});
}

}  // namespace attention_rollout_test
