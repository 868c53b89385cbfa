// What a training run keeps whatever happens: saves as sets, divergence, failing disks, interruption.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <motiongan/train/train.hpp>
#include <stdexcept>

#include "../support/folders.hpp"
#include "../support/small_data.hpp"

namespace run_folder_test {

using namespace motiongan;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

/// Trains a small model in one folder, as often as it is called.
struct Run {
  Context context;
  Dvgan model{context, small_data().format, {.hidden = 8}};
  DvganTrainer trainer;
  std::vector<std::string> warnings;
  explicit Run(std::size_t iterations = 4)
      : trainer(model, small_data(), {.iterations = iterations, .critic_steps = 2, .batch = 3}) {}

  RunResult operator()(RunOptions run) {
    run.warn = [&](const std::string& text) { warnings.push_back(text); };
    return run_training(
        trainer, [](const fs::path&) {}, run);
  }
};

/// A callback that does `action` after iteration `at`.
RunCallback after(std::size_t at, std::function<void()> action) {
  return [at, action = std::move(action)](const Trainer& trainer) {
    if (trainer.iteration() == at) action();
    return false;
  };
}

void fill(const Tensor& tensor, float value) {
  Tensor place = tensor;
  place.write(std::span<const float>(std::vector<float>(tensor.size(), value)));
}

std::size_t saved_iteration(const fs::path& checkpoint) { return read_run_record(checkpoint).iteration; }

constexpr double always = 1e-9;  // minutes between saves

}  // namespace

TEST_CASE("a checkpoint that could not be resumed replaces nothing") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  Run run;
  const std::string message = message_of([&] {
    run({.save_dir = files.folder,
         .save_every_minutes = always,
         .log_every = 100,
         .callbacks = {after(
             3, [&] { fill(run.trainer.critic_adam().square(), std::numeric_limits<float>::infinity()); })}});
  });
  CHECK(says(message, "training diverged by iteration 3: the tensor \"adam.critic.square\" holds inf"));
  CHECK(saved_iteration(files.checkpoint()) == 2);
  CHECK(saved_iteration(files.previous_checkpoint()) == 1);
  Run again;
  CHECK(again({.save_dir = files.folder, .resume = true}).iterations == 4);
}

TEST_CASE("of a run with implausible losses the last save before is kept") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  Run run(6);
  run({.save_dir = files.folder, .save_every_minutes = always, .callbacks = {after(2, [&] {
                                                                 for (const NamedParameter& p :
                                                                      named_parameters(run.trainer.critic()))
                                                                   if (p.name.ends_with("score.weight"))
                                                                     fill(p.value->value(), 1e8F);
                                                               })}});
  REQUIRE(run.warnings.size() == 1);
  CHECK(says(run.warnings[0], "training has probably diverged: at iteration 3, "));
  CHECK(saved_iteration(files.checkpoint()) == 6);
  // Iteration 2 was saved after its callback.
  CHECK(saved_iteration(files.previous_checkpoint()) == 2);
  // Resuming goes on keeping it.
  Run again(7);
  again({.save_dir = files.folder, .resume = true});
  CHECK(saved_iteration(files.previous_checkpoint()) == 2);
}

TEST_CASE("a start repairs what a kill between two files of a save left") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  Run()({.save_dir = files.folder, .callbacks = {[](const Trainer& t) { return t.iteration() == 2; }}});
  const auto generator = io::SafeTensors::read(files.generator()),
             critic = io::SafeTensors::read(files.critic());
  io::SafeTensors newer = generator;
  newer.tensors.begin()->second.data[0] ^= std::byte{1};
  newer.write(files.generator());
  fs::remove(files.critic());
  std::ofstream(scratch.path / "generator.safetensors.99-0.tmp") << "half";
  std::ofstream(scratch.path / "own.tmp") << "not of the run";
  Run run;
  run({.save_dir = files.folder,
       .resume = true,
       .callbacks = {[&](const Trainer&) {
         CHECK(io::SafeTensors::read(files.generator()).tensors == generator.tensors);
         CHECK(io::SafeTensors::read(files.generator()).metadata == generator.metadata);
         CHECK(io::SafeTensors::read(files.critic()).tensors == critic.tensors);
         return true;
       }}});
  REQUIRE(run.warnings.size() == 2);
  CHECK(says(run.warnings[0], files.generator().string() + " was missing, damaged or from another save"));
  CHECK_FALSE(fs::exists(scratch.path / "generator.safetensors.99-0.tmp"));
  CHECK(fs::exists(scratch.path / "own.tmp"));
  CHECK(Dvgan::load(run.context, files.generator()).options().hidden == 8);
}

