// Motion of one body on another one: other joint names, proportions, rest pose and local axes.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/joint_map.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation_fit.hpp"

namespace motiongan::motion {

namespace retarget_detail {

/// A skeleton in a pose, in the world.
struct PosedBody {
  std::vector<Quat> rotations;  ///< [joints]
  std::vector<Vec3> positions;  ///< [joints], joint 0 at its offset
};

inline PosedBody posed(const Skeleton& skeleton, const std::vector<Quat>& local) {
  Motion one;
  one.skeleton = skeleton;
  one.rate = 1, one.frames = 1;
  one.rotations = local;
  for (const Joint& joint : skeleton.joints) one.positions.push_back(joint.offset);
  GlobalPose global = forward_kinematics(one);
  return {std::move(global.rotations), std::move(global.positions)};
}

inline Vec3 unit(const Vec3& v) {
  const double n = length(v);
  return n > 0 ? scale(v, 1 / n) : Vec3{};
}

/// How upright a body stands, arms beside it or held out: 5 if legs hang down straight, the trunk rises over
/// them and each arm is straight.
inline double uprightness(const BodyParts& body, const PosedBody& pose) {
  using enum BodyPart;
  const auto bone = [&](BodyPart a, BodyPart b) {
    return unit(subtract(pose.positions[joint_of(body, b)], pose.positions[joint_of(body, a)]));
  };
  double sum = 0;
  for (const auto& [thigh, shin, foot] :
       {std::array{left_thigh, left_shin, left_foot}, std::array{right_thigh, right_shin, right_foot}})
    sum -= bone(thigh, shin)[1] + bone(shin, foot)[1];
  for (const auto& [arm, forearm, hand] :
       {std::array{left_arm, left_forearm, left_hand}, std::array{right_arm, right_forearm, right_hand}})
    if (body.contains(arm) && body.contains(forearm) && body.contains(hand))
      sum += dot(bone(arm, forearm), bone(forearm, hand)) / 2;
  const BodyPart top = body.contains(head) ? head : left_arm;
  return sum + (body.contains(top) ? bone(hips, top)[1] : 0);
}

/// The rotation from a body that faces +Z, with its left at +X, to the body in its pose, about the vertical.
inline Quat facing(const BodyParts& body, const PosedBody& pose) {
  Vec3 across{};
  for (const auto& [left, right] : {std::pair{BodyPart::left_thigh, BodyPart::right_thigh},
                                    std::pair{BodyPart::left_arm, BodyPart::right_arm}})
    if (body.contains(left) && body.contains(right))
      across =
          add(across, subtract(pose.positions[joint_of(body, left)], pose.positions[joint_of(body, right)]));
  return quat_from_expmap({0, std::atan2(-across[2], across[0]), 0});
}

}  // namespace retarget_detail

/// A pose in which a skeleton stands upright, so that it can be compared with another one: all rotations zero
/// if the skeleton then stands, or else the most upright frame of `motion`. In many files (Bandai-Namco's,
/// for example) a skeleton without rotations is no body. Local rotations, [joints]. Throws Error if the
/// motion has no frame and the skeleton does not stand.
inline std::vector<Quat> reference_pose(const Skeleton& skeleton, const BodyParts& body,
                                        const Motion& motion = {}) {
  namespace detail = retarget_detail;
  std::vector<Quat> best(skeleton.size());
  constexpr double stands = 3.5;  // of at most 6; a T-pose with bent knees has 5
  double most = detail::uprightness(body, detail::posed(skeleton, best));
  if (most >= stands) return best;
  require(
      motion.frames > 0 && motion.skeleton.size() == skeleton.size(),
      "without rotations, the skeleton does not stand upright; give a motion of it, to see how it stands");
  const auto joints = static_cast<std::ptrdiff_t>(skeleton.size());
  const std::size_t step = std::max<std::size_t>(motion.frames / 500, 1);
  for (std::size_t f = 0; f < motion.frames; f += step) {
    const auto first = motion.rotations.begin() + static_cast<std::ptrdiff_t>(f) * joints;
    std::vector<Quat> pose(first, first + joints);
    const double upright = detail::uprightness(body, detail::posed(skeleton, pose));
    if (upright > most) most = upright, best = std::move(pose);
  }
  return best;
}

/// What a Retargeter needs to know of a body.
struct RetargetBody {
  Skeleton skeleton;
  std::vector<Quat> reference;  ///< see reference_pose()
};

/// Transfers motion from one skeleton to another. Bones of arms and legs point where those of the source
/// point, whatever the rest poses and local axes; trunk, head, hands and feet turn as much as the source's
/// from a standing pose; a spine or neck of another number of joints shares the bend; joints that the source
/// does not have keep their reference rotation. The hips travel in proportion to the legs, and over the
/// ground as the source does.
class Retargeter {
 public:
  /// Throws Error unless the map fits both skeletons and the legs have lengths.
  Retargeter(RetargetBody from, RetargetBody to, JointMap map)
      : from_(std::move(from)), to_(std::move(to)), map_(std::move(map)) {
    namespace detail = retarget_detail;
    const detail::PosedBody source = detail::posed(from_.skeleton, from_.reference),
                            target = detail::posed(to_.skeleton, to_.reference);
    target_rotations_ = target.rotations;
    for (const Quat& q : source.rotations) unturned_.push_back(inverse(q));
    const double from_leg = leg(map_.from, source), to_leg = leg(map_.to, target);
    require(from_leg > 0 && to_leg > 0, "a leg has no length, so that the bodies cannot be compared");
    scale_ = to_leg / from_leg;
    const Quat turn = multiply(detail::facing(map_.from, source), inverse(detail::facing(map_.to, target)));
    link_parts(turn);
    lean_trunk(turn, source, target);
    point_limbs(turn, source, target);
    hips_from_ = joint_of(map_.from, BodyPart::hips);
    hips_to_ = joint_of(map_.to, BodyPart::hips);
    height_from_ = above_floor(map_.from, source, hips_from_);
    height_to_ = above_floor(map_.to, target, hips_to_);
    carrier_ = carrier();
  }

