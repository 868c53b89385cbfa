// What a training will need, found before it starts: parameters, memory, operations and time.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/clock.hpp"
#include "motiongan/train/trainer.hpp"

namespace motiongan {

/// What a training needs. Large batches are extrapolated, hence no whole numbers.
struct TrainingCost {
  std::vector<std::pair<std::string, std::size_t>> parameters;  ///< of each network, by its name
  double device_bytes = 0;    ///< most memory that an iteration takes on the device, with the pool's cache
  double device_in_use = 0;   ///< the same without the cache, which the pool gives up if it must
  double largest_buffer = 0;  ///< bytes of the largest buffer on the device
  double host_bytes = 0;      ///< of uploads, and of a checkpoint while it is written
  double flops = 0;           ///< floating-point operations of an iteration, in matrix products
};

/// Receives a trainer that was built for a trial.
using TrainerUse = std::function<void(Trainer& trainer)>;

namespace detail {

/// Larger batches are extrapolated from this one and its half: the memory for a batch grows evenly with it.
constexpr std::size_t largest_trial_batch = 16384;
/// Iterations of more steps of a kind count as so many times an iteration of this many.
constexpr std::size_t most_trial_steps = 16;

/// The options with another batch, and at most `steps` critic and generator steps.
template <class TrainOptions>
TrainOptions trial_options(TrainOptions options, std::size_t batch, std::size_t steps) {
  options.batch = batch;
  if constexpr (requires { options.critic_steps; })
    options.critic_steps = std::min(options.critic_steps, steps);
  if constexpr (requires { options.generator_steps; })
    options.generator_steps = std::min(options.generator_steps, steps);
  return options;
}

/// Counts an iteration in a context that only counts.
template <class TrainOptions, class Build>
TrainingCost count_iteration(const Context& context, const TrainOptions& options, const Build& build) {
  TrainingCost cost;
  std::size_t count = 0;
  build(context, options, TrainerUse([&](Trainer& trainer) {
          for (const TrainedPart& part : trainer.parts()) {
            cost.parameters.emplace_back(part.name, parameter_count(part.parameters));
            count += cost.parameters.back().second;
          }
          const ContextStatistics before = context.statistics();
          trainer.iterate();
          const ContextStatistics& now = context.statistics();
          cost.flops = now.gemm_flops - before.gemm_flops;
          const double written = static_cast<double>(now.bytes_written - before.bytes_written),
                       writes = static_cast<double>(std::max<std::size_t>(now.writes - before.writes, 1));
          // The initial weights and the clips, then the last 64 uploads; the state of Adam in a checkpoint.
          cost.host_bytes = static_cast<double>(before.bytes_written) + 64 * written / writes +
                            3.0 * static_cast<double>(count * context.real_size());
          trainer.iterate();  // while the losses of the iteration before are still there
        }));
  const ContextStatistics& all = context.statistics();
  cost.device_bytes = static_cast<double>(all.peak_bytes);
  cost.device_in_use = static_cast<double>(all.peak_in_use);
  cost.largest_buffer = static_cast<double>(all.largest_buffer);
  return cost;
}

}  // namespace detail

/// Counts what a training needs, exactly but for batches above 16384 and for captions longer than those of
/// its first two iterations. Nothing is computed. `build(context, options, use)` makes the model and its
/// trainer and calls `use(trainer)`; it is called with a context like `like` that only counts and with
/// options for a trial. Throws Error if an option is out of range or `build` does.
template <class TrainOptions, class Build>
TrainingCost training_cost(const Context& like, const TrainOptions& options, const Build& build) {
  check_options(options);
  check_iterations(options.iterations, options.steps());
  const auto count = [&](std::size_t batch) {
    const auto trial = detail::trial_options(options, batch, detail::most_trial_steps);
    TrainingCost cost = detail::count_iteration(like.counting(), trial, build);
    cost.flops *= static_cast<double>(options.steps()) / static_cast<double>(trial.steps());
    return cost;
  };
  constexpr std::size_t most = detail::largest_trial_batch;
  TrainingCost cost = count(std::min(options.batch, most));
  if (options.batch > most) {
    const TrainingCost half = count(most / 2);
    const double halves = static_cast<double>(options.batch - most) / (most / 2.0);
    for (double TrainingCost::*part :
         {&TrainingCost::device_bytes, &TrainingCost::device_in_use, &TrainingCost::largest_buffer,
          &TrainingCost::host_bytes, &TrainingCost::flops})
      cost.*part += halves * std::max(0.0, cost.*part - half.*part);
  }
  return cost;
}

/// Whether an iteration fits the device of `context` and its memory limit; `cost` and `build` as above.
template <class TrainOptions, class Build>
bool fits_device(const Context& context, const TrainOptions& options, const Build& build,
                 const TrainingCost& cost) {
  const double elements = static_cast<double>(context.element_limit());
  if (cost.largest_buffer > elements * static_cast<double>(context.real_size())) return false;
  if (cost.device_in_use <= static_cast<double>(context.memory_limit()) &&
      cost.largest_buffer <= static_cast<double>(context.device().max_allocation))
    return true;
  if (options.batch > detail::largest_trial_batch) return false;
  try {  // near its limit the pool gives out other buffers, so that only a trial within it tells
    const auto trial = detail::trial_options(options, options.batch, detail::most_trial_steps);
    detail::count_iteration(context.counting(true), trial, build);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// The seconds that an iteration is expected to take: an iteration with a single step of each kind is timed
/// on the device, after another one that builds the kernels, and the time scaled by the operations. `build`
/// as in training_cost(), `flops` from there.
template <class TrainOptions, class Build>
double iteration_seconds(const Context& context, const TrainOptions& options, const Build& build,
                         double flops) {
  double seconds = 0;
  build(context, detail::trial_options(options, options.batch, 1), TrainerUse([&](Trainer& trainer) {
          trainer.iterate();
          context.finish();
          const double before = context.statistics().gemm_flops, start = clock_seconds();
          trainer.iterate();
          context.finish();
          seconds = clock_seconds() - start;
          if (const double timed = context.statistics().gemm_flops - before; timed > 0)
            seconds *= flops / timed;
        }));
  return seconds;
}

}  // namespace motiongan
