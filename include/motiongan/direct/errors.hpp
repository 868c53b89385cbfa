// How far a motion is from what it has to meet: measured on the motion itself, not on what is optimised.
#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/direct/directed_body.hpp"
#include "motiongan/direct/path.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan {

/// The error of one constraint. Lengths are in the motion's unit.
struct ConstraintError {
  std::string name;  ///< such as "pose at 1.2 s"
  double mean = 0;   ///< over frames
  double worst = 0;  ///< what is compared with the tolerance
  double tolerance = 0;
  double angle = 0, angle_tolerance = 0;  ///< largest angle, radians; tolerance 0: none is asked for

  /// The error as a multiple of what is allowed; at most 1 if it is met.
  double excess() const {
    const double far = tolerance > 0 ? worst / tolerance : 0;
    return angle_tolerance > 0 ? std::max(far, angle / angle_tolerance) : far;
  }
  /// Whether the error is within its tolerance.
  bool met() const { return excess() <= 1; }
};

/// The largest of their excess(); 0 without constraints.
inline double largest_excess(const std::vector<ConstraintError>& errors) {
  double most = 0;
  for (const ConstraintError& e : errors) most = std::max(most, e.excess());
  return most;
}

namespace detail {

/// Measures constraints on a motion.
class ErrorMeter {
 public:
  /// `poses` are those of frames `first` and following of a motion of `seconds`; given poses are read by
  /// `read`. `rotations` is the motion itself, if it has any. What is passed must outlive the meter.
  ErrorMeter(std::vector<WorldPose> poses, const motion::Skeleton& skeleton, double rate,
             const PoseReader& read, std::size_t first, double seconds,
             const motion::Motion* rotations = nullptr)
      : poses_(std::move(poses)),
        skeleton_(skeleton),
        rate_(rate),
        read_(read),
        first_(first),
        seconds_(seconds),
        unit_(motion::body_unit(skeleton)),
        rotations_(rotations) {}

  std::vector<ConstraintError> operator()(const std::vector<Constraint>& constraints) const {
    std::vector<ConstraintError> out;
    for (const Constraint& c : constraints) out.push_back(std::visit(*this, c));
    return out;
  }

  ConstraintError operator()(const PoseConstraint& c) const {
    ConstraintError out{.name = concat("pose at ", text(c.time))};
    if (c.pose.frames > 1) out.name = concat("poses from ", text(c.time));
    const std::size_t first = frame_at(c.time, rate_);
    for (std::size_t i = 0; i < c.pose.frames; ++i)
      if (const WorldPose* const own = pose_at(first + i))
        take(out, apart(*own, read_(c.pose, i), c.joints, c.placed), c.pose.frames);
    out.tolerance = tolerance_of(c, c.tolerance);
    return out;
  }

  ConstraintError operator()(const JointConstraint& c) const {
    ConstraintError out{
        .name = concat(skeleton_.joints[c.joint].name, " at ", text(c.from), until(c.from, c.to))};
    const auto [first, last] = span(c.from, c.to);
    for (std::size_t f = first; f <= last; ++f) {
      const WorldPose* const own = pose_at(f);
      if (own == nullptr) continue;
      if (c.position)
        take(out, motion::length(motion::subtract(own->joint(c.joint), *c.position)), last + 1 - first);
      if (c.rotation && rotations_ != nullptr)
        out.angle = std::max(out.angle,
                             motion::angle_between(rotations_->rotation(f - first_, c.joint), *c.rotation));
    }
    if (c.position) out.tolerance = tolerance_of(c, c.tolerance);
    if (c.rotation) out.angle_tolerance = c.angle_tolerance > 0 ? c.angle_tolerance : default_angle_tolerance;
    return out;
  }

  ConstraintError operator()(const PathConstraint& c) const {
    const TimedPath path(c.points, seconds_);
    ConstraintError out{.name = concat("path of ", c.points.size(), " points")};
    const auto [first, last] = span(path.first_time(), path.last_time());
    bool faces = false;
    for (std::size_t f = first; f <= last; ++f) {
      if (pose_at(f) == nullptr) continue;
      const PathFrame at = path.at(static_cast<double>(f) / rate_);
      const WorldPose& p = *pose_at(f);
      // Without times only the ends are places of a time.
      const bool placed = path.timed() || f == first || f == last;
      take(out, placed ? std::hypot(p.x - at.x, p.z - at.z) : path.distance(p.x, p.z), last + 1 - first);
      if (!at.yaw) continue;
      faces = true;
      out.angle = std::max(out.angle, std::abs(std::remainder(p.yaw - *at.yaw, 2 * motion::pi)));
    }
    out.tolerance = tolerance_of(c, c.tolerance);
    if (faces) out.angle_tolerance = c.angle_tolerance > 0 ? c.angle_tolerance : 3 * default_angle_tolerance;
    return out;
  }