  /// With find_joint_map(), and references from the motions, if there are any: a motion of `from`, or of
  /// `to`.
  Retargeter(const Motion& from, const Motion& to)
      : Retargeter(from, to, find_joint_map(from.skeleton, to.skeleton)) {}
  /// Between the joints that `map` pairs.
  Retargeter(const Motion& from, const Motion& to, const JointMap& map)
      : Retargeter(RetargetBody{from.skeleton, reference_pose(from.skeleton, map.from, from)},
                   RetargetBody{to.skeleton, reference_pose(to.skeleton, map.to, to)}, map) {}

  const JointMap& map() const { return map_; }
  /// Of lengths, from the source's to the target's.
  double length_scale() const { return scale_; }
  /// The skeleton of the motion that comes out: the target's, with position channels at the joint that moves.
  const Skeleton& skeleton() const { return to_.skeleton; }

  /// The motion on the other skeleton, frame by frame: a motion may come in pieces. Throws Error for another
  /// skeleton.
  Motion operator()(const Motion& motion) const {
    check_motion(motion);
    require(motion.skeleton.size() == from_.skeleton.size(), "a motion of ", motion.skeleton.size(),
            " joints, expected the ", from_.skeleton.size(), " of the skeleton that motion comes from");
    const GlobalPose global = forward_kinematics(motion);
    const std::size_t joints = to_.skeleton.size(), from = from_.skeleton.size();
    Motion out;
    out.skeleton = to_.skeleton;
    out.rate = motion.rate, out.frames = motion.frames;
    std::vector<Quat> world(joints);
    std::vector<Vec3> places(joints);
    for (std::size_t f = 0; f < motion.frames; ++f) {
      const auto moved = [&](std::size_t j) {
        return multiply(global.rotations[f * from + j], unturned_[j]);
      };
      for (std::size_t j = 0; j < joints; ++j) {
        const int parent = to_.skeleton.joints[j].parent;
        const Quat above = parent < 0 ? Quat{} : world[static_cast<std::size_t>(parent)];
        if (const std::optional<Link>& l = links_[j]) {
          const Quat delta = l->share > 0 ? slerp(moved(l->a), moved(l->b), l->share) : moved(l->a);
          world[j] = normalize(multiply(delta, multiply(l->align, target_rotations_[j])));
          out.rotations.push_back(normalize(multiply(inverse(above), world[j])));
        } else {
          world[j] = normalize(multiply(above, to_.reference[j]));
          out.rotations.push_back(to_.reference[j]);
        }
        const Vec3& offset = to_.skeleton.joints[j].offset;
        out.positions.push_back(offset);
        places[j] =
            parent < 0 ? offset : add(places[static_cast<std::size_t>(parent)], rotate(above, offset));
      }
      const Vec3& hips = global.positions[f * from + hips_from_];
      const Vec3 wish{scale_ * hips[0], scale_ * (hips[1] - height_from_) + height_to_, scale_ * hips[2]};
      const int parent = to_.skeleton.joints[carrier_].parent;
      const Quat above = parent < 0 ? Quat{} : world[static_cast<std::size_t>(parent)];
      Vec3& carried = out.position(f, carrier_);
      carried = add(carried, rotate(inverse(above), subtract(wish, places[hips_to_])));
    }
    return out;
  }

  /// The same for a whole motion, which is then moved up or down so that its feet stand as high as those of
  /// the source, in proportion: by the 5th percentile of their heights.
  Motion standing(const Motion& motion) const {
    std::optional<double> rise;
    return standing(motion, rise);
  }

