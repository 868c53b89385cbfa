// A simple body around a skeleton: a capsule for each bone, as triangles that are skinned to the joints.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation_fit.hpp"

namespace motiongan::motion {

/// Triangles in the pose without rotations.
struct CapsuleBody {
  std::vector<Vec3> rest;                 ///< places of the joints, [joints]
  std::vector<float> positions, normals;  ///< [vertices, 3]
  std::vector<std::uint16_t> joints;      ///< [vertices, 4]; only the first has a weight
  std::vector<float> weights;             ///< [vertices, 4]
  std::vector<std::uint32_t> triangles;   ///< [triangles, 3], counter-clockwise from outside
};

namespace capsule_detail {

/// Adds a capsule from `from` along `bone`, which moves with `joint`.
inline void add_capsule(CapsuleBody& body, const Vec3& from, const Vec3& bone, double radius,
                        std::uint16_t joint) {
  constexpr std::size_t around = 8, rings = 6;  // three rings for either end
  const double n = length(bone);
  const Vec3 axis = n > 0 ? scale(bone, 1 / n) : Vec3{0, 1, 0}, side = any_normal(axis),
             other = cross(axis, side);
  const auto first = static_cast<std::uint32_t>(body.positions.size() / 3);
  for (std::size_t r = 0; r < rings; ++r) {
    // From the pole of one end to that of the other.
    const double latitude = -pi / 2 + pi / 4 * static_cast<double>(r < 3 ? r : r - 1);
    const Vec3 centre = r < 3 ? from : add(from, bone);
    for (std::size_t a = 0; a < around; ++a) {
      const double angle = 2 * pi * static_cast<double>(a) / around;
      const Vec3 normal =
          add(scale(axis, std::sin(latitude)),
              scale(add(scale(side, std::cos(angle)), scale(other, std::sin(angle))), std::cos(latitude)));
      for (const double v : add(centre, scale(normal, radius)))
        body.positions.push_back(static_cast<float>(v));
      for (const double v : normal) body.normals.push_back(static_cast<float>(v));
      for (const std::uint16_t j : {joint, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0}})
        body.joints.push_back(j);
      for (const float w : {1.0F, 0.0F, 0.0F, 0.0F}) body.weights.push_back(w);
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t a = 0; a < around; ++a) {
      const std::uint32_t next = (a + 1) % around, low = first + r * static_cast<std::uint32_t>(around),
                          high = low + static_cast<std::uint32_t>(around);
      for (const std::uint32_t v : {low + a, low + next, high + next, low + a, high + next, high + a})
        body.triangles.push_back(v);
    }
}

}  // namespace capsule_detail

/// A capsule along every bone and end site of the skeleton, thick ones for the trunk, and a short one at
/// joints where a chain ends. Lengths are multiplied by `scale`.
inline CapsuleBody capsule_body(const Skeleton& skeleton, double scale) {
  require(skeleton.size() < 65536, "a body of ", skeleton.size(), " joints, expected fewer than 65536");
  const double leg = body_unit(skeleton) * scale, thin = 0.02 * leg, thick = 0.07 * leg;
  CapsuleBody out;
  for (const Vec3& place : rest_positions(skeleton)) out.rest.push_back(motion::scale(place, scale));
  const auto below = children(skeleton);
  const auto bone = [&](std::size_t joint, const Vec3& offset) {
    const Vec3 along = motion::scale(offset, scale);
    const double n = length(along);
    const bool trunk = side_of(skeleton.joints[joint].name) == Side::centre;
    if (n > 1e-4 * leg)
      capsule_detail::add_capsule(out, out.rest[joint], along,
                                  trunk ? thick : std::clamp(0.15 * n, thin, thick),
                                  static_cast<std::uint16_t>(joint));
  };
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    for (const std::size_t child : below[j])
      // What leads from the ground to the hips is no part of the body.
      if (j != 0 || below[j].size() > 1) bone(j, skeleton.joints[child].offset);
    if (joint.end_site) bone(j, *joint.end_site);
    if (below[j].empty() && !joint.end_site && length(joint.offset) > 0) {
      const double n = length(joint.offset) * scale;
      const double size = feet_detail::lower_case(joint.name).find("head") != std::string::npos
                              ? 0.1 * leg
                              : std::min(0.05 * leg, n / 2);
      capsule_detail::add_capsule(out, out.rest[j], motion::scale(joint.offset, size / length(joint.offset)),
                                  std::clamp(size, thin, 0.13 * leg), static_cast<std::uint16_t>(j));
    }
  }
  if (out.positions.empty())  // a single point
    capsule_detail::add_capsule(out, out.rest.front(), {0, thick, 0}, std::max(thick, 0.05), 0);
  return out;
}

}  // namespace motiongan::motion
