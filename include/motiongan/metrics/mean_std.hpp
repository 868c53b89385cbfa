// Mean and standard deviation over several values, such as seeds.
#pragma once
#include <cmath>
#include <cstddef>
#include <span>

#include "motiongan/core/error.hpp"

namespace motiongan {

/// Mean and sample standard deviation (`spread`, with n - 1; 0 for one value).
struct MeanStd {
  std::size_t count = 0;
  double mean = 0, spread = 0;
};

/// Throws Error if there are no values.
inline MeanStd mean_spread(std::span<const double> values) {
  require(!values.empty(), "there are no values to average, expected at least one");
  const auto n = static_cast<double>(values.size());
  MeanStd out{values.size(), 0, 0};
  for (const double v : values) out.mean += v / n;
  for (const double v : values) out.spread += (v - out.mean) * (v - out.mean);
  out.spread = values.size() > 1 ? std::sqrt(out.spread / (n - 1)) : 0;
  return out;
}

}  // namespace motiongan
