// The parts of a human body in a skeleton, found by joint names and by how the joints hang together.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/core/fields.hpp"
#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/limbs_by_shape.hpp"

namespace motiongan::motion {

/// A part of the body: the joint at its beginning (the thigh turns at the hip). Spine and neck may have any
/// number of joints.
enum class BodyPart : std::uint8_t {
  hips,
  spine,
  neck,
  head,
  left_collar,
  left_arm,
  left_forearm,
  left_hand,
  left_thigh,
  left_shin,
  left_foot,
  left_toe,
  right_collar,
  right_arm,
  right_forearm,
  right_hand,
  right_thigh,
  right_shin,
  right_foot,
  right_toe
};
constexpr NameTable<BodyPart, 20> enum_names(BodyPart) {
  using enum BodyPart;
  return {{{hips, "hips"},
           {spine, "spine"},
           {neck, "neck"},
           {head, "head"},
           {left_collar, "left collar"},
           {left_arm, "left upper arm"},
           {left_forearm, "left forearm"},
           {left_hand, "left hand"},
           {left_thigh, "left thigh"},
           {left_shin, "left shin"},
           {left_foot, "left foot"},
           {left_toe, "left toe"},
           {right_collar, "right collar"},
           {right_arm, "right upper arm"},
           {right_forearm, "right forearm"},
           {right_hand, "right hand"},
           {right_thigh, "right thigh"},
           {right_shin, "right shin"},
           {right_foot, "right foot"},
           {right_toe, "right toe"}}};
}

/// The joints of each part that a skeleton has, from the hips outwards.
using BodyParts = std::map<BodyPart, std::vector<std::size_t>>;

/// The joint of a part of one joint. Throws Error, naming the part, if the body does not have it.
inline std::size_t joint_of(const BodyParts& body, BodyPart part) {
  const auto at = body.find(part);
  require(at != body.end() && !at->second.empty(), "the body has no ", name_of(part));
  return at->second.front();
}

namespace body_parts_detail {

inline BodyPart part_of(Side side, Limb limb) {
  const auto first = side == Side::left ? BodyPart::left_collar : BodyPart::right_collar;
  return static_cast<BodyPart>(static_cast<std::size_t>(first) + static_cast<std::size_t>(limb));
}

/// The letters of a name in lower case, without the side: "mixamorig:LeftUpLeg" is "upleg",
/// "thigh_twist_01_l" is "thightwist".
inline std::string bare_name(std::string_view name) {
  const SideMark side = side_mark(name);
  std::string rest(name);
  if (side.side != Side::centre) rest.erase(side.at, side.count);
  if (const auto colon = rest.rfind(':'); colon != std::string::npos) rest.erase(0, colon + 1);
  std::string out;
  for (const char c : rest)
    if (std::isalpha(static_cast<unsigned char>(c)))
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const std::string_view prefix : {"bip", "ccbase", "jbip", "def", "org"})  // of whole rigs
    if (out.starts_with(prefix) && out.size() > prefix.size()) return out.substr(prefix.size());
  return out;
}

/// Helpers of rigs, and joints of hands, feet and faces that are no part of their own.
inline bool is_detail(std::string_view bare) {
  for (const std::string_view part :
       {"twist", "roll",   "nub",  "pole",   "target",  "ctrl",       "thumb",
        "index", "middle", "ring", "pinky",  "finger",  "metacarpal", "metatarsal",
        "palm",  "weapon", "prop", "holder", "correct", "helper"})
    if (bare.find(part) != bare.npos) return true;
  return bare.starts_with("ik") || bare.ends_with("ik") || bare.ends_with("end");
}

/// What a joint of a limb is called in the skeletons of CMU, Mixamo, Unreal, Unity and VRM, DAZ and Poser,
/// Bandai-Namco, MakeHuman, Blender's rigify, 3ds Max and Xsens. Longer names first: "forearm" before "arm".
inline std::optional<Limb> limb_of(std::string_view bare) {
  static constexpr std::pair<std::string_view, Limb> within[] = {
      {"forearm", Limb::forearm}, {"lowerarm", Limb::forearm}, {"elbow", Limb::forearm},
      {"upperarm", Limb::arm},    {"uparm", Limb::arm},        {"shldr", Limb::arm},
      {"collar", Limb::collar},   {"clavicle", Limb::collar},  {"shoulder", Limb::collar},
      {"hand", Limb::hand},       {"wrist", Limb::hand},       {"upperleg", Limb::thigh},
      {"upleg", Limb::thigh},     {"thigh", Limb::thigh},      {"lowerleg", Limb::shin},
      {"lowleg", Limb::shin},     {"shin", Limb::shin},        {"calf", Limb::shin},
      {"knee", Limb::shin},       {"toe", Limb::toe},          {"ball", Limb::toe},
      {"foot", Limb::foot},       {"ankle", Limb::foot}};
  static constexpr std::pair<std::string_view, Limb> whole[] = {
      {"arm", Limb::arm}, {"leg", Limb::shin}, {"hip", Limb::thigh}};
  if (is_detail(bare)) return std::nullopt;
  for (const auto& [name, limb] : within)
    if (bare.find(name) != bare.npos) return limb;
  for (const auto& [name, limb] : whole)
    if (bare == name) return limb;
  return std::nullopt;
}

inline std::vector<std::size_t> path_up(const Skeleton& skeleton, std::size_t joint) {
  std::vector<std::size_t> out{joint};
  while (skeleton.joints[out.back()].parent >= 0)
    out.push_back(static_cast<std::size_t>(skeleton.joints[out.back()].parent));
  return out;
}

inline bool hangs_on(const Skeleton& skeleton, std::size_t joint, std::size_t above) {
  const std::vector<std::size_t> path = path_up(skeleton, joint);
  return joint != above && std::find(path.begin(), path.end(), above) != path.end();
}

/// The joint that both hang on, or one of them.
inline std::size_t common(const Skeleton& skeleton, std::size_t a, std::size_t b) {
  const std::vector<std::size_t> path = path_up(skeleton, b);
  for (const std::size_t j : path_up(skeleton, a))
    if (std::find(path.begin(), path.end(), j) != path.end()) return j;
  return 0;
}

/// The joints between `above` and `below`, from the top.
inline std::vector<std::size_t> between(const Skeleton& skeleton, std::size_t above, std::size_t below) {
  std::vector<std::size_t> out;
  for (int j = skeleton.joints[below].parent; j >= 0 && static_cast<std::size_t>(j) != above;
       j = skeleton.joints[static_cast<std::size_t>(j)].parent)
    out.insert(out.begin(), static_cast<std::size_t>(j));
  return out;
}

/// The joints of one side by name: of each part the first one that hangs on those before it in the limb.
inline LimbJoints limbs_by_name(const Skeleton& skeleton, Side side) {
  LimbJoints out;
  const auto at = [&](Limb limb) -> std::optional<std::size_t>& {
    return out[static_cast<std::size_t>(limb)];
  };
  std::vector<std::optional<Limb>> limbs;
  for (const Joint& joint : skeleton.joints)
    limbs.push_back(side_of(joint.name) == side ? limb_of(bare_name(joint.name)) : std::nullopt);
  const auto first = [&](Limb limb, std::optional<Limb> above) {
    for (std::size_t j = 0; j < skeleton.size() && !at(limb); ++j) {
      if (limbs[j] != limb || feet_detail::is_helper(feet_detail::lower_case(skeleton.joints[j].name)))
        continue;
      if (!above || !at(*above) || hangs_on(skeleton, j, *at(*above))) at(limb) = j;
    }
  };
  first(Limb::collar, {});
  first(Limb::arm, Limb::collar);
  if (!at(Limb::arm)) {  // a "shoulder" that is the upper arm, below a collar or alone
    std::optional<std::size_t> shoulder;
    for (std::size_t j = 0; j < skeleton.size() && at(Limb::collar) && !shoulder; ++j)
      if (limbs[j] == Limb::collar && hangs_on(skeleton, j, *at(Limb::collar))) shoulder = j;
    if (shoulder)
      at(Limb::arm) = shoulder;
    else
      std::swap(at(Limb::arm), at(Limb::collar));
  }
  first(Limb::forearm, Limb::arm);
  first(Limb::hand, Limb::forearm);
  first(Limb::thigh, {});
  first(Limb::shin, Limb::thigh);
  first(Limb::foot, Limb::shin);
  first(Limb::toe, Limb::foot);
  return out;
}

/// The first joint called head, on no side.
inline std::optional<std::size_t> find_head(const Skeleton& skeleton) {
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::string bare = bare_name(skeleton.joints[j].name);
    if (side_of(skeleton.joints[j].name) == Side::centre && bare.find("head") != bare.npos &&
        !is_detail(bare))
      return j;
  }
  return std::nullopt;
}

