// What the benchmarks of directed motion share.
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <motiongan/core/random.hpp>
#include <motiongan/direct/constraints.hpp>
#include <motiongan/direct/world_pose.hpp>
#include <motiongan/metrics/motion_quality.hpp>
#include <string>
#include <vector>

namespace motiongan {

inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// [--rounds N] and the other arguments.
struct Given {
  std::size_t rounds = 20;
  std::vector<std::string> names;
};
inline Given given_arguments(int count, char** arguments, std::size_t fewest_rounds) {
  Given out;
  for (int i = 1; i < count; ++i) {
    if (std::strcmp(arguments[i], "--rounds") == 0 && i + 1 < count)
      out.rounds = std::max(fewest_rounds, static_cast<std::size_t>(std::stoul(arguments[++i])));
    else
      out.names.emplace_back(arguments[i]);
  }
  return out;
}

/// A path of `way` that bends left and right.
inline std::vector<PathPoint> random_path(std::size_t number, double way) {
  const RandomKey key{.seed = 11, .stream = RandomStream::windows};
  const auto draw = [&](std::uint32_t k) {
    return static_cast<double>(random_below(key, static_cast<std::uint32_t>(number), 2001, k)) / 1000 - 1;
  };
  std::vector<PathPoint> out;
  double x = 0, z = 0;
  constexpr int points = 40;
  for (int i = 0; i <= points; ++i) {
    out.push_back({x, z});
    const double t = 2 * motion::pi * i / points;
    const double yaw = 0.9 * (draw(0) * std::sin(t) + draw(1) * std::sin(2 * t) / 2 + draw(2) * t / 3);
    x += way / points * std::sin(yaw), z += way / points * std::cos(yaw);
  }
  return out;
}

inline void print_quality(const char* name, const std::vector<motion::Motion>& motions) {
  const MotionQuality q = measure_quality(motions);
  std::printf("%s: jerk %.1f legs/s^3, skate %.1f %%, near the floor %.1f %%\n", name, q.jerk,
              100 * q.feet->ratio(), 100 * q.feet->contact_share());
}

/// The root mean square distance of the joints about the root in two frames.
inline double body_step(const WorldPose& p, const WorldPose& q) {
  double sum = 0;
  for (std::size_t j = 0; j < p.body.size(); ++j) {
    const motion::Vec3 d = motion::subtract(p.body[j], q.body[j]);
    sum += motion::dot(d, d);
  }
  return std::sqrt(sum / static_cast<double>(p.body.size()));
}

}  // namespace motiongan
