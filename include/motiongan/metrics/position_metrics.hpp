// Metrics of motion as joint positions: bone-length error, jump at the seam, distance travelled.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/metrics/joint_angle.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan {

/// Bone-length error in percent: 100 | |bone| - length | / length, averaged over bones and over the frames of
/// `positions` [frames, joints]. The lengths are those of the skeleton's rest pose or, if given, of the frame
/// `reference` [joints], such as the prior's first frame. Bones of zero rest length are skipped. Throws Error
/// if the sizes do not fit or there is no bone to compare.
inline double bone_length_error(const motion::Skeleton& skeleton, std::span<const motion::Vec3> positions,
                                std::span<const motion::Vec3> reference = {}) {
  const std::size_t joints = skeleton.size();
  require(joints > 0 && !positions.empty() && positions.size() % joints == 0, "found ", positions.size(),
          " positions, expected at least one frame of ", joints, " joints");
  require(reference.empty() || reference.size() == joints, "the reference frame has ", reference.size(),
          " positions, expected one for each of ", joints, " joints");
  const std::vector<double> rest = motion::bone_lengths(skeleton);
  const std::vector<char> bone = joints_with_bone(skeleton);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    if (!bone[j]) continue;
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    const double wanted =
        reference.empty() ? rest[j] : motion::length(motion::subtract(reference[j], reference[parent]));
    require(wanted > 0, "the bone to joint '", skeleton.joints[j].name,
            "' has no length in the reference frame, but ", rest[j], " at rest; take another frame");
    for (std::size_t at = 0; at < positions.size(); at += joints, ++count)
      sum += std::abs(motion::length(motion::subtract(positions[at + j], positions[at + parent])) - wanted) /
             wanted;
  }
  require(count > 0, "a skeleton of ", joints, " joints has no bone with a length");
  return 100 * sum / static_cast<double>(count);
}

/// Distance that joints move from one frame to the next, averaged over joints.
///
/// Here and below, lengths are in the file's unit times `unit_metres`: 1 keeps the file's unit, the unit's
/// size in metres (CMU 0.05644, Bandai-Namco 0.01) gives metres.
struct FrameStep {
  double world = 0;  ///< in world space
  double body = 0;   ///< relative to the root's step
};

/// The step from one frame [joints] to the next [joints]; joint 0 is the root. Throws Error if the sizes
/// differ or are 0.
inline FrameStep frame_step(std::span<const motion::Vec3> before, std::span<const motion::Vec3> after,
                            double unit_metres = 1) {
  require(!before.empty() && before.size() == after.size(), "found frames of ", before.size(), " and ",
          after.size(), " joints, expected the same number in both");
  const motion::Vec3 root = motion::subtract(after[0], before[0]);
  FrameStep out;
  for (std::size_t j = 0; j < before.size(); ++j) {
    const motion::Vec3 step = motion::subtract(after[j], before[j]);
    out.world += motion::length(step);
    out.body += motion::length(motion::subtract(step, root));
  }
  const double factor = unit_metres / static_cast<double>(before.size());
  return {out.world * factor, out.body * factor};
}

/// The jump at the seam: frame_step() from the prior's last frame to the first generated one, each [joints].
/// In real motion it is about a median_step().
inline FrameStep seam_jump(std::span<const motion::Vec3> last_prior_frame,
                           std::span<const motion::Vec3> first_made_frame, double unit_metres = 1) {
  return frame_step(last_prior_frame, first_made_frame, unit_metres);
}

/// Medians of the steps between the frames of `positions` [frames, joints], separately for world and body; of
/// two middle values the lower. Throws Error for fewer than two frames.
inline FrameStep median_step(std::span<const motion::Vec3> positions, std::size_t joints,
                             double unit_metres = 1) {
  require(joints > 0 && positions.size() % joints == 0 && positions.size() >= 2 * joints, "found ",
          positions.size(), " positions, expected at least two frames of ", joints, " joints");
  std::vector<double> world, body;
  for (std::size_t at = joints; at < positions.size(); at += joints) {
    const FrameStep s =
        frame_step(positions.subspan(at - joints, joints), positions.subspan(at, joints), unit_metres);
    world.push_back(s.world);
    body.push_back(s.body);
  }
  const auto median = [](std::vector<double>& v) {
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>((v.size() - 1) / 2);
    std::nth_element(v.begin(), middle, v.end());
    return *middle;
  };
  return {median(world), median(body)};
}

/// Distance covered by the root over the ground (x and z).
struct Distance {
  double path = 0;  ///< sum of all steps
  double net = 0;   ///< straight line from the first to the last position
};

/// Distance travelled by joint 0 in `positions` [frames, joints]. Throws Error if the sizes do not fit.
inline Distance distance_travelled(std::span<const motion::Vec3> positions, std::size_t joints,
                                   double unit_metres = 1) {
  require(joints > 0 && positions.size() % joints == 0, "found ", positions.size(),
          " positions, expected whole frames of ", joints, " joints");
  Distance out;
  if (positions.empty()) return out;
  const auto apart = [&](const motion::Vec3& a, const motion::Vec3& b) {
    return unit_metres * std::hypot(b[0] - a[0], b[2] - a[2]);
  };
  for (std::size_t at = joints; at < positions.size(); at += joints)
    out.path += apart(positions[at - joints], positions[at]);
  out.net = apart(positions.front(), positions[positions.size() - joints]);
  return out;
}

}  // namespace motiongan