/// The joints called "spine" and a number, in joint order. Of rigify's, the first is the hips, the last the
/// head.
inline std::vector<std::size_t> spine_by_name(const Skeleton& skeleton) {
  std::vector<std::size_t> out;
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (bare_name(skeleton.joints[j].name) == "spine") out.push_back(j);
  return out;
}

}  // namespace body_parts_detail

/// Finds the parts of a body. Limbs are found by the joints' names, in the conventions of limb_of(), or else
/// by limbs_by_shape(); hips, spine and neck are what joins them: the hips are where the legs and the trunk
/// meet, the spine is what leads from there to where the arms meet, the neck what leads on to the head.
/// Throws Error, naming the parts that are missing and the joints, unless both legs down to the feet and both
/// arms down to the forearms are found.
inline BodyParts find_body(const Skeleton& skeleton) {
  namespace detail = body_parts_detail;
  BodyParts out;
  std::string missing;
  const auto use = [&](const LimbJoints& limbs, Side side) {
    for (std::size_t l = 0; l < limb_count; ++l) {
      const auto limb = static_cast<Limb>(l);
      const BodyPart part = detail::part_of(side, limb);
      if (limbs[l]) {
        out[part] = {*limbs[l]};
      } else if (limb != Limb::collar && limb != Limb::hand && limb != Limb::toe) {
        missing += concat(missing.empty() ? "" : ", ", name_of(part));
      }
    }
  };
  for (const Side side : {Side::left, Side::right}) use(detail::limbs_by_name(skeleton, side), side);
  std::optional<std::size_t> head = detail::find_head(skeleton);
  if (!missing.empty()) {
    const std::optional<ShapedLimbs> shaped = limbs_by_shape(skeleton);
    require(shaped.has_value(), "neither joint names nor the rest pose say which are: ", missing,
            "; give a map of the joints. The joints are: ", feet_detail::joint_names(skeleton));
    out.clear();
    use(shaped->left, Side::left), use(shaped->right, Side::right);
    if (!head) head = shaped->head;
  }
  const auto joint = [&](BodyPart part) { return out.at(part).front(); };
  const std::size_t chest = detail::common(skeleton, joint(BodyPart::left_arm), joint(BodyPart::right_arm));
  if (!head) {  // rigify's is the last of the spine
    const std::vector<std::size_t> spine = detail::spine_by_name(skeleton);
    if (!spine.empty() && detail::hangs_on(skeleton, spine.back(), chest)) head = spine.back();
  }
  const std::size_t legs =
      detail::common(skeleton, joint(BodyPart::left_thigh), joint(BodyPart::right_thigh));
  const std::size_t hips = detail::common(skeleton, legs, chest);
  out[BodyPart::hips] = {hips};
  std::vector<std::size_t> spine = detail::between(skeleton, hips, chest);
  if (chest != hips) spine.push_back(chest);
  if (!spine.empty()) out[BodyPart::spine] = spine;
  if (head) {
    out[BodyPart::head] = {*head};
    // Where the head hangs below the chest's last joint or beside it.
    const std::size_t from = detail::common(skeleton, *head, chest);
    const std::vector<std::size_t> neck = detail::between(skeleton, from, *head);
    if (!neck.empty()) out[BodyPart::neck] = neck;
  }
  return out;
}

}  // namespace motiongan::motion
