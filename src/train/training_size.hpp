// Whether a training fits the machine, asked before it is built, and --dry-run.
#pragma once
#include "motiongan/train/training_cost.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// The options of the command line that say how large a training is, with their values, for messages:
/// "--batch (now 64) or --hidden (now 256)".
std::string size_options(std::size_t batch, std::size_t hidden, const char* hidden_option = "--hidden");

/// Throws Error, with what is needed, what there is and the options to `lower`, unless `on_device` and there
/// is host memory as well.
void require_fits(const Context& context, const TrainingCost& cost, bool on_device, const std::string& lower);

/// Prints the parameters of each network, and the memory beside what there is.
void print_cost(const Context& context, const TrainingCost& cost);

/// Prints the time of an iteration, and of `iterations`; 0: only of one.
void print_time(double seconds, std::size_t iterations);

/// Adds --dry-run to a verb.
void add_dry_run(CLI::App& verb, bool& dry_run);

/// Throws Error unless the training fits the machine; see training_cost() for `build`. If `dry_run`, prints
/// what it takes, for `iterations` of them. Returns `dry_run`: whether to stop there. `lower`: the options
/// that make it smaller, see size_options().
template <class TrainOptions, class Build>
bool only_sized(const Context& context, const TrainOptions& options, const std::string& lower, bool dry_run,
                std::size_t iterations, const Build& build) {
  const TrainingCost cost = training_cost(context, options, build);
  if (dry_run) print_cost(context, cost);
  require_fits(context, cost, fits_device(context, options, build, cost), lower);
  if (dry_run) print_time(iteration_seconds(context, options, build, cost.flops), iterations);
  return dry_run;
}

}  // namespace motiongan::command
