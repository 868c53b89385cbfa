// A path over the ground, frame by frame.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/direct/constraints.hpp"

namespace motiongan {

/// Where the root should be in each frame, and which way the path goes there.
struct PathFrame {
  double x = 0, z = 0;
  double along_x = 0, along_z = 1;  ///< unit vector
  std::optional<double> yaw = {};   ///< given, not that of the path
};

/// A path with a time for every point.
class TimedPath {
 public:
  /// Of a motion of `seconds`. Throws Error without two points, for points that are not finite or all in one
  /// place, and for times that do not increase or lie outside of the motion.
  TimedPath(std::vector<PathPoint> points, double seconds) : points_(std::move(points)) {
    require(points_.size() >= 2, "a path has ", points_.size(), points_.size() == 1 ? " point" : " points",
            ", expected at least 2");
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const PathPoint& p = points_[i];
      require(std::isfinite(p.x) && std::isfinite(p.z) && (!p.yaw || std::isfinite(*p.yaw)), "point ", i + 1,
              " of the path has a number that is not finite");
      way_.push_back(i == 0 ? 0 : way_.back() + std::hypot(p.x - points_[i - 1].x, p.z - points_[i - 1].z));
      timed_ = timed_ || p.time.has_value();
    }
    require(way_.back() > 0, "all points of the path are in one place");
    set_times(seconds);
  }

  /// Whether points have times: then the pace is given, too.
  bool timed() const { return timed_; }
  /// The length of the way over the ground.
  double length() const { return way_.back(); }
  const std::vector<PathPoint>& points() const { return points_; }
  double first_time() const { return *points_.front().time; }
  double last_time() const { return *points_.back().time; }

  /// The point of the path at a time; before and after it, at its ends.
  PathFrame at(double time) const {
    std::size_t i = 0;
    while (i + 2 < points_.size() && *points_[i + 1].time <= time) ++i;
    const PathPoint &a = points_[i], &b = points_[i + 1];
    const double share = std::clamp((time - *a.time) / std::max(*b.time - *a.time, 1e-12), 0.0, 1.0);
    PathFrame out{a.x + share * (b.x - a.x), a.z + share * (b.z - a.z)};
    std::size_t from = i, to = i + 1;  // the direction of a point that stays is that of the next way
    while (way_[to] - way_[from] <= 0 && to + 1 < points_.size()) ++to;
    while (way_[to] - way_[from] <= 0 && from > 0) --from;
    const double x = points_[to].x - points_[from].x, z = points_[to].z - points_[from].z,
                 far = std::max(std::hypot(x, z), 1e-12);
    out.along_x = x / far, out.along_z = z / far;
    if (a.yaw && b.yaw)
      out.yaw = *a.yaw + share * std::remainder(*b.yaw - *a.yaw, 2 * motion::pi);
    else if (share == 0 ? a.yaw : share == 1 ? b.yaw : std::nullopt)
      out.yaw = share == 0 ? a.yaw : b.yaw;
    return out;
  }

  /// The distance of a place from the nearest point of the path.
  double distance(double x, double z) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
      const PathPoint &a = points_[i], &b = points_[i + 1];
      const double dx = b.x - a.x, dz = b.z - a.z, square = dx * dx + dz * dz;
      const double share =
          square > 0 ? std::clamp(((x - a.x) * dx + (z - a.z) * dz) / square, 0.0, 1.0) : 0.0;
      nearest = std::min(nearest, std::hypot(x - a.x - share * dx, z - a.z - share * dz));
    }
    return nearest;
  }

  /// Where a motion begins that follows the path: a path that begins later is led back to the first frame at
  /// the pace of its first part.
  motion::RootTrack start() const {
    const PathFrame first = at(first_time());
    std::size_t next = 1;
    while (next + 1 < points_.size() && way_[next] <= 0) ++next;
    const double took = *points_[next].time - first_time();
    const double back = took > 0 ? first_time() * way_[next] / took : 0;
    return {first.x - back * first.along_x, first.z - back * first.along_z,
            first.yaw.value_or(std::atan2(first.along_x, first.along_z)), true};
  }

 private:
  void set_times(double seconds) {
    if (!points_.front().time) points_.front().time = 0;
    if (!points_.back().time) points_.back().time = seconds;
    for (std::size_t a = 0; a + 1 < points_.size();) {
      std::size_t b = a + 1;
      while (!points_[b].time) ++b;
      const double from = *points_[a].time, to = *points_[b].time;
      require(from >= 0 && to <= seconds + 1e-9, "the path has the time ", from < 0 ? from : to,
              " s, expected times from 0 to ", seconds, " s, the length of the motion");
      require(to > from, "point ", b + 1, " of the path has the time ", to, " s, expected more than ", from,
              " s, that of an earlier point");
      for (std::size_t i = a + 1; i < b; ++i) {
        const double way = way_[b] - way_[a];
        const double share =
            way > 0 ? (way_[i] - way_[a]) / way : static_cast<double>(i - a) / static_cast<double>(b - a);
        points_[i].time = from + share * (to - from);
      }
      a = b;
    }
  }

  std::vector<PathPoint> points_;
  std::vector<double> way_;  // from the first point, per point
  bool timed_ = false;
};

}  // namespace motiongan
