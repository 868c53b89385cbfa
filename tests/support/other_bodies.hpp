// Skeletons in the conventions of other tools: names, proportions and rest poses.
#pragma once
#include <map>
#include <motiongan/motion/kinematics.hpp>
#include <motiongan/motion/rotation_fit.hpp>
#include <motiongan/procedural/procedural.hpp>
#include <string>

namespace motiongan::testing {

/// The built-in skeleton with other names. A name that is not in the map keeps its own, after `prefix`. Bones
/// are scaled by `size`, those of the legs by `legs` too.
inline motion::Skeleton renamed(const std::map<std::string, std::string>& names,
                                const std::string& prefix = "", double size = 1, double legs = 1) {
  motion::Skeleton skeleton = motion::procedural_motion(0, {.seconds = 1}).motion.skeleton;
  for (motion::Joint& joint : skeleton.joints) {
    const bool leg = joint.name.ends_with("Leg") || joint.name.ends_with("Foot");
    joint.offset = motion::scale(joint.offset, leg ? size * legs : size);
    if (joint.end_site) joint.end_site = motion::scale(*joint.end_site, size);
    const auto at = names.find(joint.name);
    joint.name = at == names.end() ? prefix + joint.name : at->second;
  }
  return skeleton;
}

/// Names for both sides: `left` has those of the left limbs, with "#" for the side.
inline std::map<std::string, std::string> both_sides(const std::map<std::string, std::string>& left,
                                                     const std::string& is_left,
                                                     const std::string& is_right) {
  std::map<std::string, std::string> out;
  for (const auto& entry : left) {
    const std::string &name = entry.first, &other = entry.second;
    const auto with = [&](const std::string& side) {
      const auto at = other.find('#');
      return at == std::string::npos ? other : other.substr(0, at) + side + other.substr(at + 1);
    };
    if (name.starts_with("Left")) {
      out[name] = with(is_left);
      out["Right" + name.substr(4)] = with(is_right);
    } else {
      out[name] = other;
    }
  }
  return out;
}

/// The skeleton with names that say nothing.
inline motion::Skeleton without_names(motion::Skeleton skeleton) {
  for (std::size_t j = 0; j < skeleton.size(); ++j) skeleton.joints[j].name = "Bone" + std::to_string(j);
  return skeleton;
}

/// One frame of the skeleton without rotations.
inline motion::Motion at_rest(const motion::Skeleton& skeleton) {
  motion::Motion out;
  out.skeleton = skeleton;
  out.rate = 30, out.frames = 1;
  out.rotations.resize(skeleton.size());
  for (const motion::Joint& joint : skeleton.joints) out.positions.push_back(joint.offset);
  return out;
}

inline motion::Skeleton mixamo() { return renamed({}, "mixamorig:", 0.01, 1.2); }

inline motion::Skeleton unreal() {
  motion::Skeleton body = renamed(both_sides({{"Hips", "pelvis"},
                                              {"Spine", "spine_01"},
                                              {"Spine1", "spine_02"},
                                              {"Spine2", "spine_03"},
                                              {"Neck", "neck_01"},
                                              {"Head", "head"},
                                              {"LeftShoulder", "clavicle_#"},
                                              {"LeftArm", "upperarm_#"},
                                              {"LeftForeArm", "lowerarm_#"},
                                              {"LeftHand", "hand_#"},
                                              {"LeftUpLeg", "thigh_#"},
                                              {"LeftLeg", "calf_#"},
                                              {"LeftFoot", "foot_#"},
                                              {"LeftToeBase", "ball_#"}},
                                             "l", "r"),
                                  "", 1.1, 0.9);
  // Under a root, with a twist joint and a hand that the body is not.
  motion::Skeleton out;
  motion::Joint root;
  root.name = "root";
  root.channels = {motion::Channel::z_rotation, motion::Channel::y_rotation, motion::Channel::x_rotation};
  out.joints.push_back(root);
  for (motion::Joint joint : body.joints) {
    joint.parent += 1;
    out.joints.push_back(std::move(joint));
  }
  motion::Joint twist;
  twist.name = "upperarm_twist_01_l";
  twist.parent = out.find("upperarm_l");
  twist.offset = {5, 0, 0};
  const int at = out.find("hand_l") + 1;  // the end of the arm's branch
  for (motion::Joint& joint : out.joints)
    if (joint.parent >= at) ++joint.parent;
  out.joints.insert(out.joints.begin() + at, twist);
  return out;
}

inline motion::Skeleton vrm() {
  return renamed(both_sides({{"Hips", "hips"},
                             {"Spine", "spine"},
                             {"Spine1", "chest"},
                             {"Spine2", "upperChest"},
                             {"Neck", "neck"},
                             {"Head", "head"},
                             {"LeftShoulder", "#Shoulder"},
                             {"LeftArm", "#UpperArm"},
                             {"LeftForeArm", "#LowerArm"},
                             {"LeftHand", "#Hand"},
                             {"LeftUpLeg", "#UpperLeg"},
                             {"LeftLeg", "#LowerLeg"},
                             {"LeftFoot", "#Foot"},
                             {"LeftToeBase", "#Toes"}},
                            "left", "right"));
}

inline motion::Skeleton rigify() {
  return renamed(both_sides({{"Hips", "spine"},
                             {"Spine", "spine.001"},
                             {"Spine1", "spine.002"},
                             {"Spine2", "spine.003"},
                             {"Neck", "spine.004"},
                             {"Head", "spine.005"},
                             {"LeftShoulder", "shoulder.#"},
                             {"LeftArm", "upper_arm.#"},
                             {"LeftForeArm", "forearm.#"},
                             {"LeftHand", "hand.#"},
                             {"LeftUpLeg", "thigh.#"},
                             {"LeftLeg", "shin.#"},
                             {"LeftFoot", "foot.#"},
                             {"LeftToeBase", "toe.#"}},
                            "L", "R"));
}

inline motion::Skeleton smpl() {
  return renamed(both_sides({{"Hips", "Pelvis"},
                             {"LeftShoulder", "#_Collar"},
                             {"LeftArm", "#_Shoulder"},
                             {"LeftForeArm", "#_Elbow"},
                             {"LeftHand", "#_Wrist"},
                             {"LeftUpLeg", "#_Hip"},
                             {"LeftLeg", "#_Knee"},
                             {"LeftFoot", "#_Ankle"},
                             {"LeftToeBase", "#_Toe"}},
                            "L", "R"));
}

inline motion::Skeleton biped() {
  return renamed(both_sides({{"Hips", "Bip01 Pelvis"},
                             {"Spine", "Bip01 Spine"},
                             {"Spine1", "Bip01 Spine1"},
                             {"Spine2", "Bip01 Spine2"},
                             {"Neck", "Bip01 Neck"},
                             {"Head", "Bip01 Head"},
                             {"LeftShoulder", "Bip01 # Clavicle"},
                             {"LeftArm", "Bip01 # UpperArm"},
                             {"LeftForeArm", "Bip01 # Forearm"},
                             {"LeftHand", "Bip01 # Hand"},
                             {"LeftUpLeg", "Bip01 # Thigh"},
                             {"LeftLeg", "Bip01 # Calf"},
                             {"LeftFoot", "Bip01 # Foot"},
                             {"LeftToeBase", "Bip01 # Toe0"}},
                            "L", "R"));
}

/// A body whose arms hang down at 50 degrees at rest, which faces +X, and whose spine has one joint less.
inline motion::Skeleton in_a_pose() {
  motion::Skeleton skeleton = mixamo();
  const auto joint = [&](const char* name) -> motion::Joint& {
    return skeleton.joints[static_cast<std::size_t>(skeleton.find(std::string("mixamorig:") + name))];
  };
  const motion::Quat facing = motion::quat_from_expmap({0, motion::pi / 2, 0});
  for (motion::Joint& j : skeleton.joints) {
    j.offset = rotate(facing, j.offset);
    if (j.end_site) j.end_site = rotate(facing, *j.end_site);
  }
  for (const auto& [side, sign] : {std::pair{"Left", -1.0}, std::pair{"Right", 1.0}})
    for (const char* part : {"ForeArm", "Hand"}) {
      motion::Vec3& offset = joint((std::string(side) + part).c_str()).offset;
      // About the axis that the body faces along, which is +X here.
      offset = rotate(motion::quat_from_expmap({-sign * motion::radians(-50), 0, 0}), offset);
    }
  return skeleton;
}

/// The built-in skeleton as Bandai-Namco's: without rotations all its bones lie along X. `frames` of a walk.
inline motion::Motion along_x(const motion::Motion& walk) {
  motion::Motion out = walk;
  const std::size_t joints = walk.skeleton.size();
  const auto below = children(walk.skeleton);
  // Each joint's frame is turned so that the bone to its first child lies along X.
  std::vector<motion::Quat> frame(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    if (below[j].empty()) {
      frame[j] = j == 0 ? motion::Quat{} : frame[static_cast<std::size_t>(walk.skeleton.joints[j].parent)];
      continue;
    }
    const motion::Vec3 bone = walk.skeleton.joints[below[j].front()].offset;
    frame[j] = motion::shortest_rotation({1, 0, 0}, motion::scale(bone, 1 / motion::length(bone)), {});
  }
  const auto of_parent = [&](std::size_t j) {
    const int p = walk.skeleton.joints[j].parent;
    return p < 0 ? motion::Quat{} : frame[static_cast<std::size_t>(p)];
  };
  for (std::size_t j = 0; j < joints; ++j)
    out.skeleton.joints[j].offset = rotate(inverse(of_parent(j)), walk.skeleton.joints[j].offset);
  for (std::size_t f = 0; f < walk.frames; ++f)
    for (std::size_t j = 0; j < joints; ++j) {
      out.rotation(f, j) =
          motion::normalize(multiply(inverse(of_parent(j)), multiply(walk.rotation(f, j), frame[j])));
      out.position(f, j) = rotate(inverse(of_parent(j)), walk.position(f, j));
    }
  return out;
}

}  // namespace motiongan::testing
