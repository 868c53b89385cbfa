// Metrics of motion that need no model; shared by `evaluate motion`, `evaluate model` and `clean`.
#pragma once
#include <cmath>
#include <nlohmann/json.hpp>

#include "motiongan/metrics/motion_quality.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Adds --unit-metres and --feet to a verb, under a heading of --help.
inline void add_body_options(CLI::App& verb, double& unit_metres, std::vector<std::string>& feet,
                             const std::string& group = "Options") {
  verb.add_option("--unit-metres", unit_metres,
                  "metres per unit of the clips (CMU 0.05644, Bandai-Namco 0.01) [a leg is taken as 1 m]")
      ->check(positive())
      ->group(group);
  verb.add_option("--feet", feet, "foot joints [toes, feet or ankles, by name]")
      ->delimiter(',')
      ->type_name("LEFT,RIGHT")
      ->group(group);
}
inline void add_quality_options(CLI::App& verb, FootSkateOptions& options) {
  add_body_options(verb, options.unit_metres, options.feet);
}

/// A number with `decimals`; "-" if it is not finite.
inline std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

/// Rows of name, generated, real.
inline std::vector<std::vector<std::string>> quality_rows(const MotionQuality& generated,
                                                          const MotionQuality& real) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](std::string name, auto&& value, int decimals) {
    rows.push_back({std::move(name), cell(value(generated), decimals), cell(value(real), decimals)});
  };
  if (generated.feet && real.feet) {
    add(
        "foot skating, % of steps", [](const MotionQuality& q) { return 100 * q.feet->ratio(); }, 2);
    add(
        "a foot near the floor, %", [](const MotionQuality& q) { return 100 * q.feet->contact_share(); }, 1);
  }
  add(
      fmt::format("jerk, {}/s^3", real.length_unit), [](const MotionQuality& q) { return q.jerk; }, 1);
  add(
      "bone-length error, %", [](const MotionQuality& q) { return q.bone_error; }, 3);
  return rows;
}

/// Prints what those rows mean.
inline void print_quality_notes(const MotionQuality& real, const FootSkateOptions& options) {
  if (real.feet)
    fmt::print("foot skating: steps in which a foot below {} {} slides faster than {} {}/s{}\n",
               brief(options.unit_metres > 0 ? 100 * options.height : options.height),
               options.unit_metres > 0 ? "cm" : "leg lengths", brief(options.speed),
               options.unit_metres > 0 ? "m" : "leg lengths",
               options.unit_metres > 0 ? "" : " (--unit-metres gives metres)");
  else
    fmt::print("no joint is named like toes, feet or ankles: feet are not measured; name them with --feet\n");
}

inline nlohmann::json quality_json(const MotionQuality& q) {
  nlohmann::json out{{"clips", q.motions},
                     {"frames", q.frames},
                     {"length_unit", q.length_unit},
                     {"jerk", q.jerk},
                     {"bone_length_error_percent", q.bone_error}};
  if (q.feet) {
    out["foot_skate_ratio"] = q.feet->ratio();
    out["foot_contact_ratio"] = q.feet->contact_share();
  }
  return out;
}

}  // namespace motiongan::command
