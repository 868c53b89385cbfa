// Percentiles.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace motiongan::motion {

/// Percentile `share` (0 .. 1) of the values, with linear interpolation; 0 if there are none.
inline double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (values[above] - values[below]) * (at - static_cast<double>(below));
}

}  // namespace motiongan::motion
