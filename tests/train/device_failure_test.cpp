// A device that fails in the middle of training: the error is clean, nothing leaks, and training goes on.
#include <doctest/doctest.h>

#include <unistd.h>

#include <motiongan/train/train.hpp>

#include "../support/small_data.hpp"

namespace device_failure_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

const DvganTrainOptions tiny_options{.iterations = 3, .critic_steps = 1, .batch = 2};
const DvganOptions tiny_sizes{.hidden = 4};

struct Parameters {
  std::vector<std::vector<float>> generator, critic;
  bool operator==(const Parameters&) const = default;
};

/// The parameters after one iteration from the start.
Parameters one_iteration(const Context& context) {
  Dvgan model(context, small_data().format, tiny_sizes);
  DvganTrainer trainer(model, small_data(), tiny_options);
  trainer.iterate();
  return {all_values(model), all_values(trainer.critic())};
}

}  // namespace

TEST_CASE("every buffer of an iteration can fail, and an iteration after it is as one before") {
  const Context context;
  const auto& now = context.statistics();
  const Parameters right = one_iteration(context);
  std::size_t failed = 0;
  for (std::size_t n = 1; n <= 1000; ++n) {
    context.trim();  // so that the driver is asked for every buffer
    context.fail_allocation(n);
    try {
      one_iteration(context);
      break;  // it needs fewer than n
    } catch (const DeviceError& error) {
      CHECK(says(error.what(), "CL_MEM_OBJECT_ALLOCATION_FAILURE"));
    }
    ++failed;
    CHECK(now.bytes_in_use == 0);
    context.fail_allocation(0);
    if (n % 4 == 0) CHECK(one_iteration(context) == right);
  }
  CHECK(failed > 100);
  CHECK(failed < 1000);
  context.fail_allocation(0);
  CHECK(one_iteration(context) == right);
}

TEST_CASE("a run whose device fails says where it stopped and resumes from its checkpoint") {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / concat("motiongan-device-", getpid());
  const RunFiles files{folder};
  const auto no_split = [](const std::filesystem::path&) {};
  const auto run = [&](bool resume, std::size_t fail_in, double every) {
    const Context context;
    Dvgan model(context, small_data().format, tiny_sizes);
    DvganTrainer trainer(model, small_data(), tiny_options);
    RunOptions options{.save_dir = folder, .resume = resume, .save_every_minutes = every};
    options.callbacks = {[&](const Trainer& t) {
      if (t.iteration() + 1 == fail_in) context.trim(), context.fail_allocation(1);
      return false;
    }};
    const std::string text = message_of([&] { run_training(trainer, no_split, options); });
    return std::pair(text, all_values(model));
  };
  std::filesystem::remove_all(folder);
  const auto whole = run(false, 0, 5);
  CHECK(whole.first == "no error");

  std::filesystem::remove_all(folder);
  CHECK(says(run(false, 2, 5).first,
             concat("\nthe run stopped after iteration 1; no checkpoint was written to ", folder.string())));
  CHECK_FALSE(std::filesystem::exists(files.checkpoint()));

  std::filesystem::remove_all(folder);
  const std::string text = run(false, 3, 1e-9).first;
  CHECK(says(text, "CL_MEM_OBJECT_ALLOCATION_FAILURE"));
  CHECK(says(text, concat("\nthe run stopped after iteration 2; the last checkpoint in ", folder.string(),
                          " is kept: resume the run from it")));
  const auto rest = run(true, 0, 5);
  CHECK(rest.first == "no error");
  CHECK(rest.second == whole.second);
  std::filesystem::remove_all(folder);
}

TEST_CASE("host memory that runs out stops a run in the same way") {
  const Context context;
  Dvgan model(context, small_data().format, tiny_sizes);
  DvganTrainer trainer(model, small_data(), tiny_options);
  RunOptions options;
  options.callbacks = {[](const Trainer&) -> bool { throw std::bad_alloc(); }};
  const auto no_split = [](const std::filesystem::path&) {};
  const std::string text = message_of([&] { run_training(trainer, no_split, options); });
  CHECK(says(text, "out of host memory"));
  CHECK(says(text, "\nthe run stopped after iteration 1; nothing of it was saved"));
}

}  // namespace device_failure_test