  /// The same for a motion that comes in pieces: all are moved by `rise`, in the target's unit, which the
  /// first one sets.
  Motion standing(const Motion& piece, std::optional<double>& rise) const {
    Motion out = (*this)(piece);
    if (!rise) rise = scale_ * floor_of(piece, map_.from) - floor_of(out, map_.to);
    for (std::size_t f = 0; f < out.frames; ++f) raise(out, f, carrier_, *rise);
    return out;
  }

 private:
  /// The joints that stand on the floor: toes where there are any, as in find_feet().
  static std::array<std::size_t, 2> feet_of(const BodyParts& body) {
    using enum BodyPart;
    return {joint_of(body, body.contains(left_toe) ? left_toe : left_foot),
            joint_of(body, body.contains(right_toe) ? right_toe : right_foot)};
  }

  static double floor_of(const Motion& motion, const BodyParts& body) {
    std::vector<std::string> names;
    for (const std::size_t foot : feet_of(body)) names.push_back(motion.skeleton.joints[foot].name);
    return floor_under(motion, names);
  }

  /// A target joint turns as a source joint, or between two.
  struct Link {
    std::size_t a = 0, b = 0;
    double share = 0;
    Quat align{};  ///< from the target's reference pose to the source's
  };

  static std::optional<std::size_t> first_of(const BodyParts& body, BodyPart part) {
    const auto at = body.find(part);
    return at == body.end() ? std::nullopt : std::optional(at->second.front());
  }

  /// Every part that both bodies have turns as the source's, from poses in which both face the same way.
  void link_parts(const Quat& turn) {
    links_.resize(to_.skeleton.size());
    for (const auto& [part, name] : enum_names(BodyPart{})) {
      if (part == BodyPart::spine || part == BodyPart::neck) continue;
      const auto to = first_of(map_.to, part), from = first_of(map_.from, part);
      if (to && from) links_[*to] = Link{*from, *from, 0, turn};
    }
    const auto spine = map_.from.find(BodyPart::spine);
    const std::size_t hips = joint_of(map_.from, BodyPart::hips);
    link_chain(BodyPart::spine, hips, {}, turn);
    link_chain(BodyPart::neck, spine == map_.from.end() ? hips : spine->second.back(),
               first_of(map_.from, BodyPart::head), turn);
  }

  /// Whether both references are rest poses.
  bool at_rest() const {
    const auto still = [](const std::vector<Quat>& pose) {
      return std::all_of(pose.begin(), pose.end(), [](const Quat& q) { return q == Quat{}; });
    };
    return still(from_.reference) && still(to_.reference);
  }

  /// Between poses of which one is seen in a motion, where the body may have leant, the trunk leans as the
  /// source's. Between rest poses it does not: shoulders lie in front of the hips or behind them, as the body
  /// is built.
  void lean_trunk(const Quat& turn, const retarget_detail::PosedBody& source,
                  const retarget_detail::PosedBody& target) {
    using enum BodyPart;
    if (at_rest()) return;
    const auto trunk = [](const BodyParts& body, const retarget_detail::PosedBody& pose) {
      return retarget_detail::unit(subtract(
          scale(add(pose.positions[joint_of(body, left_arm)], pose.positions[joint_of(body, right_arm)]),
                0.5),
          pose.positions[joint_of(body, hips)]));
    };
    if (!map_.from.contains(left_arm) || !map_.to.contains(left_arm) || !map_.from.contains(right_arm) ||
        !map_.to.contains(right_arm))
      return;
    const Quat lean =
        multiply(shortest_rotation(rotate(turn, trunk(map_.to, target)), trunk(map_.from, source), {}), turn);
    for (const BodyPart part : {hips, spine, left_collar, right_collar})
      if (const auto at = map_.to.find(part); at != map_.to.end())
        for (const std::size_t j : at->second)
          if (links_[j]) links_[j]->align = lean;
  }

