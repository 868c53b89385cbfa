// Two Contexts in two threads: training and sampling give the same bits as one after the other. The preset
// tsan builds this test with the thread sanitizer.
#include <doctest/doctest.h>

#include <exception>
#include <motiongan/train/train.hpp>
#include <thread>

#include "../support/small_data.hpp"

namespace threads_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

/// What a short training with its own Context arrives at.
struct Result {
  std::vector<std::vector<float>> parameters;
  std::vector<float> sample;
  std::size_t words = 0;
  std::exception_ptr error;
  bool operator==(const Result& other) const {
    return parameters == other.parameters && sample == other.sample && words == other.words;
  }
};

Result train(std::uint64_t seed, bool rnn) {
  Result result;
  try {
    const Context context;
    const motion::Dataset data = motion::Dataset::from_motions(
        motion::procedural_motions({.clips = 4, .seconds = 4, .rate = 8, .seed = seed}),
        {.frames = 8, .rate = 4});
    Dvgan model(context, data.format,
                {.generator = rnn ? GeneratorKind::rnn : GeneratorKind::cnn, .hidden = 4});
    DvganTrainer trainer(model, data, {.iterations = 2, .critic_steps = 1, .batch = 2, .seed = seed});
    for (int i = 0; i < 2; ++i) trainer.iterate();
    result.parameters = all_values(model);
    for (const NamedLoss& loss : trainer.named_losses())
      result.sample.push_back(static_cast<float>(loss.value));
    result.words = data.format.vocabulary.size();
    message_of([&] { Context({.device = "no such device"}); });  // errors are formatted at the same time, too
  } catch (...) {
    result.error = std::current_exception();
  }
  return result;
}

}  // namespace

TEST_CASE("training in two threads at once gives the same bits as one after the other") {
  Result a, b;  // at once first: what is made once is made by both
  std::thread first([&] { a = train(1, false); });
  std::thread second([&] { b = train(2, true); });
  first.join();
  second.join();
  for (const Result* result : {&a, &b})
    if (result->error) std::rethrow_exception(result->error);
  CHECK(a == train(1, false));
  CHECK(b == train(2, true));
  CHECK_FALSE(a.parameters.empty());
  CHECK(a.parameters != b.parameters);
}

}  // namespace threads_test
