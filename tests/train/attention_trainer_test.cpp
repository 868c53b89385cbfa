// Training of the action models: what is frozen, what the options do, resuming bit for bit.
#include <doctest/doctest.h>

#include <filesystem>
#include <motiongan/train/train.hpp>
#include <numeric>
#include <set>

#include "../support/folders.hpp"
#include "../support/small_actions.hpp"

namespace attention_trainer_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

const AttentionTrainOptions small_options{.iterations = 4, .critic_steps = 2, .batch = 4};

struct Run {
  Context context;
  ActionGan model;
  AttentionTrainer trainer;
  explicit Run(const AttentionTrainOptions& options = small_options,
               const ActionGanOptions& gan = {.hidden = 8})
      : model(context, small_actions().format, gan), trainer(model, small_actions(), options) {}
};

std::vector<std::vector<float>> state(AttentionTrainer& trainer) {
  std::vector<std::vector<float>> all;
  for (const TrainedPart& part : trainer.parts()) {
    for (const NamedParameter& p : part.parameters) all.push_back(p.value->value().to_host());
    for (const auto& [name, tensor] : part.optimizer->state()) all.push_back(tensor.to_host());
  }
  return all;
}

}  // namespace

TEST_CASE("a step changes only its own network") {
  Run run;
  const auto generator = values_in(run.model), critic = values_in(run.trainer.critic()),
             classifier = values_in(run.trainer.classifier());
  run.trainer.critic_step(0);
  CHECK(values_in(run.model) == generator);
  CHECK(values_in(run.trainer.classifier()) == classifier);
  const auto critic_after = values_in(run.trainer.critic());
  CHECK(critic_after != critic);
  run.trainer.classifier_step(1);
  CHECK(values_in(run.trainer.critic()) == critic_after);
  CHECK(values_in(run.model) == generator);
  const auto classifier_after = values_in(run.trainer.classifier());
  CHECK(classifier_after != classifier);
  run.trainer.generator_step(2);
  CHECK(values_in(run.trainer.critic()) == critic_after);
  CHECK(values_in(run.trainer.classifier()) == classifier_after);
  CHECK(values_in(run.model) != generator);
}

TEST_CASE("the generator step computes no gradient of critic and classifier") {
  Run run;
  const ActionSampler windows(run.context, small_actions(), small_actions().train);
  const ActionBatch batch = windows.draw(1, 0, 4);
  const auto critic = values_of(named_parameters(run.trainer.critic()));
  const auto generator = values_of(named_parameters(run.model));
  {
    const Frozen critic_fixed(named_parameters(run.trainer.critic()));
    const auto loss = run.trainer.generator_loss_of(batch, 0);
    // Asking for one is an error.
    CHECK(says(message_of([&] { grad(loss.total, critic); }), "is frozen"));
  }
  CHECK(critic.front().node()->frozen == 0);  // unfrozen again

  // Nor is it computed and discarded: the backward pass does as much arithmetic as with constant weights.
  const auto products = [&] {
    const auto loss = run.trainer.generator_loss_of(batch, 0);
    const double before = run.context.statistics().gemm_flops;
    grad(loss.total, generator);
    return run.context.statistics().gemm_flops - before;
  };
  const Var motion = Var::leaf(batch.motion);
  const auto flops_of_gradient = [&](const std::vector<Var>& by) {
    const Var score = mean(run.trainer.critic()(motion));
    const double before = run.context.statistics().gemm_flops;
    grad(score, by);
    return run.context.statistics().gemm_flops - before;
  };
  std::vector<Var> with_weights = critic;
  with_weights.push_back(motion);
  CHECK(flops_of_gradient(with_weights) > 1.5 * flops_of_gradient({motion}));  // the cost of weight gradients

  const double variable = products();
  CHECK(variable > 0);
  for (const NamedParameter& p : named_parameters(run.trainer.critic())) *p.value = p.value->detach();
  for (const NamedParameter& p : named_parameters(run.trainer.classifier())) *p.value = p.value->detach();
  CHECK(products() == variable);
}

