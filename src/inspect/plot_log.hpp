// The curves of a training log, as a picture and in a few numbers.
#pragma once
#include <algorithm>

#include "motiongan/train/csv_log.hpp"
#include "motiongan/view/line_plot.hpp"

namespace motiongan::command {

/// Running mean over `reach` values on either side.
inline std::vector<double> smoothed(const std::vector<double>& values, std::size_t reach) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i < reach ? 0 : i - reach, to = std::min(values.size(), i + reach + 1);
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += values[k];
    out.push_back(sum / static_cast<double>(to - from));
  }
  return out;
}

/// Peak and end of a noisy curve.
struct CurveSummary {
  double peak = 0, last = 0;
  std::size_t peak_at = 0;  ///< row
};

/// Needs at least one value. Single values are noisy, so running means over a fiftieth of the curve are used.
inline CurveSummary summarise(const std::vector<double>& values) {
  const std::vector<double> smooth = smoothed(values, values.size() / 100);
  const auto peak = std::max_element(smooth.begin(), smooth.end());
  return {*peak, smooth.back(), static_cast<std::size_t>(peak - smooth.begin())};
}

/// Plots Wasserstein estimate and gradient penalty (times 10, its usual weight) over the iterations.
inline view::Image plot_log(const CsvTable& log, const std::string& title) {
  const std::vector<double> x = log.column("iteration");
  std::vector<double> penalty = log.column("penalty");
  for (double& p : penalty) p *= 10;
  const std::vector<view::Series> series{{"Wasserstein estimate", x, log.column("wasserstein")},
                                         {"10 x penalty", x, penalty}};
  return view::line_plot(series, {.title = title, .x_label = "iteration"});
}

}  // namespace motiongan::command