TEST_CASE("a damaged checkpoint names the one before it") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  Run()({.save_dir = files.folder, .save_every_minutes = always});
  {
    std::fstream file(files.checkpoint(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-3, std::ios::end);
    file.put('\x55');
  }
  Run run(5);
  const std::string message = message_of([&] { run({.save_dir = files.folder, .resume = true}); });
  CHECK(says(message, "the file is damaged"));
  CHECK(says(message, "the save before it is " + files.previous_checkpoint().string()));
  fs::rename(files.previous_checkpoint(), files.checkpoint());
  CHECK(run({.save_dir = files.folder, .resume = true}).iterations == 5);
}

TEST_CASE("a periodic save that fails is tried again at the next") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  const fs::path in_the_way = files.generator() / "x";
  Run run;
  const auto result = run({.save_dir = files.folder,
                           .save_every_minutes = always,
                           .callbacks = {after(2,
                                               [&] {
                                                 fs::remove(files.generator());
                                                 fs::create_directories(in_the_way);
                                               }),
                                         after(3, [&] { fs::remove_all(files.generator()); })}});
  CHECK(result.iterations == 4);
  REQUIRE(run.warnings.size() == 1);
  CHECK(says(run.warnings[0], "iteration 2 is not saved, the next save tries again"));
  CHECK(saved_iteration(files.checkpoint()) == 4);
}

TEST_CASE("a run whose report fails is saved first") {
  const Scratch scratch;
  const RunFiles files{scratch.path};
  Run run;
  CHECK_THROWS_WITH_AS(run({.save_dir = files.folder,
                            .report =
                                [](std::size_t iteration, auto) {
                                  if (iteration == 3) throw std::runtime_error("broken pipe");
                                }}),
                       "broken pipe", std::runtime_error);
  CHECK(saved_iteration(files.checkpoint()) == 3);
}

TEST_CASE("two runs cannot share a folder, and a caller's lock is taken over") {
  const Scratch scratch;
  const auto lock = std::make_shared<const io::FolderLock>(scratch.path);
  Run run;
  CHECK(says(message_of([&] { run({.save_dir = scratch.path}); }), "is in use by process "));
  CHECK(run({.save_dir = scratch.path, .lock = lock}).iterations == 4);
}

TEST_CASE("a run interrupted within any iteration goes on to the same bits") {
  const Scratch scratch;
  Run whole;
  whole({.save_dir = scratch.path / "whole"});
  const auto expected = io::SafeTensors::read(RunFiles{scratch.path / "whole"}.checkpoint());
  const RunFiles files{scratch.path / "parts"};
  std::size_t starts = 0, given_up = 0, iterations = 0;
  for (; iterations < 4; ++starts) {
    REQUIRE(starts < 200);
    Run run;
    std::size_t polls = 0;
    const std::size_t before = iterations, most = 150 + 83 * starts;
    iterations = run({.save_dir = files.folder,
                      .resume = starts > 0,
                      .interrupted = [&] { return ++polls > most; },
                      .long_iteration = 0})
                     .iterations;
    given_up += iterations == before;
  }
  CHECK(given_up >= 1);
  CHECK(starts >= 3);
  const auto found = io::SafeTensors::read(files.checkpoint());
  CHECK(found.tensors == expected.tensors);
  CHECK(found.metadata == expected.metadata);
}

TEST_CASE("an interruption does not give up a short iteration") {
  Run run;
  std::size_t polls = 0;
  const RunResult result = run(
      {.interrupted = [&] { return run.trainer.iteration() >= 2 && ++polls > 0; }, .long_iteration = 1000});
  CHECK(result.iterations == 2);
  CHECK(result.stopped);
}

}  // namespace run_folder_test
