#include "train/training_size.hpp"

#include <algorithm>

#include "motiongan/core/os.hpp"

namespace motiongan::command {
namespace {

/// "34.5 MB", "1.23 GB", "46 TB".
std::string size_text(double bytes) {
  for (const auto& [unit, name] : {std::pair{1e12, "TB"}, {1e9, "GB"}, {1e6, "MB"}})
    if (bytes >= unit) return concat(brief(bytes / unit, 3), " ", name);
  return concat(brief(bytes / 1e3, 3), " kB");
}

/// "8.749 million", "567.3 billion".
std::string count_text(std::size_t count) {
  const bool billions = count >= 1'000'000'000;
  return concat(brief(static_cast<double>(count) / (billions ? 1e9 : 1e6)),
                billions ? " billion" : " million");
}

/// What a training adds to the process. A CPU device's memory is that of the host.
double host_need(const Context& context, const TrainingCost& cost) {
  return cost.host_bytes + (context.device().is_cpu() ? cost.device_in_use : 0);
}

std::string limit_text(const Context& context) {
  const double limit = static_cast<double>(context.memory_limit());
  const bool set = context.memory_limit() != context.device().global_memory;
  return concat(size_text(limit), set ? " (MOTIONGAN_MEMORY_MB)" : "");
}

std::size_t total_parameters(const TrainingCost& cost) {
  std::size_t total = 0;
  for (const auto& [name, count] : cost.parameters) total += count;
  return total;
}

}  // namespace

std::string size_options(std::size_t batch, std::size_t hidden, const char* hidden_option) {
  return concat("--batch (now ", batch, ") or ", hidden_option, " (now ", hidden, ")");
}

void require_fits(const Context& context, const TrainingCost& cost, bool on_device,
                  const std::string& lower) {
  const std::string need = concat("this training does not fit: the networks have ",
                                  count_text(total_parameters(cost)), " parameters, and an iteration takes ",
                                  size_text(cost.device_in_use)),
                    advice = "; lower " + lower;
  const Device& device = context.device();
  const double largest = std::min(static_cast<double>(device.max_allocation),
                                  static_cast<double>(context.element_limit() * context.real_size()));
  require(on_device, need, " on the device, ", size_text(cost.largest_buffer), " of it in one buffer; ",
          device.name, " has ", limit_text(context), ", and at most ", size_text(largest), " for a buffer",
          advice);
  const double host = host_need(context, cost), there = os::available_memory();
  require(host <= there, need, " on the device and about ", size_text(host), " of host memory",
          device.is_cpu() ? ", which includes that of the device, the CPU" : "", "; ", size_text(there),
          " of it is free", advice);
}

void print_cost(const Context& context, const TrainingCost& cost) {
  for (const auto& [name, count] : cost.parameters)
    print_fact(name, fmt::format("{} parameters, {}", count,
                                 size_text(static_cast<double>(count * context.real_size()))));
  print_fact("device", concat("about ", size_text(cost.device_bytes), " of ", limit_text(context),
                              ", at least ", size_text(cost.device_in_use)));
  print_fact("host",
             concat("about ", size_text(host_need(context, cost)), " of ", size_text(os::available_memory()),
                    context.device().is_cpu() ? ", with that of the device, which is the CPU" : ""));
  print_fact("work", fmt::format("{:.3g} operations in matrix products an iteration", cost.flops));
}

void print_time(double seconds, std::size_t iterations) {
  const std::string all =
      iterations > 0 ? fmt::format(", {} for {}", duration(seconds * static_cast<double>(iterations)),
                                   counted(iterations, "iteration"))
                     : "";
  print_fact("time", fmt::format("about {} an iteration{} (by one with fewer steps, timed here)",
                                 duration(seconds), all));
}

void add_dry_run(CLI::App& verb, bool& dry_run) {
  verb.add_flag("--dry-run", dry_run,
                "print parameters, memory and expected time, then stop; train and write nothing");
}

}  // namespace motiongan::command
