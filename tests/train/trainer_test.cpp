// Training steps of DVGAN: what they change, bit-for-bit repeatability, no allocations and no read-back.
#include <doctest/doctest.h>

#include <motiongan/train/train.hpp>

#include "../support/small_data.hpp"

namespace trainer_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

const DvganTrainOptions small_options{.iterations = 1000, .critic_steps = 2, .batch = 4};

/// A model and its trainer with their own context.
struct Run {
  Context context;
  Dvgan model;
  DvganTrainer trainer;
  explicit Run(const DvganTrainOptions& options = small_options, const DvganOptions& sizes = {.hidden = 8})
      : model(context, small_data().format, sizes), trainer(model, small_data(), options) {}
  std::vector<std::vector<float>> generator() { return all_values(model); }
  std::vector<std::vector<float>> critic() { return all_values(trainer.critic()); }
};

}  // namespace

TEST_CASE("two runs with equal options are equal bit for bit") {
  for (const DvganTrainOptions& options :
       {small_options,
        DvganTrainOptions{
            .critic_steps = 1, .batch = 3, .input_shift = false, .critic = {.validation = Validation::mod2}},
        DvganTrainOptions{.critic_steps = 1,
        .batch = 5,
        .critic = {.validation = Validation::final, .level_weights = LevelWeights::softmax}}}) {
    Run a(options), b(options);
    for (int i = 0; i < 4; ++i) {
      a.trainer.iterate();
      b.trainer.iterate();
      a.trainer.losses();  // reading losses changes nothing
    }
    CHECK(a.generator() == b.generator());
    CHECK(a.critic() == b.critic());
    const DvganLosses x = a.trainer.losses(), y = b.trainer.losses();
    CHECK(x.wasserstein == y.wasserstein);
    CHECK(x.penalty == y.penalty);
    CHECK(x.generator == y.generator);
  }
  for (const bool cut : {false, true}) {
    const DvganTrainOptions options{
        .critic_steps = 1, .batch = 3, .critic = {.critic = cut ? CriticKind::cnn : CriticKind::rnn}};
    const DvganOptions sizes{.generator = GeneratorKind::rnn, .hidden = 8, .final_cut = cut};
    Run a(options, sizes), b(options, sizes);
    for (int i = 0; i < 3; ++i) {
      a.trainer.iterate();
      b.trainer.iterate();
    }
    CHECK(a.generator() == b.generator());
    CHECK(a.critic() == b.critic());
    CHECK(std::isfinite(a.trainer.losses().wasserstein));
  }
  DvganTrainOptions other = small_options;
  other.seed = 2;
  Run a, b(other);
  a.trainer.iterate();
  b.trainer.iterate();
  CHECK(a.generator() != b.generator());
}

void check_what_steps_change(Run run) {
  const auto generator = run.generator(), critic = run.critic();
  run.trainer.critic_step(0);
  CHECK(run.generator() == generator);
  const auto after = run.critic();
  for (std::size_t i = 0; i < after.size(); ++i) {
    // A constant added to every score changes neither loss nor penalty, so its gradient is zero.
    const std::string name = named_parameters(run.trainer.critic())[i].name;
    CAPTURE(name);
    if (!name.ends_with("score.bias")) CHECK(after[i] != critic[i]);
  }
  run.trainer.generator_step(1);
  CHECK(run.critic() == after);
  const auto moved = run.generator();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    CAPTURE(named_parameters(run.model)[i].name);
    CHECK(moved[i] != generator[i]);
  }
}

TEST_CASE("a critic step changes only the critic, a generator step only the generator") {
  check_what_steps_change(Run());
  check_what_steps_change(Run({.critic_steps = 2, .batch = 4, .critic = {.critic = CriticKind::rnn}},
                              {.generator = GeneratorKind::rnn, .hidden = 8}));
}

