// Trainings on several ranks: here threads, which end with the same bits however many they are.
#include <doctest/doctest.h>

#include <atomic>
#include <filesystem>

#include "../support/folders.hpp"
#include "../support/small_actions.hpp"
#include "../support/small_data.hpp"
#include "../support/thread_ranks.hpp"
#include "motiongan/train/train.hpp"

namespace ranks_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

using Weights = std::vector<std::vector<float>>;

/// Trains on every rank, and returns the weights after it, which are equal on all.
template <class Train>
Weights trained(std::size_t ranks, std::size_t shards, const Train& train) {
  std::vector<Weights> all(ranks);
  on_ranks(ranks, [&](const std::shared_ptr<Communicator>& own) {
    all[own->rank()] = train(Parallel{own, shards});
  });
  for (std::size_t r = 1; r < ranks; ++r) CHECK(all[r] == all[0]);
  return all[0];
}

double apart(const Weights& a, const Weights& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      most = std::max(most, std::abs(static_cast<double>(a[i][k]) - static_cast<double>(b[i][k])));
  return most;
}

/// The same bits with 1 and so many ranks; without shards, the same as one rank up to rounding.
template <class Train>
void check_ranks(const Train& train, const std::vector<std::size_t>& numbers = {4}) {
  const Weights alone = trained(1, 8, train);
  for (const std::size_t ranks : numbers) CHECK(trained(ranks, 8, train) == alone);
  const Weights whole = trained(1, 0, train), divided = trained(3, 0, train);
  CHECK(apart(whole, divided) < 2e-3);
  CHECK(apart(whole, alone) < 2e-3);
}

Weights run_dvgan(const Parallel& parallel, GeneratorKind kind, const RunOptions& run = {},
                  std::size_t iterations = 2) {
  const Context context;
  Dvgan model(context, small_data().format, {.generator = kind, .hidden = 8});
  DvganTrainOptions options{.iterations = iterations, .critic_steps = 2, .batch = 24};
  options.completion_share = kind == GeneratorKind::rnn ? 0.5 : 0;
  DvganTrainer trainer(model, small_data(), options);
  trainer.set_parallel(parallel);
  run_training(
      trainer, [](const fs::path& path) { io::AtomicFile(path).commit(); }, run);
  Weights out = all_values(model);
  for (const std::vector<float>& more : all_values(trainer.critic())) out.push_back(more);
  out.push_back(
      {static_cast<float>(trainer.losses().wasserstein), static_cast<float>(trainer.losses().penalty)});
  return out;
}

}  // namespace

TEST_CASE("DVGAN: any number of ranks, the same bits") {
  for (const GeneratorKind kind : {GeneratorKind::cnn, GeneratorKind::rnn})
    check_ranks([&](const Parallel& parallel) { return run_dvgan(parallel, kind); }, {2, 4, 8});
}

TEST_CASE("the ranker, the attention model and its baseline: the same bits") {
  check_ranks([](const Parallel& parallel) {
    const Context context;
    Ranker model(context, small_data().format, {.hidden = 8});
    RankerTrainer trainer(model, small_data(), {.iterations = 3, .batch = 24});
    trainer.set_parallel(parallel);
    run_training(trainer, {}, {});
    Weights out = all_values(model);
    out.push_back({static_cast<float>(trainer.losses().recall1)});
    return out;
  });
  check_ranks([](const Parallel& parallel) {
    const Context context;
    ActionGan model(context, small_actions().format, {.hidden = 8, .noise_dim = 2});
    AttentionTrainer trainer(model, small_actions(), {.iterations = 2, .critic_steps = 2, .batch = 24});
    trainer.set_parallel(parallel);
    run_training(trainer, {}, {});
    Weights out = values_in(model);
    for (const NamedLoss& loss : trainer.named_losses()) out.push_back({static_cast<float>(loss.value)});
    return out;
  });
  check_ranks([](const Parallel& parallel) {
    const Context context;
    ActionGan model(context, small_actions().format, {.generator = ActionGenerator::lstm, .hidden = 8});
    BaselineTrainer trainer(model, small_actions(), {.iterations = 2, .batch = 24});
    trainer.set_parallel(parallel);
    run_training(trainer, {}, {});
    return values_in(model);
  });
}

TEST_CASE("a run is saved once, stops together, and goes on with another number of ranks") {
  const Scratch scratch;
  const fs::path folder = scratch.path / "run";
  const Weights whole =
      trained(1, 8, [](const Parallel& p) { return run_dvgan(p, GeneratorKind::cnn, {}, 4); });
  std::atomic<int> reports = 0;
  const auto part = [&](std::size_t ranks, bool resume) {
    return trained(ranks, 8, [&](const Parallel& p) {
      RunOptions run{.save_dir = folder, .resume = resume};
      run.report = [&](std::size_t, std::span<const NamedLoss>) { ++reports; };
      // Only one rank wants to stop.
      if (!resume) run.should_stop = [&p] { return p.rank() == p.size() - 1; };
      return run_dvgan(p, GeneratorKind::cnn, run, 4);
    });
  };
  part(2, false);
  CHECK(reports == 1);
  CHECK(read_run_record(RunFiles{folder}.checkpoint()).iteration == 1);
  CHECK(part(4, true) == whole);
  CHECK(read_run_record(RunFiles{folder}.checkpoint()).iteration == 4);
}

TEST_CASE("ranks that do not fit together, and a rank that fails") {
  const auto fails = [](const char* why, std::size_t ranks, std::size_t shards, const auto& train) {
    CHECK_THROWS_WITH_AS(trained(ranks, shards, train), doctest::Contains(why), Error);
  };
  const auto plain = [](const Parallel& p) { return run_dvgan(p, GeneratorKind::cnn); };
  fails("a batch of 24 cannot be cut into 5 parts", 5, 0, plain);
  fails("a batch of 24 cannot be cut into 16 shards", 1, 16, plain);
  fails("expected powers of two", 3, 12, plain);
  fails("\"training\" is", 2, 0, [](const Parallel& p) {
    const Context context;
    Dvgan model(context, small_data().format, {.hidden = 8});
    DvganTrainer trainer(model, small_data(),
                         {.iterations = 1, .batch = 24, .lambda_gp = p.is_first() ? 10.0 : 5.0});
    trainer.set_parallel(p);
    try {
      run_training(trainer, {}, {});
    } catch (const Error&) {
      if (!p.is_first()) throw;
    }
    return Weights{};
  });
  fails("the callback fails", 2, 0, [](const Parallel& p) {
    RunOptions run;
    run.callbacks.push_back([](const Trainer&) -> bool { throw Error("the callback fails"); });  // on rank 0
    try {
      return run_dvgan(p, GeneratorKind::cnn, run);
    } catch (const RankError&) {
      CHECK(p.rank() == 1);
      return Weights{};
    }
  });
}

}  // namespace ranks_test
