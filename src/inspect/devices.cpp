// motiongan devices: lists the OpenCL devices.
#include <cstdlib>
#include <optional>

#include "shared/command.hpp"

namespace motiongan::command {
namespace {

std::string gibibytes(cl_ulong bytes) {
  return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1 << 30));
}

int list_devices() {
  const std::vector<Device> devices = all_devices();
  const char* wish = std::getenv("MOTIONGAN_DEVICE");
  std::optional<Device> chosen;
  if (devices.empty()) choose_device(devices, "");  // throws and says what to do
  try {
    chosen = choose_device(devices, wish ? wish : "");
  } catch (const Error&) {
  }
  std::vector<std::vector<std::string>> rows;
  rows.reserve(devices.size());
  for (const Device& d : devices)
    rows.push_back({chosen && chosen->id == d.id ? "*" : "", kind_of(d), d.name, d.platform_name, d.version,
                    std::to_string(d.compute_units), gibibytes(d.global_memory),
                    d.has_double ? "yes" : "no"});
  print_table({"", "kind", "name", "platform", "version", "units", "memory", "double"}, rows, "lllllrrl");
  if (!chosen)
    throw Error("none of these devices matches \"", wish ? wish : "",
                "\"; --device and MOTIONGAN_DEVICE take cpu, gpu, part of a name, or NAME:index");
  fmt::print("* is the selected device{}; choose another with --device or MOTIONGAN_DEVICE.\n",
             wish && *wish ? fmt::format(" for \"{}\"", wish) : "");
  return 0;
}

const Verb devices_verb{"devices", [](CLI::App& app, Job& job) {
                          CLI::App* verb = app.add_subcommand(
                              "devices", "List the OpenCL devices and mark the selected one");
                          verb->callback([&job] { job = list_devices; });
                        }};

}  // namespace

}  // namespace motiongan::command