  /// Bones of arms and legs point where the source's point; a hand goes on as the forearm does. So do feet,
  /// and toes, where a reference is no rest pose, in which they would be flat.
  void point_limbs(const Quat& turn, const retarget_detail::PosedBody& source,
                   const retarget_detail::PosedBody& target) {
    using enum BodyPart;
    std::vector<std::pair<BodyPart, BodyPart>> bones{{left_arm, left_forearm},   {left_forearm, left_hand},
                                                     {left_thigh, left_shin},    {left_shin, left_foot},
                                                     {right_arm, right_forearm}, {right_forearm, right_hand},
                                                     {right_thigh, right_shin},  {right_shin, right_foot}};
    std::vector<std::pair<BodyPart, BodyPart>> ends{{left_hand, left_forearm}, {right_hand, right_forearm}};
    if (!at_rest()) {
      bones.insert(bones.end(), {{left_foot, left_toe}, {right_foot, right_toe}});
      ends.insert(ends.end(), {{left_toe, left_foot}, {right_toe, right_foot}});
    }
    for (const auto& [part, next] : bones) {
      const auto to = first_of(map_.to, part), to_end = first_of(map_.to, next),
                 from = first_of(map_.from, part), from_end = first_of(map_.from, next);
      if (!to || !from || !to_end || !from_end) continue;
      const Vec3 is = rotate(
                     turn, retarget_detail::unit(subtract(target.positions[*to_end], target.positions[*to]))),
                 wish = retarget_detail::unit(subtract(source.positions[*from_end], source.positions[*from]));
      if (length(is) > 0 && length(wish) > 0)
        links_[*to]->align = multiply(shortest_rotation(is, wish, {}), turn);
    }
    for (const auto& [end, before] : ends)
      if (const auto at = first_of(map_.to, end), above = first_of(map_.to, before);
          at && above && links_[*at] && links_[*above])
        links_[*at]->align = links_[*above]->align;
  }

  /// Length of the legs from the hip joints to the ankles.
  static double leg(const BodyParts& body, const retarget_detail::PosedBody& pose) {
    using enum BodyPart;
    double sum = 0;
    for (const auto& [a, b] : {std::pair{left_thigh, left_shin}, std::pair{left_shin, left_foot},
                               std::pair{right_thigh, right_shin}, std::pair{right_shin, right_foot}})
      sum += length(subtract(pose.positions[joint_of(body, b)], pose.positions[joint_of(body, a)])) / 2;
    return sum;
  }

  /// The height of the hips above the lower foot.
  static double above_floor(const BodyParts& body, const retarget_detail::PosedBody& pose, std::size_t hips) {
    const auto [left, right] = feet_of(body);
    return pose.positions[hips][1] - std::min(pose.positions[left][1], pose.positions[right][1]);
  }

  /// Links the joints of a spine or neck: those of the target divide the source's, which begins with `first`
  /// and, if `last` is given, ends before it.
  void link_chain(BodyPart part, std::size_t first, std::optional<std::size_t> last, const Quat& turn) {
    const auto to = map_.to.find(part), from = map_.from.find(part);
    if (to == map_.to.end()) return;
    std::vector<std::size_t> along{first};
    if (from != map_.from.end()) along.insert(along.end(), from->second.begin(), from->second.end());
    if (last) along.push_back(*last);
    // Every joint of the shorter chain goes with one of the longer, so that there and back is the same again.
    const std::size_t source = along.size() - 1, target = to->second.size() + (last ? 1 : 0);
    const auto with = [](std::size_t i, std::size_t shorter, std::size_t longer) {
      return (2 * i * longer + shorter) / (2 * shorter);  // rounded
    };
    for (std::size_t k = 1; k <= to->second.size(); ++k) {
      std::size_t below = 0;
      double share = 0;
      if (source >= target) {
        below = with(k, target, source);
      } else if (source > 0) {
        while (with(below + 1, source, target) <= k) ++below;
        const auto from_joint = static_cast<double>(with(below, source, target));
        if (below < source)
          share = (static_cast<double>(k) - from_joint) /
                  (static_cast<double>(with(below + 1, source, target)) - from_joint);
      }
      links_[to->second[k - 1]] = Link{along[below], along[std::min(below + 1, source)], share, turn};
    }
  }

  /// The joint whose position moves the body: the hips, or the joint above them that has position channels.
  /// Without any, the hips get them.
  std::size_t carrier() {
    const auto positions = [&](std::size_t j) {
      return std::count_if(to_.skeleton.joints[j].channels.begin(), to_.skeleton.joints[j].channels.end(),
                           [](Channel c) { return !is_rotation(c); });
    };
    for (int j = static_cast<int>(hips_to_); j >= 0;
         j = to_.skeleton.joints[static_cast<std::size_t>(j)].parent)
      if (positions(static_cast<std::size_t>(j)) == 3) return static_cast<std::size_t>(j);
    std::vector<Channel>& channels = to_.skeleton.joints[hips_to_].channels;
    std::erase_if(channels, [](Channel c) { return !is_rotation(c); });
    if (channels.empty()) channels = {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
    channels.insert(channels.begin(), {Channel::x_position, Channel::y_position, Channel::z_position});
    return hips_to_;
  }

  RetargetBody from_, to_;
  JointMap map_;
  double scale_ = 1, height_from_ = 0, height_to_ = 0;
  std::size_t hips_from_ = 0, hips_to_ = 0, carrier_ = 0;
  std::vector<Quat> unturned_, target_rotations_;  ///< of the references, in the world: inverse, as they are
  std::vector<std::optional<Link>> links_;         ///< [target joints]
};

}  // namespace motiongan::motion
