// Acclaim skeleton files (.asf), which describe the skeleton of the motions in .amc files.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/acclaim_lines.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// How a bone moves: its values in a frame of an .amc file give a rotation M about the bone's own axes, and
/// its rotation relative to its parent is C M C^-1.
struct AsfBone {
  Quat axis;                                  ///< C, from the skeleton's axes to the bone's own
  std::array<std::size_t, 3> order{0, 1, 2};  ///< the axes of M; the first rotation applies first
  std::vector<Channel> values;                ///< of a line of the .amc file, in file order
};

/// An .asf file. A bone is a joint at the bone's start, called like the bone, which carries the bone's
/// rotation: its children start at its end, and a bone without children has an end site there. All joints
/// have rotation channels Z, X, Y, and the root has position channels, so that motions can be written as BVH.
struct AsfSkeleton {
  Skeleton skeleton;           ///< joint 0 is `root`; depth first, in the file's length unit
  std::vector<AsfBone> bones;  ///< [joints], the root's included
  bool radians = false;        ///< the file's angles are in radians
  /// The size of the length unit: inches divided by the file's `length` (0.45 in the CMU files: 0.0564 m).
  std::optional<double> unit_metres;
};

namespace acclaim_detail {

/// A bone as the .asf file lists it.
struct BoneLines {
  std::string name;
  std::optional<Vec3> direction;
  std::optional<double> length;
  Vec3 axis{};  ///< angles in the file's unit
  std::array<std::size_t, 3> order{0, 1, 2};
  std::vector<Channel> values;
  int parent = -1;  ///< index into the list of bones
};

/// Reads an .asf file section by section. The root is bone 0 of the list.
class AsfReader {
 public:
  AsfReader(std::string_view text, std::string_view name) : in_(text, name) {
    bones_.emplace_back().name = "root";
  }

  AsfSkeleton read() {
    std::string section;
    while (in_.next()) {
      const std::string first = lower_case(in_.words().front());
      if (first.starts_with(':')) {
        if (in_bone_) in_.fail("found ", Lines::quoted(first), " in a bone, expected 'end' before it");
        section = first;
      } else if (section == ":units") {
        read_unit(first);
      } else if (section == ":root") {
        read_root(first);
      } else if (section == ":bonedata") {
        read_bone(first);
      } else if (section == ":hierarchy") {
        if (first != "begin" && first != "end") read_children();
      }
    }
    if (in_bone_) in_.fail("the file ends in a bone, expected 'end'");
    require(has_order_, in_.file(), ": the section :root has no line 'order', expected one such as ",
            "'order TX TY TZ RX RY RZ'; is this an .asf file?");
    return build();
  }

 private:
  void read_unit(const std::string& key) {
    if (in_.words().size() < 2) return;
    if (key == "length") {
      double length = 0;  // some files have the unit's name here, which says nothing about the scale
      if (Lines::parse(in_.words()[1], length) && length > 0) out_.unit_metres = 0.0254 / length;
    } else if (key == "angle") {
      const std::string unit = lower_case(in_.words()[1]);
      if (unit != "deg" && unit != "rad")
        in_.fail("the unit of angles is ", Lines::quoted(unit), ", expected deg or rad");
      out_.radians = unit == "rad";
    }
  }

