// What a training needs, counted without doing it: as a real one finds.
#include <doctest/doctest.h>

#include <motiongan/train/attention_trainer.hpp>
#include <motiongan/train/dvgan_trainer.hpp>
#include <motiongan/train/training_cost.hpp>

#include "../support/small_actions.hpp"
#include "../support/small_data.hpp"

namespace training_cost_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

auto dvgan(const DvganOptions& model, const motion::Dataset& data) {
  return [model, &data](const Context& context, const DvganTrainOptions& options, const TrainerUse& use) {
    Dvgan made(context, data.format, model);
    DvganTrainer trainer(made, data, options);
    use(trainer);
  };
}

void attention(const Context& context, const AttentionTrainOptions& options, const TrainerUse& use) {
  ActionGan model(context, small_actions().format, {.hidden = 8});
  AttentionTrainer trainer(model, small_actions(), options);
  use(trainer);
}

/// The counts must be those of two real iterations.
template <class TrainOptions, class Build>
void check_counts(const TrainOptions& options, const Build& build) {
  const Context context;
  const TrainingCost cost = training_cost(context, options, build);
  CHECK(context.statistics().launches == 0);
  build(context, options, TrainerUse([&](Trainer& trainer) {
          const std::vector<TrainedPart> parts = trainer.parts();
          REQUIRE(cost.parameters.size() == parts.size());
          for (std::size_t i = 0; i < parts.size(); ++i) {
            CHECK(cost.parameters[i].first == parts[i].name);
            CHECK(cost.parameters[i].second == parameter_count(parts[i].parameters));
          }
          const double before = context.statistics().gemm_flops;
          trainer.iterate();
          CHECK(cost.flops == context.statistics().gemm_flops - before);
          trainer.iterate();
        }));
  const ContextStatistics& real = context.statistics();
  CHECK(cost.flops > 0);
  CHECK(cost.device_bytes == static_cast<double>(real.peak_bytes));
  CHECK(cost.device_in_use == static_cast<double>(real.peak_in_use));
  CHECK(cost.largest_buffer == static_cast<double>(real.largest_buffer));
  CHECK(cost.device_in_use < cost.device_bytes);
}

}  // namespace

TEST_CASE("parameters, memory and operations are those of a real training") {
  SUBCASE("convolutions") {
    check_counts(DvganTrainOptions{.critic_steps = 2, .batch = 5}, dvgan({.hidden = 8}, small_data(16)));
  }
  SUBCASE("recurrent networks") {
    DvganTrainOptions options{.critic_steps = 1, .batch = 3};
    options.critic.critic = CriticKind::rnn;
    check_counts(options, dvgan({.generator = GeneratorKind::rnn, .hidden = 8}, small_data()));
  }
  SUBCASE("attention") { check_counts(AttentionTrainOptions{.critic_steps = 2, .batch = 4}, attention); }
}

TEST_CASE("a context that only counts computes nothing, and fails where the memory ends") {
  const Context context({.memory_limit = 1'000'000});
  const Context counting = context.counting(), limited = context.counting(true);
  CHECK(counting.only_counts());
  CHECK_FALSE(context.only_counts());
  Tensor values(counting, {1000, 1000});
  values.write(std::span<const float>(std::vector<float>(1'000'000, 1.0f)));
  CHECK(counting.statistics().bytes_written == 4'000'000);
  CHECK(values.to_host().front() == 0);
  CHECK(counting.statistics().bytes_in_use == 4'001'792);
  CHECK(context.statistics().bytes_in_use == 0);
  CHECK(says(message_of([&] { Tensor(limited, {1000, 1000}); }), "out of device memory"));
  CHECK(says(message_of([&] {
               Tensor(counting, {std::size_t{1} << 40, std::size_t{1} << 40});
             }),
             "use a smaller batch"));
}

TEST_CASE("a network and a batch that no computer holds are counted in no time") {
  const Context context;
  DvganTrainOptions options{.batch = std::size_t{1} << 60};
  const double start = clock_seconds();
  const TrainingCost large = training_cost(context, options, dvgan({.hidden = 65536}, small_data(16)));
  CHECK(clock_seconds() - start < 5);
  CHECK(large.parameters.front().second > std::size_t{1} << 32);
  CHECK(large.device_in_use > 1e20);
  CHECK(large.flops > 1e25);
}

TEST_CASE("whether an iteration fits the memory limit") {
  const auto build = dvgan({.hidden = 8}, small_data(16));
  const DvganTrainOptions options{.critic_steps = 1, .batch = 4};
  const auto fits = [&](std::size_t limit, const DvganTrainOptions& o) {
    const Context context({.memory_limit = limit});
    return fits_device(context, o, build, training_cost(context, o, build));
  };
  const TrainingCost cost = training_cost(Context(), options, build);
  const auto need = static_cast<std::size_t>(cost.device_in_use);
  CHECK(fits(need, options));  // the pool gives up its cache
  CHECK_FALSE(fits(need / 2, options));
  CHECK_FALSE(fits(std::size_t{1} << 34, DvganTrainOptions{.critic_steps = 1, .batch = 100'000'000}));
}

TEST_CASE("large batches and many steps are extrapolated") {
  const Context context;
  const auto build = dvgan({.hidden = 8}, small_data(16));
  const auto cost = [&](std::size_t batch, std::size_t steps) {
    return training_cost(context, DvganTrainOptions{.critic_steps = steps, .batch = batch}, build);
  };
  const TrainingCost one = cost(16384, 1), four = cost(65536, 1);
  CHECK(four.device_in_use / one.device_in_use == doctest::Approx(4).epsilon(0.02));
  CHECK(four.flops / one.flops == doctest::Approx(4).epsilon(0.02));
  CHECK(cost(4, 160).flops / cost(4, 16).flops == doctest::Approx(10).epsilon(0.1));
  CHECK(cost(4, 160).device_bytes == cost(4, 16).device_bytes);
}

TEST_CASE("the time of an iteration is that of a short one, scaled") {
  const Context context;
  const DvganTrainOptions options{.critic_steps = 4, .batch = 4};
  const auto build = dvgan({.hidden = 8}, small_data(16));
  const double flops = training_cost(context, options, build).flops;
  CHECK(iteration_seconds(context, options, build, flops) > 0);
  CHECK(context.statistics().gemm_flops < flops);  // two iterations of two steps, not five
}

TEST_CASE("more iterations than there are random numbers are refused before anything is built") {
  const Context context;
  DvganTrainOptions options{.iterations = ~std::size_t{0}};
  const auto never = [](const Context&, const DvganTrainOptions&, const TrainerUse&) { FAIL("built"); };
  CHECK(says(message_of([&] { training_cost(context, options, never); }), "random numbers count 2^24 steps"));
  options = {.critic_steps = ~std::size_t{0}};
  CHECK(says(message_of([&] { training_cost(context, options, never); }), "lower critic_steps"));
}

}  // namespace training_cost_test
