// Motion statistics of a set of clips: joint angles and speeds, root speed, mean frequency, lowest point.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/pose.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/percentile.hpp"
#include "motiongan/motion/root_joint.hpp"

namespace motiongan::motion {

/// One joint over all frames of all clips. Angles in degrees.
struct JointStatistics {
  std::string name;
  Vec3 mean{}, spread{};               ///< of the exponential map's components, unwrapped over time
  Vec3 low{}, high{};                  ///< their minima and maxima
  double angle = 0, angle_spread = 0;  ///< mean and standard deviation of the rotation angle, 0 .. 180
  double speed = 0, speed_p95 = 0;     ///< angular speed, degrees per second: mean and 95th percentile

  /// Root mean square of the three spreads.
  double total_spread() const { return length(spread) / std::sqrt(3.0); }
};

/// Statistics of a set of clips. Lengths are in the clips' unit.
struct MotionStatistics {
  std::size_t clips = 0, frames = 0;
  double seconds = 0;                         ///< sum over clips of (frames - 1) / rate
  double root_speed = 0, root_speed_p95 = 0;  ///< of the moving root, units per second
  double frequency = 0;                       ///< power-weighted mean frequency of the pose, Hz
  double lowest = 0, highest_low = 0,
         mean_low = 0;  ///< minimum, maximum and mean height of the body's lowest point
  std::vector<JointStatistics> joints;
  std::vector<double> poses;  ///< [frames, 3 * joints] exponential maps in degrees, clip after clip
};

/// Spectral moments of `values` [frames, width] over all channels: (sum of power * frequency, sum of power),
/// in Hz for a rate in frames per second. The values are split into pieces of at most 512 frames, which keeps
/// a plain DFT cheap, and each piece's mean is subtracted. The lowest frequency is rate / (frames of the
/// piece).
inline std::pair<double, double> spectral_moments(std::span<const double> values, std::size_t width,
                                                  double rate) {
  constexpr std::size_t longest = 512;
  const std::size_t frames = width == 0 ? 0 : values.size() / width;
  double weighted = 0, power = 0;
  for (std::size_t first = 0; first + 1 < frames; first += longest) {
    const std::size_t n = std::min(longest, frames - first);
    if (n < 2) break;
    std::vector<double> cosine(n), sine(n), x(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double a = 2 * pi * static_cast<double>(i) / static_cast<double>(n);
      cosine[i] = std::cos(a), sine[i] = std::sin(a);
    }
    for (std::size_t c = 0; c < width; ++c) {
      double mean = 0;
      for (std::size_t i = 0; i < n; ++i) mean += x[i] = values[(first + i) * width + c];
      mean /= static_cast<double>(n);
      for (std::size_t k = 1; 2 * k <= n; ++k) {
        double re = 0, im = 0;
        for (std::size_t i = 0, at = 0; i < n; ++i, at = (at + k) % n) {
          re += (x[i] - mean) * cosine[at];
          im += (x[i] - mean) * sine[at];
        }
        // All frequencies but n / 2 represent a conjugate pair.
        const double p = (re * re + im * im) * (2 * k == n ? 1 : 2);
        weighted += p * static_cast<double>(k) * rate / static_cast<double>(n);
        power += p;
      }
    }
  }
  return {weighted, power};
}

/// Measures clips of one skeleton. Compare sets of one rate: a lower rate underestimates the speed of fast
/// movements. Throws Error without clips, for a clip of fewer than two frames, and if the joints differ
/// between clips.
inline MotionStatistics measure(std::span<const Motion> motions) {
  require(!motions.empty(), "there is no motion to measure; expected at least one clip");
  const Skeleton& skeleton = motions.front().skeleton;
  const std::size_t joints = skeleton.size();
  const PoseLayout layout(skeleton, false);
  MotionStatistics out;
  out.joints.resize(joints);
  for (std::size_t j = 0; j < joints; ++j) out.joints[j].name = skeleton.joints[j].name;
  std::vector<std::vector<double>> speeds(joints), angles(joints);
  std::vector<double> root_speeds, low_points;
  double weighted = 0, power = 0;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const Motion& motion = motions[m];
    require(motion.frames >= 2, "motion ", m, " has ", motion.frames, " frames; expected at least 2");
    require(motion.skeleton.size() == joints, "motion ", m, " has ", motion.skeleton.size(),
            " joints, the first one ", joints, "; statistics need one skeleton");
    for (std::size_t j = 0; j < joints; ++j)
      require(motion.skeleton.joints[j].name == skeleton.joints[j].name, "joint ", j, " of motion ", m,
              " is '", motion.skeleton.joints[j].name, "', in the first one '", skeleton.joints[j].name,
              "'; statistics need one skeleton");
    std::vector<double> pose = layout.encode(motion);
    for (double& v : pose) v = degrees(v);
    const auto [w, p] = spectral_moments(pose, 3 * joints, motion.rate);
    weighted += w, power += p;
    out.poses.insert(out.poses.end(), pose.begin(), pose.end());
    out.frames += motion.frames;
    out.seconds += static_cast<double>(motion.frames - 1) / motion.rate;

    const GlobalPose global = forward_kinematics(motion);
    const std::vector<Vec3> ends = end_site_positions(motion, global);
    const std::size_t end_count = ends.size() / motion.frames;
    const std::size_t root = static_cast<std::size_t>(moving_root(motion));
    for (std::size_t f = 0; f < motion.frames; ++f) {
      double low = global.positions[f * joints][1];
      for (std::size_t j = 0; j < joints; ++j) {
        low = std::min(low, global.positions[f * joints + j][1]);
        angles[j].push_back(degrees(angle_between(Quat{}, motion.rotation(f, j))));
        if (f > 0)
          speeds[j].push_back(degrees(angle_between(motion.rotation(f - 1, j), motion.rotation(f, j))) *
                              motion.rate);
      }
      for (std::size_t e = 0; e < end_count; ++e) low = std::min(low, ends[f * end_count + e][1]);
      low_points.push_back(low);
      if (f > 0)
        root_speeds.push_back(motion.rate * length(subtract(global.positions[f * joints + root],
                                                            global.positions[(f - 1) * joints + root])));
    }
  }