  void read_root(const std::string& key) {
    BoneLines& root = bones_.front();
    if (key == "order") {
      root.values = channels_of(in_, "the root");
      // The root's angles apply in the order in which they are written; axes without one do not matter.
      const auto place = [&](std::size_t a) {
        return std::find(root.values.begin(), root.values.end(), static_cast<Channel>(a + 3));
      };
      std::sort(root_order_.begin(), root_order_.end(),
                [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
      has_order_ = true;
    } else if (key == "axis") {
      root.order = axis_order(in_, 1);
    } else if (key == "position") {
      root_position_ = in_.vector(1, "the root's position");
    } else if (key == "orientation") {
      root.axis = in_.vector(1, "the root's orientation");
    }
  }

  void read_bone(const std::string& key) {
    if (key == "begin") {
      if (in_bone_) in_.fail("found 'begin' in a bone, expected 'end' before it");
      if (bones_.size() >= most_joints) in_.fail("found more than ", most_joints, " bones");
      bones_.emplace_back();
      in_bone_ = true;
      return;
    }
    if (!in_bone_) in_.fail("found ", Lines::quoted(key), " in :bonedata, expected 'begin'");
    BoneLines& bone = bones_.back();
    const std::string called = bone.name.empty() ? "a bone" : "bone '" + bone.name + "'";
    if (key == "end") {
      if (bone.name.empty()) in_.fail("a bone ends without 'name', expected one");
      if (!bone.direction) in_.fail(called, " ends without 'direction', expected one");
      if (!bone.length) in_.fail(called, " ends without 'length', expected one");
      in_bone_ = false;
    } else if (key == "name") {
      if (in_.words().size() != 2)
        in_.fail("found ", in_.words().size() - 1, " words after 'name', expected 1");
      bone.name = in_.words()[1];
      if (find(bone.name) + 1 < bones_.size()) in_.fail("the bone '", bone.name, "' is listed twice");
    } else if (key == "direction") {
      bone.direction = in_.vector(1, "the bone's direction");
    } else if (key == "length") {
      bone.length = in_.real(1, "the bone's length");
      if (*bone.length < 0) in_.fail(called, " has a length of ", *bone.length, ", expected 0 or more");
    } else if (key == "axis") {
      bone.axis = in_.vector(1, "the angles of the bone's axis");
      if (in_.words().size() > 4) bone.order = axis_order(in_, 4);
    } else if (key == "dof") {
      bone.values = channels_of(in_, called);
      for (const Channel c : bone.values)
        if (!is_rotation(c))
          in_.fail(called, " can move along an axis, which is not supported: expected rx, ry and rz only");
    }  // others (id, limits, masses) do not change the motion
  }

  void read_children() {
    const std::size_t parent = known(in_.words().front());
    for (std::size_t i = 1; i < in_.words().size(); ++i) {
      const std::size_t child = known(in_.words()[i]);
      if (child == 0) in_.fail("the root is a child of '", bones_[parent].name, "', expected no parent");
      if (bones_[child].parent >= 0)
        in_.fail("bone '", bones_[child].name, "' has a second parent, '", bones_[parent].name,
                 "', expected one");
      bones_[child].parent = static_cast<int>(parent);
    }
  }

  std::size_t find(std::string_view name) const {
    std::size_t i = 0;
    while (i < bones_.size() && bones_[i].name != name) ++i;
    return i;
  }
  std::size_t known(std::string_view name) const {
    const std::size_t i = find(name);
    if (i == bones_.size())
      in_.fail("found the bone ", Lines::quoted(name), ", expected root or a bone of the section :bonedata");
    return i;
  }

  /// R of three angles in the file's unit; the rotation about the first axis of the order applies first.
  Quat rotation_of(const Vec3& angles, const std::array<std::size_t, 3>& order) const {
    Quat q;
    for (const std::size_t a : order)
      q = multiply(axis_rotation(a, out_.radians ? angles[a] : radians(angles[a])), q);
    return q;
  }

  /// Where the bone ends, from its start.
  Vec3 end_of(const BoneLines& bone) const {
    if (!bone.direction) return {};  // the root
    const double size = length(*bone.direction);
    return size > 0 ? scale(*bone.direction, *bone.length / size) : Vec3{};
  }

  AsfSkeleton build() {
    std::vector<std::vector<std::size_t>> below(bones_.size());
    for (std::size_t i = 1; i < bones_.size(); ++i)
      if (bones_[i].parent >= 0) below[static_cast<std::size_t>(bones_[i].parent)].push_back(i);
    std::vector<std::pair<std::size_t, int>> open{{0, -1}};  // bones, and their parents' joints
    while (!open.empty()) {
      const auto [i, parent] = open.back();
      open.pop_back();
      const BoneLines& bone = bones_[i];
      Joint joint;
      joint.name = bone.name;
      joint.parent = parent;
      joint.offset = i == 0 ? root_position_ : end_of(bones_[static_cast<std::size_t>(bone.parent)]);
      joint.channels = {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
      if (i == 0)
        joint.channels.insert(joint.channels.begin(),
                              {Channel::x_position, Channel::y_position, Channel::z_position});
      if (i > 0 && below[i].empty()) joint.end_site = end_of(bone);
      const int self = static_cast<int>(out_.skeleton.size());
      out_.skeleton.joints.push_back(std::move(joint));
      out_.bones.push_back(
          {rotation_of(bone.axis, bone.order), i == 0 ? root_order_ : bone.order, bone.values});
      for (std::size_t k = below[i].size(); k-- > 0;) open.emplace_back(below[i][k], self);
    }
    for (const BoneLines& bone : bones_)
      require(out_.skeleton.find(bone.name) >= 0, in_.file(), ": bone '", bone.name,
              "' is not connected to the root, expected it in the section :hierarchy");
    return std::move(out_);
  }

  Lines in_;
  AsfSkeleton out_;
  std::vector<BoneLines> bones_;
  std::array<std::size_t, 3> root_order_{0, 1, 2};
  Vec3 root_position_{};
  bool in_bone_ = false, has_order_ = false;
};

}  // namespace acclaim_detail

/// Reads an .asf text; `name` prefixes messages. Limits, masses and documentation are skipped. Throws Error
/// as `name:line: ...` for bones that are incomplete, unknown, listed twice or not connected, and for bones
/// that change their length or move along an axis.
inline AsfSkeleton parse_asf(std::string_view text, std::string_view name) {
  return acclaim_detail::AsfReader(text, name).read();
}

/// Reads an .asf file. Throws Error if it cannot be read or parsed.
inline AsfSkeleton read_asf(const std::filesystem::path& path) {
  return parse_asf(read_text(path, "ASF file"), path.string());
}

}  // namespace motiongan::motion
