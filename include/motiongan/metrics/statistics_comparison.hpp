// Compares statistics of generated and real motion, and prints them as a table or CSV.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/metrics/statistics_measure.hpp"

namespace motiongan::motion {

/// One joint in two sets. Angles in degrees, speeds in degrees per second. Ratios are generated / real, and
/// NaN if the real joint hardly moves (spread below 0.1 degrees, speed below 0.1 degrees per second).
struct JointComparison {
  JointStatistics generated, real;
  double mean_difference = 0;  ///< distance between the mean exponential maps
  double spread_ratio = 0, speed_ratio = 0, speed_p95_ratio = 0;
  double outside = 0;  ///< fraction of generated frames with the joint outside the real range
};

/// Two sets compared, over all joints.
struct StatisticsComparison {
  MotionStatistics generated, real;  ///< without `poses`
  std::vector<JointComparison> joints;
  double margin = 0;               ///< widening of the real range, as a fraction of its width
  double median_spread_ratio = 0;  ///< over the joints with a ratio
  double mean_speed_ratio = 0;     ///< mean speed of all joints, generated over real
  double values_outside = 0;       ///< fraction of all generated pose values outside the real range
  double frames_outside = 0;       ///< fraction of generated frames with at least one such value
};

/// Compares two sets measured by measure(). The range of each pose value is that of the real set, widened at
/// each end by `margin` times its width and by at least half a degree. Throws Error if the joints differ or
/// `margin` is negative.
inline StatisticsComparison compare(const MotionStatistics& generated, const MotionStatistics& real,
                                    double margin = 0.05) {
  const std::size_t joints = real.joints.size();
  require(margin >= 0, "the margin of the real range is ", margin, "; expected 0 or more");
  require(generated.joints.size() == joints, "cannot compare ", generated.joints.size(),
          " generated joints with ", joints, " real ones; measure both on one skeleton");
  require(generated.frames > 0 && generated.poses.size() == generated.frames * 3 * joints,
          "the generated statistics hold ", generated.poses.size(), " pose values, expected ",
          generated.frames, " frames x ", 3 * joints, " (at least one frame); use what measure() returns");
  StatisticsComparison out;
  out.margin = margin;
  out.joints.resize(joints);
  std::vector<char> frame_outside(generated.frames);
  std::vector<double> ratios;
  std::size_t values = 0;
  double speed = 0, real_speed = 0;
  const auto ratio = [](double g, double r) {
    return r >= 0.1 ? g / r : std::numeric_limits<double>::quiet_NaN();
  };
  for (std::size_t j = 0; j < joints; ++j) {
    const JointStatistics &g = generated.joints[j], &r = real.joints[j];
    require(g.name == r.name, "joint ", j, " is '", g.name, "' in the generated set and '", r.name,
            "' in the real one; measure both on one skeleton");
    JointComparison& c = out.joints[j];
    c.generated = g, c.real = r;
    c.mean_difference = length(subtract(g.mean, r.mean));
    c.spread_ratio = ratio(g.total_spread(), r.total_spread());
    c.speed_ratio = ratio(g.speed, r.speed);
    c.speed_p95_ratio = ratio(g.speed_p95, r.speed_p95);
    if (!std::isnan(c.spread_ratio)) ratios.push_back(c.spread_ratio);
    speed += g.speed, real_speed += r.speed;
    std::size_t joint_frames = 0;
    for (std::size_t f = 0; f < generated.frames; ++f) {
      std::size_t off = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        const double v = generated.poses[(f * joints + j) * 3 + d];
        const double room = std::max(margin * (r.high[d] - r.low[d]), 0.5);
        if (!(v >= r.low[d] - room && v <= r.high[d] + room)) ++off;
      }
      values += off;
      if (off > 0) ++joint_frames, frame_outside[f] = 1;
    }
    c.outside = static_cast<double>(joint_frames) / static_cast<double>(generated.frames);
  }
  out.median_spread_ratio =
      ratios.empty() ? std::numeric_limits<double>::quiet_NaN() : percentile(ratios, 0.5);
  out.mean_speed_ratio = real_speed > 0 ? speed / real_speed : std::numeric_limits<double>::quiet_NaN();
  out.values_outside = static_cast<double>(values) / static_cast<double>(generated.poses.size());
  out.frames_outside = static_cast<double>(std::count(frame_outside.begin(), frame_outside.end(), 1)) /
                       static_cast<double>(generated.frames);
  out.generated = generated, out.real = real;
  out.generated.poses.clear(), out.real.poses.clear();
  return out;
}