TEST_CASE("losses equal their definitions, averaged over the rollouts") {
  Run run({.critic_steps = 1,
           .batch = 3,
           .rollouts = 2,
           .skeleton_weight = 0.5,
           .blend_weight = 2,
           .class_weight = 3});
  const ActionSampler windows(run.context, small_actions(), small_actions().train);
  const ActionBatch batch = windows.draw(1, 0, 3);
  const auto loss = run.trainer.generator_loss_of(batch, 0);
  const Var classes = Var::constant(batch.classes), prior = Var::constant(batch.prior);
  const Var first = run.model.forward(prior, classes), second = run.model.forward(first, classes);
  const auto score = [&](const Var& a, const Var& b) {
    return mean(run.trainer.critic()(concatenate({a, b}, 0))).item();
  };
  const SkeletonLoss skeleton(run.context, run.model.format());
  const double adversarial = -(score(prior, first) + score(first, second)) / 2,
               skel = (skeleton(prior, first).item() + skeleton(prior, second).item()) / 2,
               blend = (blend_loss(prior, first).item() + blend_loss(first, second).item()) / 2,
               wrong = (cross_entropy(run.trainer.classifier()(first), classes).item() +
                        cross_entropy(run.trainer.classifier()(second), classes).item()) /
                       2;
  CHECK(loss.adversarial.item() == doctest::Approx(adversarial).epsilon(1e-4));
  CHECK(loss.skeleton.item() == doctest::Approx(skel).epsilon(1e-4));
  CHECK(loss.blend.item() == doctest::Approx(blend).epsilon(1e-4));
  CHECK(loss.classification.item() == doctest::Approx(wrong).epsilon(1e-4));
  CHECK(loss.total.item() == doctest::Approx(adversarial + 0.5 * skel + 2 * blend + 3 * wrong).epsilon(1e-4));
}

TEST_CASE("the losses on what is seen see the seam") {
  const BodyLossOptions body{.smooth = 0.5, .contact = 2};
  Run without({.critic_steps = 1, .batch = 3, .rollouts = 1});
  Run with({.critic_steps = 1, .batch = 3, .rollouts = 1, .body = body});
  const auto total = [](Run& run) {
    const ActionSampler windows(run.context, small_actions(), small_actions().train);
    return run.trainer.generator_loss_of(windows.draw(1, 0, 3), 0).total.item();
  };
  const ActionSampler windows(with.context, small_actions(), small_actions().train);
  const ActionBatch batch = windows.draw(1, 0, 3);
  const Var prior = Var::constant(batch.prior),
            made = with.model.forward(prior, Var::constant(batch.classes));
  const auto after = [&](const Var& future) { return concatenate({slice(prior, 0, 3, 3), future}, 0); };
  const BodyLosses losses(with.model.format(), body, windows.draw(1, 0, 256).future);
  const double expected = losses(after(made), after(Var::constant(batch.future))).item();
  CHECK(expected > 0);
  CHECK(total(with) - total(without) == doctest::Approx(expected).epsilon(1e-4));
}

TEST_CASE("without the root's track a body can tremble, but its feet have no height") {
  const motion::ActionDataset data = make_small_actions(false);
  ActionGan model(Context(), data.format, {.hidden = 8});
  AttentionTrainOptions options = small_options;
  options.body.smooth = 1;
  AttentionTrainer trainer(model, data, options);
  trainer.iterate();
  CHECK(std::isfinite(trainer.losses().adversarial));
  options.body.contact = 1;
  CHECK(says(message_of([&] { AttentionTrainer(model, data, options); }), "needs the height of the feet"));
}

