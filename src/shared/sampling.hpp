// Options of the verbs that make motion for a text: which samples, and how their files are written.
#pragma once
#include "shared/command.hpp"

namespace motiongan::command {

/// Adds --seed, --first-sample, --rate and --out. `motions` is what another seed gives, for --help.
inline void add_sampling_options(CLI::App& verb, std::uint64_t& seed, std::size_t& first_sample, double& rate,
                                 std::string& out, const std::string& motions) {
  verb.add_option("--seed", seed, "random seed; another one gives other " + motions)
      ->check(not_negative())
      ->capture_default_str();
  verb.add_option("--first-sample", first_sample, "number of the first sample")
      ->check(not_negative())
      ->capture_default_str();
  verb.add_option("--rate", rate, "frames per second of the files, by interpolation [the model's]")
      ->check(CLI::Range(1e-3, 1e4))
      ->type_name("HZ");
  verb.add_option("--out", out, "folder to write to; created if missing")
      ->capture_default_str()
      ->type_name("DIR");
}

}  // namespace motiongan::command
