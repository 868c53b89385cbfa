// What both comparisons share: several seeds of each variant.
#pragma once
#include <functional>

#include "motiongan/metrics/mean_std.hpp"
#include "shared/options.hpp"

namespace motiongan::command {

/// Folder of a variant's run with a seed.
inline fs::path folder_of(const fs::path& save, std::string_view variant, std::uint64_t seed) {
  return save / variant / concat("seed-", seed);
}

/// Adds --seeds and --seed to a verb.
inline void add_seed_options(CLI::App& verb, std::size_t& seeds, std::uint64_t& first) {
  verb.add_option("--seeds", seeds, "number of seeds for each variant")
      ->check(positive())
      ->capture_default_str();
  verb.add_option("--seed", first, "first seed")->check(not_negative())->capture_default_str();
}

/// `count` seeds from `first` on.
inline std::vector<std::uint64_t> seeds_from(std::uint64_t first, std::size_t count) {
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(first + i);
  return out;
}

/// "4.1 ± 0.3"; without the spread for one value, "-" for none. `number` formats a double.
inline std::string cell(const MeanStd& m, const std::function<std::string(double)>& number) {
  if (m.count == 0) return "-";
  return m.count == 1 ? number(m.mean) : number(m.mean) + " ± " + number(m.spread);
}

}  // namespace motiongan::command