TEST_CASE("the generator's gradient costs the same when the critic's parameters are constants") {
  Run run;
  const Context& context = run.context;
  const CnnGenerator& generator = run.model.cnn();
  const std::size_t words = small_data().format.vocabulary.size();
  const Sentences text(context, {{1, 2}, {3}}, words);
  const auto launches = [&](const std::vector<Var>& wanted) {
    const Indices cut = generator.cuts(context, {}, 2);
    Var h_txt;
    {
      const NoGrad values_only;
      h_txt = run.trainer.critic().encode_text(text);
    }
    const Var loss = generator_loss(
        run.trainer.critic()(generator(text, generator.noise(context, {}, 2, cut), cut), h_txt));
    const std::size_t before = context.statistics().launches;
    grad(loss, wanted);
    return context.statistics().launches - before;
  };
  const std::vector<Var> of_generator = values_of(named_parameters(run.model));
  std::vector<Var> of_both = of_generator;
  for (const NamedParameter& p : named_parameters(run.trainer.critic()))
    if (!p.name.starts_with("text.")) of_both.push_back(*p.value);
  const std::size_t alone = launches(of_generator), both = launches(of_both);
  for (const NamedParameter& p : named_parameters(run.trainer.critic())) *p.value = p.value->detach();
  CHECK(launches(of_generator) == alone);
  CHECK(both > alone + 20);
}

TEST_CASE("the Wasserstein estimate starts near zero and grows while only the critic learns") {
  DvganTrainOptions options{.critic_steps = 1, .batch = 16};
  options.adam.learning_rate = 1e-3;
  Run run(options, {.hidden = 16});
  run.trainer.iterate();
  const double first = run.trainer.losses().wasserstein;
  for (std::uint32_t step = 2; step < 150; ++step) run.trainer.critic_step(step);
  const double later = run.trainer.losses().wasserstein;
  CHECK(std::abs(first) < 0.3);
  CHECK(later > 1);
  CHECK(run.trainer.losses().penalty < 1);
}

TEST_CASE("steady state: no allocation, no read-back, memory flat over 2,000 iterations") {
  Run run({.iterations = 2100, .critic_steps = 1, .batch = 2});
  const ContextStatistics& now = run.context.statistics();
  for (int i = 0; i < 100; ++i) run.trainer.iterate();  // every length of sentence has been seen
  const ContextStatistics warm = now;
  bool flat = true;
  for (int i = 0; i < 2000; ++i) {
    run.trainer.iterate();
    flat = flat && now.bytes_in_use == warm.bytes_in_use;
  }
  CHECK(flat);
  CHECK(now.allocations == warm.allocations);
  CHECK(now.reads == warm.reads);
  CHECK(now.peak_bytes == warm.peak_bytes);
  CHECK(std::isfinite(run.trainer.losses().wasserstein));
  CHECK(now.reads == warm.reads + 3);  // losses() reads three values
}

TEST_CASE("steady state of the recurrent networks") {
  Run run({.iterations = 300, .critic_steps = 1, .batch = 2, .critic = {.critic = CriticKind::rnn}},
          {.generator = GeneratorKind::rnn, .hidden = 8});
  const ContextStatistics& now = run.context.statistics();
  for (int i = 0; i < 200; ++i) run.trainer.iterate();  // every length of sentence has been seen
  const ContextStatistics warm = now;
  for (int i = 0; i < 50; ++i) run.trainer.iterate();
  CHECK(now.allocations == warm.allocations);
  CHECK(now.reads == warm.reads);
  CHECK(now.bytes_in_use == warm.bytes_in_use);
}

