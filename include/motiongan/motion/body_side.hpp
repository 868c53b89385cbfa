// Left and right by joint name, and pairs of mirrored joints.
#pragma once
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The side of the body that a joint is on.
enum class Side : std::uint8_t { centre, left, right };

/// A side and the part of the name that indicates it, name.substr(at, count); empty if `side` is centre.
struct SideMark {
  Side side = Side::centre;
  std::size_t at = 0, count = 0;
};

/// The side indicated by a joint's name: "LeftFoot", "LThumb", "UpperLeg_L", "mixamorig:LeftArm".
inline SideMark side_mark(std::string_view name) {
  const std::size_t prefix = name.rfind(':') == std::string_view::npos ? 0 : name.rfind(':') + 1;
  name.remove_prefix(prefix);
  std::string lower;
  for (const char c : name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (const std::size_t at = lower.find("left"); at != std::string::npos) return {Side::left, prefix + at, 4};
  if (const std::size_t at = lower.find("right"); at != std::string::npos)
    return {Side::right, prefix + at, 5};
  const std::size_t n = name.size();
  if (n < 2) return {};
  const auto stands_alone = [](char c) { return c == '_' || c == '.' || c == '-' || c == ' '; };
  const auto letter = [&](std::size_t at) {
    const char c = name[at];
    const Side side = c == 'l' || c == 'L' ? Side::left : c == 'r' || c == 'R' ? Side::right : Side::centre;
    return side == Side::centre ? SideMark{} : SideMark{side, prefix + at, 1};
  };
  if (stands_alone(name[n - 2]) && letter(n - 1).side != Side::centre) return letter(n - 1);
  if (stands_alone(name[1]) && letter(0).side != Side::centre) return letter(0);
  for (std::size_t at = 1; at + 1 < n; ++at)  // "J_Bip_L_Hand", "Bip01 L Hand"
    if (stands_alone(name[at - 1]) && stands_alone(name[at + 1]) && letter(at).side != Side::centre)
      return letter(at);
  // "LHipJoint" and "lFoot", but not "LowerBack".
  return std::isupper(static_cast<unsigned char>(name[1])) ? letter(0) : SideMark{};
}

/// The side of the body a joint is on, by its name.
inline Side side_of(std::string_view name) { return side_mark(name).side; }

/// Whether the names denote a left joint and its right counterpart, i.e. differ only in the side.
inline bool are_mirrored(std::string_view left, std::string_view right) {
  const SideMark l = side_mark(left), r = side_mark(right);
  return l.side == Side::left && r.side == Side::right && left.substr(0, l.at) == right.substr(0, r.at) &&
         left.substr(l.at + l.count) == right.substr(r.at + r.count);
}

/// Two joints on opposite sides of the body.
using JointPair = std::pair<std::size_t, std::size_t>;

namespace body_side_detail {

/// Pairs of mirrored joints, by name, among the children of `left` and of `right`.
inline std::vector<JointPair> mirrored_children(const Skeleton& skeleton,
                                                const std::vector<std::vector<std::size_t>>& below,
                                                std::size_t left, std::size_t right) {
  std::vector<JointPair> out;
  for (const std::size_t l : below[left])
    for (const std::size_t r : below[right])
      if (are_mirrored(skeleton.joints[l].name, skeleton.joints[r].name)) out.emplace_back(l, r);
  return out;
}

}  // namespace body_side_detail

/// The pairs of joints (left, right) that determine which way a body faces. By name: for every two mirrored
/// branches (legs, arms), the first mirrored joints at different places; the CMU skeleton's hip joints
/// coincide, so there it is the thighs. If no names indicate a side: of the children of the first joint with
/// several, the two furthest apart over the ground at rest, which gives some direction across the body, not
/// necessarily left. Empty if no such pair exists.
inline std::vector<JointPair> across_body(const Skeleton& skeleton) {
  namespace detail = body_side_detail;
  const auto below = children(skeleton);
  const std::vector<Vec3> rest = rest_positions(skeleton);
  double size = 0;
  for (const double bone : bone_lengths(skeleton)) size += bone;
  const double apart = 1e-6 * size;
  std::vector<JointPair> out;
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    for (JointPair pair : detail::mirrored_children(skeleton, below, j, j))
      for (;;) {
        if (length(subtract(rest[pair.first], rest[pair.second])) > apart) {
          out.push_back(pair);
          break;
        }
        const auto next = detail::mirrored_children(skeleton, below, pair.first, pair.second);
        if (next.empty()) break;
        pair = next.front();
      }
  if (!out.empty()) return out;

  for (const std::vector<std::size_t>& branches : below) {
    if (branches.size() < 2) continue;
    double widest = apart;
    for (std::size_t a = 0; a < branches.size(); ++a)
      for (std::size_t b = a + 1; b < branches.size(); ++b) {
        const Vec3 d = subtract(rest[branches[a]], rest[branches[b]]);
        if (std::hypot(d[0], d[2]) <= widest) continue;
        widest = std::hypot(d[0], d[2]);
        out = {{branches[a], branches[b]}};
      }
    break;  // only the first branching joint
  }
  return out;
}

}  // namespace motiongan::motion