TEST_CASE("a loss with weight 0 is not computed") {
  Run run({.critic_steps = 1, .batch = 3, .skeleton_weight = 0, .blend_weight = 0, .class_weight = 0});
  run.trainer.iterate();
  const AttentionLosses losses = run.trainer.losses();
  CHECK(losses.skeleton == 0);
  CHECK(losses.blend == 0);
  CHECK(losses.classification == 0);
  CHECK(losses.adversarial != 0);
  CHECK(losses.classifier > 0);
}

TEST_CASE("weight clipping instead of the penalty") {
  Run run({.critic_steps = 2, .batch = 4, .weight_clip = 0.01});
  run.trainer.iterate();
  for (const auto& values : values_in(run.trainer.critic()))
    for (const float v : values) CHECK(std::abs(v) <= 0.01f);
  CHECK(run.trainer.losses().penalty == 0);
  Run penalised;
  penalised.trainer.iterate();
  CHECK(penalised.trainer.losses().penalty > 0);
}

TEST_CASE("every option changes the result") {
  const auto trained = [](const AttentionTrainOptions& options, const ActionGanOptions& gan) {
    Run run(options, gan);
    run.trainer.iterate();
    return values_in(run.model);
  };
  std::set<std::vector<std::vector<float>>> all;
  AttentionTrainOptions o = small_options;
  all.insert(trained(o, {.hidden = 8}));
  all.insert(trained(o, {.hidden = 8, .noise_dim = 3}));
  all.insert(trained(o, {.hidden = 8, .attention = false}));
  all.insert(trained(o, {.hidden = 8, .continues = true}));
  all.insert(trained(o, {.hidden = 8, .exact_bones = true}));
  o.critic_directions = true;
  all.insert(trained(o, {.hidden = 8}));
  o.critic_classes = true;
  all.insert(trained(o, {.hidden = 8}));
  o.rollouts = 3;
  all.insert(trained(o, {.hidden = 8}));
  o.skeleton_vectors = true;
  all.insert(trained(o, {.hidden = 8}));
  o.generator_steps = 2;
  all.insert(trained(o, {.hidden = 8}));
  o.body.smooth = 1;
  all.insert(trained(o, {.hidden = 8}));
  o.body.contact = 1;
  all.insert(trained(o, {.hidden = 8}));
  CHECK(all.size() == 12);
}

TEST_CASE("a resumed run equals an uninterrupted one bit for bit") {
  const Scratch scratch;
  fs::create_directories(scratch.path);
  for (const bool clipped : {false, true}) {
    AttentionTrainOptions options = small_options;
    options.weight_clip = clipped ? 0.05 : 0;
    options.critic_directions = clipped;
    const ActionGanOptions gan{.hidden = 8, .noise_dim = 2, .continues = clipped, .exact_bones = clipped};
    Run unbroken(options, gan), first(options, gan), second(options, gan);
    for (int i = 0; i < 3; ++i) unbroken.trainer.iterate();
    first.trainer.iterate();
    save_checkpoint(first.trainer, scratch.path / "c.safetensors");
    load_checkpoint(second.trainer, scratch.path / "c.safetensors");
    for (int i = 0; i < 2; ++i) second.trainer.iterate();
    CHECK(state(second.trainer) == state(unbroken.trainer));
  }
  Run other({.critic_steps = 3, .batch = 4});
  CHECK(says(message_of([&] { load_checkpoint(other.trainer, scratch.path / "c.safetensors"); }),
             "the run was started with"));
}

