// The feet and the head of a skeleton, by joint name, and the length of its legs.
#pragma once
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace feet_detail {

inline std::string lower_case(std::string_view name) {
  std::string out;
  for (const char c : name) out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Whether a joint is a rig's helper ("ik_foot_l", "LeftFoot_IK"), which has no place in the body.
inline bool is_helper(std::string_view lower) {
  return lower.starts_with("ik_") || lower.find("_ik") != lower.npos || lower.find(":ik_") != lower.npos;
}

inline std::string joint_names(const Skeleton& skeleton) {
  std::string all;
  for (const Joint& joint : skeleton.joints) all += (all.empty() ? "" : ", ") + joint.name;
  return all;
}

/// A left and a right foot, or nothing if not both are found.
inline std::vector<std::size_t> feet_by_name(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(lower_case(joint.name));
  for (const std::string_view part : {"toe", "foot", "ankle"}) {
    std::optional<std::size_t> left, right;
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (names[j].find(part) == std::string::npos || is_helper(names[j])) continue;
      const Side side = side_of(skeleton.joints[j].name);
      if (side == Side::left && !left) left = j;
      if (side == Side::right && !right) right = j;
    }
    if (left && right) return {*left, *right};
  }
  return {};
}

}  // namespace feet_detail

/// Whether find_feet(skeleton) succeeds.
inline bool has_feet(const Skeleton& skeleton) { return !feet_detail::feet_by_name(skeleton).empty(); }

/// Finds the feet of a skeleton by joint name: the first toe ("LeftToeBase", "Toes_L") of each side, or else
/// the first foot, or else the first ankle. Throws Error, listing the joint names, if there are none.
inline std::vector<std::size_t> find_feet(const Skeleton& skeleton) {
  std::vector<std::size_t> feet = feet_detail::feet_by_name(skeleton);
  require(!feet.empty(),
          "no joint names contain a side and toe, foot or ankle (such as LeftToeBase, Toes_L); name the feet "
          "yourself, two of: ",
          feet_detail::joint_names(skeleton));
  return feet;
}

/// The joints of the given names, or find_feet(skeleton) if there are none. Throws Error for an unknown name.
inline std::vector<std::size_t> find_feet(const Skeleton& skeleton, std::span<const std::string> names) {
  if (names.empty()) return find_feet(skeleton);
  std::vector<std::size_t> out;
  for (const std::string& name : names) {
    const int at = skeleton.find(name);
    require(at >= 0, "there is no joint '", name,
            "' to use as a foot; the skeleton has: ", feet_detail::joint_names(skeleton));
    out.push_back(static_cast<std::size_t>(at));
  }
  return out;
}

/// The head: the first joint whose name contains "head", or -1.
inline int find_head(const Skeleton& skeleton) {
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::string name = feet_detail::lower_case(skeleton.joints[j].name);
    if (name.find("head") != name.npos && !feet_detail::is_helper(name)) return static_cast<int>(j);
  }
  return -1;
}

namespace feet_detail {

/// Number of `joints` at or below each joint, [joints of the skeleton].
inline std::vector<std::size_t> count_below(const Skeleton& skeleton, std::span<const std::size_t> joints) {
  std::vector<std::size_t> below(skeleton.size(), 0);
  for (const std::size_t joint : joints)
    for (int j = static_cast<int>(joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent)
      ++below[static_cast<std::size_t>(j)];
  return below;
}

/// leg_length, or 0.
inline double leg_length_or_zero(const Skeleton& skeleton, std::span<const std::size_t> feet) {
  if (feet.empty()) return 0;
  const std::vector<std::size_t> below = count_below(skeleton, feet);
  double sum = 0;
  for (const std::size_t foot : feet)
    for (std::size_t j = foot; skeleton.joints[j].parent >= 0;
         j = static_cast<std::size_t>(skeleton.joints[j].parent)) {
      if (feet.size() > 1 && below[j] == feet.size()) break;
      sum += length(skeleton.joints[j].offset);
    }
  return sum / static_cast<double>(feet.size());
}

}  // namespace feet_detail

/// Leg length in the file's unit: along the rest pose's bones from the nearest common ancestor of all feet to
/// each foot, averaged over feet. Throws Error if it is 0.
inline double leg_length(const Skeleton& skeleton, std::span<const std::size_t> feet) {
  const double leg = feet_detail::leg_length_or_zero(skeleton, feet);
  require(leg > 0, "the legs of the skeleton have no length; give the size of the file's unit in metres");
  return leg;
}

/// Leg length by the names of the feet, in the file's unit; 0 if no joints are named like feet.
inline double leg_length(const Skeleton& skeleton) {
  return feet_detail::leg_length_or_zero(skeleton, feet_detail::feet_by_name(skeleton));
}

/// The length that measures a body in the file's unit: its leg length or, without feet, half its longest
/// chain of bones.
inline double body_unit(const Skeleton& skeleton) {
  if (const double leg = leg_length(skeleton); leg > 0) return leg;
  std::vector<double> reach(skeleton.size(), 0);
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (const int p = skeleton.joints[j].parent; p >= 0)
      reach[j] = reach[static_cast<std::size_t>(p)] + length(skeleton.joints[j].offset);
  return reach.empty() ? 0 : *std::max_element(reach.begin(), reach.end()) / 2;
}

}  // namespace motiongan::motion