  ConstraintError operator()(const LoopConstraint& c) const {
    ConstraintError out{.name = "loop"};
    const WorldPose *const begin = pose_at(0), *const end = pose_at(
                                                   frame_at(c.seconds > 0 ? c.seconds : seconds_, rate_));
    if (begin != nullptr && end != nullptr) take(out, apart(*end, *begin, {}, false), 1);
    out.tolerance = tolerance_of(c, c.tolerance);
    return out;
  }

  ConstraintError operator()(const ContactConstraint& c) const {
    ConstraintError out{
        .name = concat(skeleton_.joints[c.joint].name, " stands at ", text(c.from), until(c.from, c.to))};
    const auto [first, last] = span(c.from, c.to);
    motion::Vec3 mean{};
    std::vector<motion::Vec3> places;
    for (std::size_t f = first; f <= last; ++f)
      if (const WorldPose* const own = pose_at(f)) places.push_back(own->joint(c.joint));
    for (const motion::Vec3& p : places)
      mean = motion::add(mean, motion::scale(p, 1 / static_cast<double>(places.size())));
    for (const motion::Vec3& p : places) take(out, motion::length(motion::subtract(p, mean)), places.size());
    out.tolerance = tolerance_of(c, c.tolerance);
    return out;
  }

 private:
  /// The pose of a frame of the whole motion; null if it is not here.
  const WorldPose* pose_at(std::size_t frame) const {
    return frame >= first_ && frame - first_ < poses_.size() ? &poses_[frame - first_] : nullptr;
  }
  double tolerance_of(const Constraint& c, double given) const {
    return given > 0 ? given : default_tolerance(c) * unit_;
  }
  std::pair<std::size_t, std::size_t> span(double from, double to) const {
    return {frame_at(from, rate_), frame_at(to, rate_)};
  }
  static std::string text(double time) { return concat(std::round(time * 1000) / 1000, " s"); }
  static std::string until(double from, double to) { return to > from ? " to " + text(to) : std::string(); }
  static void take(ConstraintError& out, double error, std::size_t frames) {
    out.mean += error / static_cast<double>(frames);
    out.worst = std::max(out.worst, error);
  }

  /// The root mean square distance of the joints.
  static double apart(const WorldPose& a, const WorldPose& b, const std::vector<std::size_t>& joints,
                      bool placed) {
    double sum = 0;
    std::size_t count = 0;
    const auto add = [&](std::size_t j) {
      const motion::Vec3 d =
          placed ? motion::subtract(a.joint(j), b.joint(j)) : motion::subtract(a.body[j], b.body[j]);
      sum += motion::dot(d, d), ++count;
    };
    for (std::size_t j = 0; joints.empty() && j < a.body.size(); ++j) add(j);
    for (const std::size_t j : joints) add(j);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
  }

  std::vector<WorldPose> poses_;  // per frame
  const motion::Skeleton& skeleton_;
  double rate_;
  const PoseReader& read_;
  std::size_t first_;
  double seconds_, unit_;
  const motion::Motion* rotations_;
};

}  // namespace detail

/// The errors of a motion, one for each constraint. `root` is the joint whose position moves the body. A part
/// of a motion that begins with frame `first` is measured as far as it goes; `seconds` is then the length of
/// the whole one. Throws Error for a path as TimedPath does.
inline std::vector<ConstraintError> constraint_errors(const motion::Motion& motion, std::size_t root,
                                                      const std::vector<Constraint>& constraints,
                                                      std::size_t first = 0,
                                                      std::optional<double> seconds = {}) {
  require(motion.frames > 0, "a motion without frames meets no constraint");
  const double whole = seconds.value_or(static_cast<double>(motion.frames - 1) / motion.rate);
  std::vector<WorldPose> poses;
  for (std::size_t f = 0; f < motion.frames; ++f) poses.push_back(world_pose(motion, f, root));
  const PoseReader read = read_by_rotation(root);
  return detail::ErrorMeter(std::move(poses), motion.skeleton, motion.rate, read, first, whole,
                            &motion)(constraints);
}

/// The same for a clip of positions and a model of that format; frame 0 of the clip is time 0.
inline std::vector<ConstraintError> constraint_errors(const motion::PositionFormat& format,
                                                      const motion::PositionClip& clip,
                                                      const std::vector<Constraint>& constraints) {
  require(clip.frames > 0, "a motion without frames meets no constraint");
  const PoseReader read = read_by_places(format.layout);
  return detail::ErrorMeter(world_poses(format.layout, clip.positions), clip.skeleton, clip.rate, read, 0,
                            static_cast<double>(clip.frames - 1) / clip.rate)(constraints);
}

}  // namespace motiongan