TEST_CASE("whole runs write files, a log and a model that loads, for the baseline too") {
  const Scratch scratch;
  const Context context;
  ActionGan model(context, small_actions().format, {.hidden = 8});
  std::size_t reports = 0;
  RunOptions run{.save_dir = scratch.path / "gan"};
  run.report = [&](std::size_t, std::span<const NamedLoss> l) {
    ++reports;
    CHECK(loss_of(l, "accuracy") >= 0);
    CHECK(loss_of(l, "accuracy") <= 1);
  };
  CHECK(train(model, small_actions(), small_options, run).iterations == 4);
  CHECK(reports == 4);
  const RunFiles files{scratch.path / "gan"};
  for (const auto& file : {files.generator(), files.critic(), files.network("classifier"), files.checkpoint(),
                           files.log(), files.split()})
    CHECK(fs::exists(file));
  CHECK(read_csv_log(files.log()).column("gamma").size() == 4);
  ActionGan loaded = ActionGan::load(context, files.generator());
  CHECK(values_in(loaded) == values_in(model));
  ActionGan from_checkpoint = ActionGan::load(context, files.checkpoint());
  CHECK(values_in(from_checkpoint) == values_in(model));

  ActionGan baseline(context, small_actions().format, {.generator = ActionGenerator::lstm, .hidden = 8});
  const BaselineTrainOptions options{.iterations = 80, .batch = 16, .adam = {.learning_rate = 1e-2}};
  train_baseline(baseline, small_actions(), options, RunOptions{.save_dir = scratch.path / "lstm"});
  const auto errors = read_csv_log(scratch.path / "lstm" / "log.csv").column("error");
  const auto mean_of = [&](std::size_t from) {
    return std::accumulate(errors.begin() + static_cast<long>(from),
                           errors.begin() + static_cast<long>(from + 20), 0.0) /
           20;
  };
  CHECK(mean_of(60) < 0.8 * mean_of(0));
  CHECK(ActionGan::load(context, scratch.path / "lstm" / "generator.safetensors").is_baseline());
  CHECK(says(
      message_of([&] { train(baseline, small_actions(), {.iterations = 2, .critic_steps = 1, .batch = 2}); }),
      "LSTM baseline"));
  CHECK(says(message_of([&] { train_baseline(model, small_actions(), options); }), "not the LSTM baseline"));
}

TEST_CASE("windows consist of a prior and its future; classes are balanced") {
  const Context context;
  const ActionSampler windows(context, small_actions(), small_actions().train);
  const ActionBatch batch = windows.draw(3, 7, 200);
  CHECK(batch.motion.to_host() == windows.draw(3, 7, 200).motion.to_host());
  CHECK(batch.motion.to_host() != windows.draw(3, 8, 200).motion.to_host());
  std::size_t ones = 0;
  for (const std::size_t label : batch.labels) ones += label;
  CHECK(ones > 70);
  CHECK(ones < 130);
  // The prior is the first half of the window.
  const auto whole = batch.motion.to_host(), prior = batch.prior.to_host(), future = batch.future.to_host();
  CHECK(std::equal(prior.begin(), prior.end(), whole.begin()));
  CHECK(std::equal(future.begin(), future.end(), whole.begin() + static_cast<std::ptrdiff_t>(prior.size())));
  CHECK(says(message_of([&] { ActionSampler(context, small_actions(), {}); }), "no clips"));
}

TEST_CASE("invalid options are refused") {
  CHECK(says(message_of([] { Run({.batch = 0}); }), "batch is 0, expected at least 1"));
  CHECK(says(message_of([] { Run({.skeleton_weight = -1}); }), "skeleton_weight is -1, expected at least 0"));
  CHECK(says(message_of([] { Run({.iterations = 10'000'000}); }), "random numbers count 2^24 steps"));
  constexpr std::size_t all = ~std::size_t{0};
  for (const auto& [critic, generator] : {std::pair{all, std::size_t{1}}, {all - 1, 1}, {1, all}, {all, all}})
    CHECK(says(message_of([&] { Run({.critic_steps = critic, .generator_steps = generator}); }),
               "an iteration has 18446744073709551615 steps, expected at most 5592405"));
  CHECK(says(message_of([&] { Run({.iterations = all}); }), "expected at most 2396743 with 7 steps each"));
  const Context context;
  CHECK(says(message_of([&] {
               ActionGan(context, small_actions().format,
                         {.generator = ActionGenerator::lstm, .noise_dim = 3});
             }),
             "takes no noise"));
}

}  // namespace attention_trainer_test
