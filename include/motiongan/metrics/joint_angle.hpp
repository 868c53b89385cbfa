// Joint angles: the mean angle between adjacent bones (Malek-Podjaski & Deligianni, Fig. 2).
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan {

/// Whether the bone that ends in each joint has a rest length of at least a millionth of the mean, [joints].
inline std::vector<char> joints_with_bone(const motion::Skeleton& skeleton) {
  const std::vector<double> lengths = motion::bone_lengths(skeleton);
  double sum = 0;
  for (const double l : lengths) sum += l;
  std::vector<char> out;
  for (const double l : lengths)
    out.push_back(l > 0 && l * static_cast<double>(lengths.size() - 1) >= 1e-6 * sum);
  return out;
}

/// Two adjacent bones, each identified by the joint in which it ends.
struct BonePair {
  std::size_t in = 0, out = 0;
};

/// All pairs of adjacent bones, in the order of the joints in which the second one ends. Bones of zero rest
/// length are skipped: their two joints coincide, and the bones on either side are adjacent.
inline std::vector<BonePair> adjacent_bones(const motion::Skeleton& skeleton) {
  const std::vector<char> bone = joints_with_bone(skeleton);
  std::vector<BonePair> out;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (!bone[j]) continue;
    int in = skeleton.joints[j].parent;
    while (in >= 0 && !bone[static_cast<std::size_t>(in)])
      in = skeleton.joints[static_cast<std::size_t>(in)].parent;
    if (in >= 0) out.push_back({static_cast<std::size_t>(in), j});
  }
  return out;
}

/// Angle in degrees, 0..180, between two vectors; 0 if one of them is zero.
inline double angle_between_degrees(const motion::Vec3& a, const motion::Vec3& b) {
  // atan2 rather than the arc cosine of the dot product, which loses small angles to rounding.
  return motion::degrees(std::atan2(motion::length(motion::cross(a, b)), motion::dot(a, b)));
}

/// Mean angle in degrees between adjacent bones (0: straight), over adjacent_bones(), for every frame of
/// `positions` [frames, joints]: [frames] (Malek-Podjaski & Deligianni, Fig. 2). Positions may be in any unit
/// and any frame of reference. Throws Error if the sizes do not fit or there are no adjacent bones.
inline std::vector<double> mean_joint_angle(const motion::Skeleton& skeleton,
                                            std::span<const motion::Vec3> positions) {
  const std::size_t joints = skeleton.size();
  require(joints > 0 && positions.size() % joints == 0, "found ", positions.size(),
          " positions, expected whole frames of ", joints, " joints");
  const std::vector<BonePair> pairs = adjacent_bones(skeleton);
  require(!pairs.empty(), "a skeleton of ", joints,
          " joints has no adjacent bones, so it has no joint angle");
  const auto bone = [&](const motion::Vec3* pose, std::size_t j) {
    return motion::subtract(pose[j], pose[static_cast<std::size_t>(skeleton.joints[j].parent)]);
  };
  std::vector<double> out;
  for (std::size_t at = 0; at < positions.size(); at += joints) {
    double sum = 0;
    for (const BonePair& pair : pairs)
      sum += angle_between_degrees(bone(&positions[at], pair.in), bone(&positions[at], pair.out));
    out.push_back(sum / static_cast<double>(pairs.size()));
  }
  return out;
}

}  // namespace motiongan
