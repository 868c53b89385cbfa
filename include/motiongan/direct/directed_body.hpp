// What constraints have to know of a model: its body, and how poses are read.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "motiongan/data/motion_format.hpp"
#include "motiongan/direct/world_pose.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/networks/place_view.hpp"

namespace motiongan {

/// A frame of a motion of the model's joints as constraints see it.
using PoseReader = std::function<WorldPose(const motion::Motion&, std::size_t frame)>;

/// Where the root is `root`, and faces as its rotation says.
inline PoseReader read_by_rotation(std::size_t root) {
  return [root](const motion::Motion& motion, std::size_t frame) { return world_pose(motion, frame, root); };
}

/// Where the root is joint 0, and the body faces as PositionLayout::places says.
inline PoseReader read_by_places(motion::PositionLayout layout) {
  return [layout = std::move(layout)](const motion::Motion& motion, std::size_t frame) {
    return world_poses(layout, motion::joint_positions(slice(motion, frame, 1))).front();
  };
}

/// What directing needs to know of the body of a model.
struct DirectedBody {
  motion::Skeleton skeleton;
  std::size_t root = 0;                ///< the joint that moves the body
  double rate = 0;                     ///< frames per second
  bool rotates = true;                 ///< poses have rotations, not only places
  bool root_turns = true;              ///< the root's rotation is by its heading
  std::optional<double> floor = {};    ///< its height, if it is known
  std::optional<double> fastest = {};  ///< the root's largest speed over the ground that can be meant
  PoseReader read = {};                ///< reads a frame of a motion as the constraints see it
};

namespace detail {

/// The largest speed of a root whose coordinates change by at most x and z from frame to frame.
inline std::optional<double> speed_of_steps(double x, double z, double rate) {
  const double step = std::hypot(x, z);
  return step > 0 ? std::optional(step * rate) : std::nullopt;
}

}  // namespace detail

/// The largest speed of the root over the ground that the training range of a format allows for, in its unit
/// per second; nothing if the range is unknown. With places relative to a window's start it is the mean speed
/// of a whole window.
inline std::optional<double> fastest(const motion::MotionFormat& format) {
  if (format.low.empty() || !format.layout.root_position()) return {};
  const auto& kept = format.normalizer.kept();
  const auto most = [&](std::size_t dim) {
    const auto at = std::lower_bound(kept.begin(), kept.end(), dim);
    if (at == kept.end() || *at != dim) return 0.0;
    const auto k = static_cast<std::size_t>(at - kept.begin());
    const auto value = [&](double normalised) {
      return std::abs(format.normalizer.mean()[dim] + normalised * format.normalizer.std()[dim]);
    };
    return std::max(value(format.low[k]), value(format.high[k]));
  };
  const std::size_t x = format.layout.position_dim();
  const double frames = format.layout.has_steps() ? 1 : static_cast<double>(format.frames - 1);
  return detail::speed_of_steps(most(x), most(x + 2), format.rate / frames);
}

/// The same of a format of positions, which does not know the range of its steps: six standard deviations of
/// them. Nothing without the root's track.
inline std::optional<double> fastest(const motion::PositionFormat& format) {
  if (!format.layout.root_track()) return {};
  const auto most = [&](std::size_t dim) {
    return std::abs(format.normalizer.mean()[dim]) + 6 * format.normalizer.std()[dim];
  };
  const std::size_t x = format.layout.track_dim();
  return detail::speed_of_steps(most(x), most(x + 1), format.rate);
}

/// The body of a model of texts.
inline DirectedBody directed_body(const motion::MotionFormat& format) {
  return {.skeleton = format.skeleton(),
          .root = format.layout.root(),
          .rate = format.rate,
          .root_turns = format.layout.has_yaw(),
          .floor = format.layout.floor(),
          .fastest = fastest(format),
          .read = read_by_rotation(format.layout.root())};
}

/// The body of a model of classes, whose poses are places of joints.
inline DirectedBody directed_body(const motion::PositionFormat& format) {
  return {.skeleton = format.skeleton(),
          .rate = format.rate,
          .rotates = false,
          .fastest = fastest(format),
          .read = read_by_places(format.layout)};
}

}  // namespace motiongan
