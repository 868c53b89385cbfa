// What can be wrong with motion as positions: bones that stretch, a jump where what was made begins, a
// character that does not get anywhere.
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

/// Lengths in these functions' results are in the files' unit times `unit_metres`: 1 gives the file's unit;
/// the size of that unit in metres (CMU 0.05644, Bandai-Namco 0.01) gives metres.
///
/// How much bones differ from their lengths, in percent of those: 100 | |bone| - length | / length, mean over
/// the bones and frames of `positions` [frames, joints]. The lengths are the skeleton's rest lengths, or,
/// where `reference` [joints] is given (such as the prior's first frame), those in it. Bones of zero rest
/// length are skipped. Error if sizes do not fit or there is nothing to compare.
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

/// How far joints move from one frame to the next, mean over joints.
struct FrameStep {
  double world = 0;  ///< as they are
  double body = 0;   ///< after the root's own step is taken off
};

/// The step from one frame [joints] to the next [joints]; joint 0 is the root. Taken from the last frame of
/// the prior to the first one made it is the jump at the seam. Error if the sizes differ.
inline FrameStep frame_step(std::span<const motion::Vec3> before, std::span<const motion::Vec3> after,
                            double unit_metres = 1) {
  require(!before.empty() && before.size() == after.size(), "found frames of ", before.size(), " and ",
          after.size(), " joints, expected as many in both");
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

/// The jump where what was made begins: frame_step from the prior's last frame to the first one made, each
/// [joints]. A real motion makes a median_step there.
inline FrameStep seam_jump(std::span<const motion::Vec3> last_prior_frame,
                           std::span<const motion::Vec3> first_made_frame, double unit_metres = 1) {
  return frame_step(last_prior_frame, first_made_frame, unit_metres);
}

/// The median of the steps between the frames of `positions` [frames, joints], each of the two kinds by
/// itself (the lower of the two in the middle). Error if there are no two frames.
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

/// How far a root gets over the ground (x and z).
struct Distance {
  double path = 0;  ///< every step added up
  double net = 0;   ///< from the first place to the last, straight
};

/// The way of joint 0 in `positions` [frames, joints]. Error if the sizes do not fit.
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
