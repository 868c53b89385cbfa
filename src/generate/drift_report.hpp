// Drift of generated motion over time, averaged over all motions of a command.
#pragma once
#include "motiongan/metrics/drift.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// The mean of several DriftMeters, second by second. All motions have the same number of frames.
class DriftReport {
 public:
  void add(const DriftMeter& meter) {
    const std::vector<DriftRow> rows = meter.rows();
    sums_.resize(std::max(sums_.size(), rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) add(sums_[i], rows[i], 1);
    ++motions_;
  }

  /// Prints at most ten rows, each the mean of consecutive seconds.
  void print() const {
    if (sums_.empty()) return;
    const std::size_t parts = std::min<std::size_t>(10, sums_.size());
    std::vector<std::vector<std::string>> table;
    for (std::size_t p = 0; p < parts; ++p) {
      const std::size_t begin = p * sums_.size() / parts, end = (p + 1) * sums_.size() / parts;
      DriftRow part;
      double frames = 0;
      for (std::size_t i = begin; i < end; ++i) frames += static_cast<double>(sums_[i].frames);
      for (std::size_t i = begin; i < end; ++i) {
        const double share = static_cast<double>(sums_[i].frames) / frames;
        add(part, sums_[i], share / static_cast<double>(motions_));
      }
      table.push_back({end - begin == 1 ? fmt::format("{}", begin) : fmt::format("{} to {}", begin, end - 1),
                       fmt::format("{:.2f}", part.mean), fmt::format("{:.2f}", part.spread),
                       fmt::format("{:.2f}", part.speed),
                       std::isnan(part.outside) ? "unknown" : fmt::format("{:.1f}%", 100 * part.outside)});
    }
    fmt::print(
        "drift of {}, in standard deviations of the training data (mean: distance from the training mean;\n"
        "spread: within a second; speed: per second; outside: values beyond the training range):\n",
        counted(motions_, "motion"));
    print_table({"second", "mean", "spread", "speed", "outside"}, table, "rrrrr", "  ");
  }

  /// A row per second, as DriftMeter::write_csv.
  void write_csv(const fs::path& path) const {
    std::string text = "second,frames,mean,spread,speed,outside\n";
    const double n = static_cast<double>(motions_);
    for (const DriftRow& r : sums_)
      text += concat(r.second, ',', r.frames / motions_, ',', r.mean / n, ',', r.spread / n, ',', r.speed / n,
                     ',', std::isnan(r.outside) ? std::string() : concat(r.outside / n), '\n');
    make_folder_of(path);
    motion::write_text_atomically(path, text);
  }

 private:
  static void add(DriftRow& to, const DriftRow& row, double weight) {
    to.second = row.second;
    to.frames += row.frames;
    to.mean += weight * row.mean;
    to.spread += weight * row.spread;
    to.speed += weight * row.speed;
    to.outside += weight * row.outside;
  }

  std::vector<DriftRow> sums_;  // by second
  std::size_t motions_ = 0;
};

}  // namespace motiongan::command
