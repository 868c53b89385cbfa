// Bone lists, which give position files their joint hierarchy, and bone offsets estimated from positions.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/tab_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Reads lines of `joint <TAB> parent` in joint order; the root comes first and has the parent `-`. Blank
/// lines and lines that start with # are skipped. There are only names and parents: all offsets are zero, see
/// with_offsets_of. Throws Error as `name:line: ...` for a missing tab, a duplicate name, a parent not
/// defined above, or a second root.
inline Skeleton parse_bone_list(std::string_view text, std::string_view name) {
  Skeleton out;
  for_each_tab_line(text, name, "joint <TAB> parent (- for the root)", [&](const TabLine& line) {
    const auto [joint, parent] = std::pair{line.before, line.after};
    require(!joint.empty() && joint != "-", name, ":", line.number, ": found '", joint,
            "' before the tab, expected a joint's name");
    require(!parent.empty() && parent.find('\t') == parent.npos, name, ":", line.number, ": joint '", joint,
            "' has the parent '", parent, "', expected one joint's name, or - for the root");
    require(out.size() < most_joints, name, ":", line.number, ": found more than ", most_joints, " joints");
    require(out.find(joint) < 0, name, ":", line.number, ": joint '", joint,
            "' is listed twice; joint names must be unique");
    Joint entry;
    entry.name = joint;
    if (parent == "-") {
      require(out.size() == 0, name, ":", line.number, ": found a second root, '", joint,
              "'; expected one root, in the first line");
    } else {
      entry.parent = out.find(parent);
      require(
          entry.parent >= 0, name, ":", line.number, ": joint '", joint, "' has the parent '", parent,
          "', which no line above defines; parents come before their children, and the root's parent is -");
    }
    out.joints.push_back(std::move(entry));
  });
  require(out.size() > 0, name, ": found no joints, expected lines of joint <TAB> parent (- for the root)");
  return out;
}

/// As parse_bone_list, from a file. Throws Error also if the file cannot be read.
inline Skeleton read_bone_list(const std::filesystem::path& path) {
  return parse_bone_list(read_text(path, "bone list", largest_list_file), path.string());
}

/// Writes joints and parents as read_bone_list reads them; offsets and channels are not stored. Throws Error
/// for a name that could not be read back.
inline void write_bone_list(const std::filesystem::path& path, const Skeleton& skeleton) {
  std::string text = "# joint\tparent\n";
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const int parent = skeleton.joints[j].parent;
    // What the reader takes: it trims lines, and blanks within a name are part of it.
    const bool sound = !name.empty() && name != "-" && name.front() != '#' && trimmed(name) == name &&
                       name.find_first_of("\t\r\n") == name.npos;
    require(
        sound, "a joint called '", name, "' cannot be written to ", path.string(),
        ": a name must not be empty or -, contain a tab or line break, begin or end with a blank, or begin "
        "with #");
    text +=
        name + '\t' + (parent < 0 ? "-" : skeleton.joints.at(static_cast<std::size_t>(parent)).name) + '\n';
  }
  parse_bone_list(text, path.string());  // throws if order or names could not be read back
  write_text_atomically(path, text);
}

/// The skeleton with offsets estimated from `positions` [frames, joints], y up, in the file's unit. A bone's
/// offset has its direction in the first frame (so the rest pose is that frame's) and its mean length over
/// all frames. A bone shorter than a millionth of the mean bone gets a zero offset, as does the root. Throws
/// Error if there is no frame or the sizes do not match.
inline Skeleton with_offsets_of(Skeleton skeleton, std::span<const Vec3> positions) {
  const std::size_t joints = skeleton.size();
  require(joints > 0 && !positions.empty() && positions.size() % joints == 0, "found ", positions.size(),
          " joint positions, expected at least one frame of ", joints, " joints");
  const std::size_t frames = positions.size() / joints;
  std::vector<double> lengths(joints, 0);
  double mean = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = skeleton.joints[j];
    joint.offset = {};
    if (joint.parent < 0) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      const Vec3 bone =
          subtract(positions[f * joints + j], positions[f * joints + static_cast<std::size_t>(joint.parent)]);
      const double size = length(bone);
      lengths[j] += size / static_cast<double>(frames);
      // The first frame in which the bone has a direction: nearly always frame 0.
      if (size > 0 && length(joint.offset) <= 0) joint.offset = scale(bone, 1 / size);
    }
    mean += lengths[j] / static_cast<double>(joints);
  }
  for (std::size_t j = 0; j < joints; ++j)
    skeleton.joints[j].offset = scale(skeleton.joints[j].offset, lengths[j] > 1e-6 * mean ? lengths[j] : 0);
  return skeleton;
}

}  // namespace motiongan::motion
