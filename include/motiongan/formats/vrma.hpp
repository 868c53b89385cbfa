// Writing VRM animations (.vrma): glTF binaries that any VRM avatar can play.
#pragma once
#include <filesystem>
#include <string>
#include <utility>

#include "motiongan/formats/glb.hpp"
#include "motiongan/motion/retarget.hpp"

namespace motiongan::motion {

/// The skeleton of VRM animations: the humanoid bones of VRM 1.0 under their own names, in a T-pose that
/// faces +Z, with the proportions of a grown person, in metres.
inline Skeleton vrm_skeleton() {
  Skeleton out;
  const auto joint = [&](const std::string& name, int parent, const Vec3& offset) {
    Joint made;
    made.name = name, made.parent = parent, made.offset = offset;
    if (parent < 0) made.channels = {Channel::x_position, Channel::y_position, Channel::z_position};
    made.channels.insert(made.channels.end(),
                         {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation});
    out.joints.push_back(std::move(made));
    return static_cast<int>(out.size()) - 1;
  };
  const int hips = joint("hips", -1, {0, 0.95, 0});
  for (const auto& [side, x] : {std::pair{std::string("left"), 1.0}, std::pair{std::string("right"), -1.0}}) {
    int at = joint(side + "UpperLeg", hips, {0.09 * x, -0.05, 0});
    at = joint(side + "LowerLeg", at, {0, -0.41, 0});
    at = joint(side + "Foot", at, {0, -0.41, 0});
    joint(side + "Toes", at, {0, -0.06, 0.13});
  }
  int at = joint("spine", hips, {0, 0.08, 0});
  at = joint("chest", at, {0, 0.13, 0});
  const int chest = at = joint("upperChest", at, {0, 0.13, 0});
  at = joint("neck", at, {0, 0.17, 0});
  joint("head", at, {0, 0.09, 0});
  for (const auto& [side, x] : {std::pair{std::string("left"), 1.0}, std::pair{std::string("right"), -1.0}}) {
    at = joint(side + "Shoulder", chest, {0.03 * x, 0.12, 0});
    at = joint(side + "UpperArm", at, {0.13 * x, 0, 0});
    at = joint(side + "LowerArm", at, {0.27 * x, 0, 0});
    joint(side + "Hand", at, {0.25 * x, 0, 0});
  }
  return out;
}

/// The bytes of a VRM animation of the motion, put on vrm_skeleton() by a Retargeter: the extension
/// VRMC_vrm_animation, version 1.0. Throws Error as Retargeter and glb_file() do, for a skeleton that is no
/// body or for a motion without frames.
inline std::string vrma_file(const std::string& name, const Motion& motion) {
  require(motion.frames > 0, "'", name, "' has no frames and cannot be written as a VRM animation");
  Motion avatar;
  avatar.skeleton = vrm_skeleton();
  const NamedMotion made{name, Retargeter(motion, avatar).standing(motion)};
  glb_detail::Document document;
  const glb_detail::Nodes nodes =
      glb_detail::add_skeleton(document, made.motion.skeleton, {.unit_metres = 1, .body = false}, "avatar");
  glb_detail::add_animation(document, made, nodes);
  nlohmann::json bones;
  for (std::size_t j = 0; j < avatar.skeleton.size(); ++j)
    bones[avatar.skeleton.joints[j].name] = {{"node", nodes.of_joint[j]}};
  document["extensionsUsed"] = {"VRMC_vrm_animation"};
  document["extensions"]["VRMC_vrm_animation"] = {{"specVersion", "1.0"},
                                                  {"humanoid", {{"humanBones", bones}}}};
  return document.file();
}

/// Writes vrma_file() to `path`, replacing it at once.
inline void write_vrma(const std::filesystem::path& path, const std::string& name, const Motion& motion) {
  io::AtomicFile file(path);
  file.write(vrma_file(name, motion));
  file.commit();
}

}  // namespace motiongan::motion