  const auto mean_and_spread = [](const std::vector<double>& v) {
    double mean = 0, square = 0;
    for (const double x : v) mean += x;
    mean /= static_cast<double>(v.size());
    for (const double x : v) square += (x - mean) * (x - mean);
    return std::pair{mean, std::sqrt(square / static_cast<double>(v.size()))};
  };
  std::vector<double> column(out.frames);
  for (std::size_t j = 0; j < joints; ++j) {
    JointStatistics& s = out.joints[j];
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t f = 0; f < out.frames; ++f) column[f] = out.poses[f * 3 * joints + 3 * j + d];
      std::tie(s.mean[d], s.spread[d]) = mean_and_spread(column);
      const auto [low, high] = std::minmax_element(column.begin(), column.end());
      s.low[d] = *low, s.high[d] = *high;
    }
    std::tie(s.angle, s.angle_spread) = mean_and_spread(angles[j]);
    s.speed = mean_and_spread(speeds[j]).first;
    s.speed_p95 = percentile(std::move(speeds[j]), 0.95);
  }
  out.clips = motions.size();
  out.root_speed = mean_and_spread(root_speeds).first;
  out.root_speed_p95 = percentile(std::move(root_speeds), 0.95);
  out.frequency = power > 0 ? weighted / power : 0;
  const auto [low, high] = std::minmax_element(low_points.begin(), low_points.end());
  out.lowest = *low, out.highest_low = *high;
  out.mean_low = mean_and_spread(low_points).first;
  return out;
}

}  // namespace motiongan::motion