namespace statistics_detail {

/// `value` with `decimals` decimals; `missing` if it is not finite.
inline std::string decimal(double value, int decimals, const char* missing = "-") {
  if (!std::isfinite(value)) return missing;
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  if (text[0] == '-' && std::string(text).find_first_not_of("-0.") == std::string::npos) return text + 1;
  return text;
}

inline std::string pad_left(const std::string& text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

inline std::string pad_right(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}

}  // namespace statistics_detail

/// A text table: one line per joint (generated, real and their ratio), then a summary. `unit` names the
/// clips' unit of length.
inline std::string to_table(const StatisticsComparison& c, const std::string& unit = "units") {
  using statistics_detail::decimal, statistics_detail::pad_left, statistics_detail::pad_right;
  std::size_t name_width = 5;
  for (const JointComparison& j : c.joints) name_width = std::max(name_width, j.real.name.size());
  std::string out = pad_right("", name_width) +
                    "   mean   spread (deg)         speed (deg/s)        95th percentile   outside\n" +
                    pad_right("joint", name_width) +
                    "   diff   gen.   real ratio    gen.   real ratio    gen.   real ratio   range\n";
  for (const JointComparison& j : c.joints) {
    out += pad_right(j.real.name, name_width) + pad_left(decimal(j.mean_difference, 1), 7);
    const auto group = [&out](double g, double r, double ratio) {
      out += pad_left(decimal(g, 1), 7) + pad_left(decimal(r, 1), 7) + pad_left(decimal(ratio, 2), 6) + " ";
    };
    group(j.generated.total_spread(), j.real.total_spread(), j.spread_ratio);
    group(j.generated.speed, j.real.speed, j.speed_ratio);
    group(j.generated.speed_p95, j.real.speed_p95, j.speed_p95_ratio);
    out += pad_left(decimal(100 * j.outside, 1), 6) + "%\n";
  }
  const auto pair = [&out](const char* what, const std::string& g, const std::string& r) {
    out += pad_right(what, 34) + pad_left(g, 9) + "  real " + pad_left(r, 9) + "\n";
  };
  const auto line = [&out](const char* what, const std::string& value) {
    out += pad_right(what, 34) + pad_left(value, 9) + "\n";
  };
  out += "\n";
  pair("clips", std::to_string(c.generated.clips), std::to_string(c.real.clips));
  pair("seconds", decimal(c.generated.seconds, 1), decimal(c.real.seconds, 1));
  line("median spread ratio", decimal(c.median_spread_ratio, 3));
  line("mean speed ratio", decimal(c.mean_speed_ratio, 3));
  line("pose values outside real range", decimal(100 * c.values_outside, 2) + "%");
  line("frames with any value outside", decimal(100 * c.frames_outside, 2) + "%");
  out += "  (range widened by " + decimal(100 * c.margin, 0) + "% at each end, by at least 0.5 deg)\n";
  pair(("root speed (" + unit + "/s)").c_str(), decimal(c.generated.root_speed, 2),
       decimal(c.real.root_speed, 2));
  pair("root speed, 95th percentile", decimal(c.generated.root_speed_p95, 2),
       decimal(c.real.root_speed_p95, 2));
  pair("mean frequency of the pose (Hz)", decimal(c.generated.frequency, 3), decimal(c.real.frequency, 3));
  pair(("lowest point, minimum (" + unit + ")").c_str(), decimal(c.generated.lowest, 2),
       decimal(c.real.lowest, 2));
  pair(("lowest point, mean (" + unit + ")").c_str(), decimal(c.generated.mean_low, 2),
       decimal(c.real.mean_low, 2));
  pair(("lowest point, maximum (" + unit + ")").c_str(), decimal(c.generated.highest_low, 2),
       decimal(c.real.highest_low, 2));
  return out;
}

/// CSV with a header and one line per joint, in degrees and degrees per second. Undefined ratios are empty.
inline std::string to_csv(const StatisticsComparison& c) {
  std::string out =
      "joint,mean_difference,spread,spread_real,spread_ratio,angle,angle_real,angle_spread,angle_spread_real,"
      "speed,speed_real,speed_ratio,speed_p95,speed_p95_real,speed_p95_ratio,outside\n";
  for (const JointComparison& j : c.joints) {
    // A name with a comma, quote or newline is quoted, and its quotes are doubled.
    std::string name = j.real.name;
    if (name.find_first_of(",\"\n") != std::string::npos) {
      std::string quoted = "\"";
      for (const char ch : name) quoted += ch == '"' ? std::string("\"\"") : std::string(1, ch);
      name = quoted + "\"";
    }
    out += name;
    for (const double v :
         {j.mean_difference, j.generated.total_spread(), j.real.total_spread(), j.spread_ratio,
          j.generated.angle, j.real.angle, j.generated.angle_spread, j.real.angle_spread, j.generated.speed,
          j.real.speed, j.speed_ratio, j.generated.speed_p95, j.real.speed_p95, j.speed_p95_ratio, j.outside})
      out += "," + statistics_detail::decimal(v, 6, "");
    out += "\n";
  }
  return out;
}

}  // namespace motiongan::motion
