// Mean jerk of joint positions, a measure of smoothness.
#pragma once
#include <cstddef>
#include <span>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan {

/// Mean magnitude of the third derivative of the joints' world positions, in m/s^3 if `unit_metres` is the
/// file's unit in metres (1: in the file's unit per s^3): the mean over joints and frames of
/// |p[t+3] - 3 p[t+2] + 3 p[t+1] - p[t]| * rate^3. Jerk measures smoothness (Flash & Hogan 1985); in this
/// form it is the "jitter" of Yi et al. 2021 (TransPose), who report hundreds of m/s^3.
///
/// Compare motions of one rate: movements shorter than a few frames are missed, and noise grows with the cube
/// of the rate. `positions` are [frames, joints], `rate` in frames per second. Throws Error if the sizes do
/// not fit or for fewer than 4 frames.
inline double mean_jerk(std::span<const motion::Vec3> positions, std::size_t joints, double rate,
                        double unit_metres = 1) {
  require(joints > 0 && positions.size() % joints == 0, "found ", positions.size(),
          " positions, expected whole frames of ", joints, " joints");
  require(positions.size() >= 4 * joints, "found ", positions.size() / joints,
          " frames; a third derivative needs at least 4");
  require(rate > 0 && unit_metres > 0, "found a rate of ", rate, " frames per second and a unit of ",
          unit_metres, " metres, expected more than 0");
  double sum = 0;
  const std::size_t count = positions.size() - 3 * joints;
  for (std::size_t i = 0; i < count; ++i) {
    motion::Vec3 third{};
    for (std::size_t a = 0; a < 3; ++a)
      third[a] = positions[i + 3 * joints][a] - positions[i][a] +
                 3 * (positions[i + joints][a] - positions[i + 2 * joints][a]);
    sum += motion::length(third);
  }
  return unit_metres * rate * rate * rate * sum / static_cast<double>(count);
}

/// The same for a motion, by forward kinematics.
inline double mean_jerk(const motion::Motion& motion, double unit_metres = 1) {
  return mean_jerk(motion::joint_positions(motion), motion.skeleton.size(), motion.rate, unit_metres);
}

}  // namespace motiongan
