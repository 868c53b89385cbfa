// Comparison of the joints of two skeletons.
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Whether joint_differences is empty: names, parents and order are the same.
inline bool have_same_joints(const Skeleton& a, const Skeleton& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [](const Joint& x, const Joint& y) { return x.name == y.name && x.parent == y.parent; });
}

/// Differences of `other` from `expected`, one entry per joint: missing, extra, renamed (another name at the
/// same index and under the same parent), under another parent or, if nothing else differs, in a different
/// order. Empty if a pose of one skeleton is a pose of the other. Offsets and channels may differ.
inline std::vector<std::string> joint_differences(const Skeleton& expected, const Skeleton& other) {
  const auto parent_of = [](const Skeleton& s, std::size_t j) {
    const int parent = s.joints[j].parent;
    return parent < 0 ? std::string() : s.joints[static_cast<std::size_t>(parent)].name;
  };
  const auto described = [](const std::string& parent) {
    return parent.empty() ? std::string("no parent") : "parent '" + parent + "'";
  };
  const std::size_t common = std::min(expected.size(), other.size());
  if (have_same_joints(expected, other)) return {};

  const auto renamed = [&](std::size_t j) {
    return j < common && expected.joints[j].parent == other.joints[j].parent &&
           other.find(expected.joints[j].name) < 0 && expected.find(other.joints[j].name) < 0;
  };
  std::vector<std::string> out;
  for (std::size_t j = 0; j < expected.size(); ++j) {
    const std::string& name = expected.joints[j].name;
    const int at = other.find(name);
    if (renamed(j)) {
      out.push_back("'" + name + "' is called '" + other.joints[j].name + "'");
    } else if (at < 0) {
      out.push_back("'" + name + "' is missing");
    } else {
      const std::string wanted = parent_of(expected, j),
                        found = parent_of(other, static_cast<std::size_t>(at));
      const int p = expected.joints[j].parent;
      const bool only_named = p >= 0 && renamed(static_cast<std::size_t>(p)) &&
                              other.joints[static_cast<std::size_t>(p)].name == found;
      if (wanted != found && !only_named)
        out.push_back("'" + name + "' has " + described(found) + ", expected " + described(wanted));
    }
  }
  for (std::size_t j = 0; j < other.size(); ++j)
    if (expected.find(other.joints[j].name) < 0 && !renamed(j))
      out.push_back("'" + other.joints[j].name + "' is extra");
  const bool only_order = out.empty();
  for (std::size_t j = 0; only_order && j < common; ++j)
    if (expected.joints[j].name != other.joints[j].name)
      out.push_back("joint " + std::to_string(j) + " is '" + other.joints[j].name + "', expected '" +
                    expected.joints[j].name + "': different order");
  if (out.empty())
    out.push_back(
        concat(other.size(), " joints, expected ", expected.size(), ": joint names are not unique"));
  return out;
}

/// The first `most` of the texts, separated by semicolons, and how many more there are.
inline std::string some_of(const std::vector<std::string>& texts, std::size_t most) {
  std::string list;
  for (std::size_t i = 0; i < std::min(texts.size(), most); ++i) list += (i > 0 ? "; " : "") + texts[i];
  if (texts.size() > most) list += concat("; and ", texts.size() - most, " more");
  return list;
}

/// Throws Error, listing the first eight differences, unless both skeletons have the same joints. `what`
/// names the owner of `other` in the message, such as "the prior walk.bvh".
inline void require_same_joints(const Skeleton& expected, const Skeleton& other, const std::string& what) {
  const std::vector<std::string> differences = joint_differences(expected, other);
  require(differences.empty(), what, " has a different skeleton (", other.size(), " joints, expected ",
          expected.size(), "): ", some_of(differences, 8),
          ". Use motion of the skeleton that the model was trained on; bone lengths may differ");
}

}  // namespace motiongan::motion
