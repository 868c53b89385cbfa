// What a directed motion has to meet: poses, points, a path, a loop, feet that stand.
#pragma once
#include <cmath>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan {

// Times are in seconds from the first frame and mean the nearest frame; lengths are in the model's unit, y is
// up. A weight multiplies a constraint's squared error; a tolerance of 0 stands for the kind's own, see
// default_tolerance().

/// The body is in a given pose, or in those of a clip, from `time` on.
struct PoseConstraint {
  double time = 0;                       ///< seconds
  motion::Motion pose = {};              ///< one frame or more, of the model's joints, at the model's rate
  std::vector<std::size_t> joints = {};  ///< those that count; empty: all
  /// Also where the body is and where it faces. Otherwise only the pose and its height count.
  bool placed = false;
  double weight = 1, tolerance = 0;  ///< the root mean square distance of the joints
};

/// A joint is at a point, or has a rotation relative to its parent, from `from` to `to`.
struct JointConstraint {
  std::size_t joint = 0;
  double from = 0, to = 0;                    ///< seconds
  std::optional<motion::Vec3> position = {};  ///< in the world
  std::optional<motion::Quat> rotation = {};  ///< relative to the parent
  double weight = 1;
  double tolerance = 0;        ///< the largest distance
  double angle_tolerance = 0;  ///< the largest angle, radians
};

/// A point of a path over the ground.
struct PathPoint {
  double x = 0, z = 0;
  std::optional<double> time = {};  ///< seconds, when the root should be there; not set: at any time
  std::optional<double> yaw = {};   ///< where the body faces, radians about y from +z
};

/// The root goes along straight lines between points. Points without times share the time between those that
/// have one, in proportion to the way; without any, the whole motion is the way, and the pace is free within
/// limits. Where no point says where to face, the body faces along the path, which is not counted as an
/// error.
struct PathConstraint {
  std::vector<PathPoint> points = {};
  double weight = 1, tolerance = 0;  ///< the largest distance of the root from the path
  double angle_tolerance = 0;        ///< the largest angle to a given yaw, radians
};

/// The pose at `seconds` is that of the first frame, and moves as it does there.
struct LoopConstraint {
  double seconds = 0;                ///< 0: the whole motion
  double weight = 1, tolerance = 0;  ///< the root mean square distance of the joints
};

/// A foot, or another joint, stands still from `from` to `to`; if the model knows the floor, on it.
struct ContactConstraint {
  std::size_t joint = 0;
  double from = 0, to = 0;
  double weight = 1, tolerance = 0;  ///< how far it moves
};

/// Something that a motion should meet.
using Constraint =
    std::variant<PoseConstraint, JointConstraint, PathConstraint, LoopConstraint, ContactConstraint>;

/// The frame nearest to a time.
inline std::size_t frame_at(double seconds, double rate) {
  return static_cast<std::size_t>(std::lround(seconds * rate));
}

/// The tolerance of an angle where none is given: 5 degrees.
inline constexpr double default_angle_tolerance = 5 * motion::pi / 180;

/// The tolerance of a length where none is given, in legs (motion::body_unit): a twentieth for joints, poses
/// and loops, which is 4 cm for a person, and a fifth for a path, for a body sways about its way.
inline double default_tolerance(const Constraint& constraint) {
  return std::holds_alternative<PathConstraint>(constraint) ? 0.2 : 0.05;
}

}  // namespace motiongan
