// motiongan devices: lists the OpenCL devices.
#include <cstdlib>
#include <optional>

#include "shared/command.hpp"

namespace motiongan::command {
namespace {

std::string gibibytes(cl_ulong bytes) {
  return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1 << 30));
}

/// Prints what keeps devices from being listed or used, a line each.
void print_problems(const DeviceSurvey& survey) {
  for (const Device& d : survey.devices)
    if (const std::string reason = why_unusable(d); !reason.empty())
      fmt::print("{} cannot be used: {}\n", d.name, reason);
  for (const std::string& problem : survey.problems) fmt::print("{}\n", problem);
}

int list_devices() {
  const DeviceSurvey survey = survey_devices();
  const char* wish = std::getenv("MOTIONGAN_DEVICE");
  std::optional<Device> chosen;
  if (survey.devices.empty()) choose_device(survey, "");  // throws and says what to do
  try {
    chosen = choose_device(survey, wish ? wish : "");
  } catch (const Error&) {
  }
  std::vector<std::vector<std::string>> rows;
  rows.reserve(survey.devices.size());
  for (const Device& d : survey.devices)
    rows.push_back({chosen && chosen->id == d.id ? "*" : "", kind_of(d), d.name, d.platform_name, d.version,
                    std::to_string(d.compute_units), gibibytes(d.global_memory),
                    d.has_double ? "yes" : "no"});
  print_table({"", "kind", "name", "platform", "version", "units", "memory", "double"}, rows, "lllllrrl");
  print_problems(survey);
  if (!chosen)
    throw Error("none of these devices matches \"", wish ? wish : "",
                "\"; --device and MOTIONGAN_DEVICE take cpu, gpu, part of a name, or NAME:index");
  require_usable(*chosen);
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