TEST_CASE("completions in training: fakes begin with the real frames") {
  const DvganOptions sizes{.generator = GeneratorKind::rnn, .hidden = 8};
  const auto options = [](double share) {
    return DvganTrainOptions{.critic_steps = 2, .batch = 3, .completion_share = share};
  };
  Run none(options(0), sizes), all(options(1), sizes), again(options(1), sizes);
  for (Run* run : {&none, &all, &again})
    for (int i = 0; i < 2; ++i) run->trainer.iterate();
  CHECK(all.generator() != none.generator());
  CHECK(all.generator() == again.generator());
  // Completions use no initial pose, so the parameters that make it stay as they are.
  const auto first = Run(options(1), sizes).generator(), after = all.generator();
  const auto parameters = named_parameters(all.model);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const std::string& name = parameters[i].name;
    CAPTURE(name);
    CHECK((after[i] == first[i]) == (name.starts_with("initial_plot.") || name.starts_with("decode.")));
  }
  const NoGrad values_only;
  const CaptionedBatch batch = WindowSampler(all.context, small_data()).draw(1, 0, 2);
  const std::vector<float> fake =
      all.model.complete(batch.text, slice(Var::constant(batch.motion), 0, 0, 3), {}).value().to_host();
  const std::vector<float> real = batch.motion.to_host();
  const auto given = static_cast<std::ptrdiff_t>(3 * 2 * small_data().format.dof());
  CHECK(std::equal(real.begin(), real.begin() + given, fake.begin()));
  CHECK(fake != real);
  CHECK(says(message_of([&] { Run(options(0.5)); }), "CNN generator"));
  CHECK(says(message_of([&] { Run(options(1.5), sizes); }), "1.5"));
}

TEST_CASE("windows are a function of seed and step, and are real windows of the training clips") {
  const Context context;
  const motion::Dataset& data = small_data();
  const WindowSampler sampler(context, data);
  const std::size_t dof = data.format.dof(), size = 6;
  const CaptionedBatch batch = sampler.draw(1, 5, size);
  CHECK(sampler.draw(1, 5, size).motion.to_host() == batch.motion.to_host());
  CHECK(sampler.draw(1, 6, size).motion.to_host() != batch.motion.to_host());
  CHECK(sampler.draw(2, 5, size).motion.to_host() != batch.motion.to_host());
  CHECK(sampler.draw(1, 5, 2).motion.shape() == Shape{8, 2, dof});
  const std::vector<float> poses = batch.motion.to_host();
  const std::vector<cl_int> lengths = batch.text.lengths.to_host(), words = batch.text.words.to_host();
  for (std::size_t b = 0; b < size; ++b) {
    std::vector<float> drawn(8 * dof), window(8 * dof);
    for (std::size_t t = 0; t < 8; ++t)
      for (std::size_t d = 0; d < dof; ++d) drawn[t * dof + d] = poses[(t * size + b) * dof + d];
    std::vector<int> sentence;
    for (cl_int t = 0; t < lengths[b]; ++t) sentence.push_back(words[static_cast<std::size_t>(t) * size + b]);
    bool found = false;
    for (const motion::DatasetClip& clip : data.train)
      for (std::size_t start = 0; start < data.starts(clip) && !found; ++start) {
        data.window(clip, start, window);
        bool equal = true;  // up to rounding: the device rotates in float
        for (std::size_t i = 0; i < window.size(); ++i)
          equal = equal && std::abs(window[i] - drawn[i]) < 1e-4f;
        found = equal &&
                std::find(clip.sentences.begin(), clip.sentences.end(), sentence) != clip.sentences.end();
      }
    CHECK(found);
  }
}

TEST_CASE("invalid options are refused") {
  const auto refusal = [](const DvganTrainOptions& options) { return message_of([&] { Run run(options); }); };
  CHECK(says(refusal({.critic_steps = 0}), "critic_steps is 0, expected at least 1"));
  CHECK(says(refusal({.batch = 0}), "batch is 0, expected at least 1"));
  CHECK(says(refusal({.iterations = 10'000'000}), "iterations is 10000000, expected at most"));
  Run run;
  CHECK(says(message_of([&] { run.trainer.losses(); }), "no iteration has run yet"));
  CHECK(says(message_of([&] { DvganTrainer(run.model, small_data(16), small_options); }),
             "does not fit the model"));
  CHECK(says(message_of([&] { train(run.model, small_data(), small_options, {.log_every = 0}); }),
             "log_every"));
}

}  // namespace trainer_test
