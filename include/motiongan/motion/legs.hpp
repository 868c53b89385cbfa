// The legs of a skeleton, and bending a leg so that its foot reaches a place.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation_fit.hpp"

namespace motiongan::motion {

/// The joints of a leg. `thigh` turns the thigh and is at the hip, `knee` turns the shin, `ankle` the foot;
/// `foot` is the joint that touches the floor: a toe, or the ankle itself.
struct Leg {
  std::size_t thigh = 0, knee = 0, ankle = 0, foot = 0;
};

/// The legs of the feet that find_feet(skeleton, names) finds, in its order. The knee is the joint between
/// the two longest neighbouring bones on the way from the hips to the foot, whatever the joints are called.
/// Throws Error if there are no feet, or if a foot does not hang on two bones of some length.
inline std::vector<Leg> find_legs(const Skeleton& skeleton, std::span<const std::string> names = {}) {
  const std::vector<std::size_t> feet = find_feet(skeleton, names),
                                 below = feet_detail::count_below(skeleton, feet);
  const auto bone = [&](std::size_t j) { return length(skeleton.joints[j].offset); };
  std::vector<Leg> legs;
  for (const std::size_t foot : feet) {
    std::vector<std::size_t> path{foot};  // upwards, to the joint that all feet hang on
    while (skeleton.joints[path.back()].parent >= 0 && (feet.size() == 1 || below[path.back()] < feet.size()))
      path.push_back(static_cast<std::size_t>(skeleton.joints[path.back()].parent));
    Leg leg{.foot = foot};
    double longest = 0;
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const double thigh = bone(path[i]), shin = bone(path[i - 1]);
      if (std::min(thigh, shin) <= 0 || thigh + shin <= longest) continue;
      longest = thigh + shin;
      leg.thigh = path[i + 1], leg.knee = path[i], leg.ankle = path[i - 1];
    }
    require(longest > 0, "the foot ", skeleton.joints[foot].name,
            " does not hang on a thigh and a shin; name other feet, two of: ",
            feet_detail::joint_names(skeleton));
    legs.push_back(leg);
  }
  return legs;
}

/// Position and rotation of a joint of one frame in the world.
struct WorldJoint {
  Vec3 position{};
  Quat rotation{};
};

/// Position and rotation of `joint` in the world, in frame `frame`.
inline WorldJoint world_joint(const Motion& motion, std::size_t frame, std::size_t joint) {
  WorldJoint out{motion.position(frame, joint), motion.rotation(frame, joint)};
  for (int p = motion.skeleton.joints[joint].parent; p >= 0;
       p = motion.skeleton.joints[static_cast<std::size_t>(p)].parent) {
    const auto parent = static_cast<std::size_t>(p);
    out.position = add(motion.position(frame, parent), rotate(motion.rotation(frame, parent), out.position));
    out.rotation = multiply(motion.rotation(frame, parent), out.rotation);
  }
  return out;
}

namespace legs_detail {

/// The joint's local rotation for its rotation in the world, of parents as they are.
inline void set_world_rotation(Motion& motion, std::size_t frame, std::size_t joint, const Quat& rotation) {
  const int parent = motion.skeleton.joints[joint].parent;
  motion.rotation(frame, joint) =
      parent < 0
          ? rotation
          : normalize(multiply(inverse(world_joint(motion, frame, static_cast<std::size_t>(parent)).rotation),
                               rotation));
}

}  // namespace legs_detail

/// The share of its full length to which reach() stretches a leg.
inline constexpr double most_stretch = 0.995;

/// Bends knee and hip of one frame so that the ankle comes to `target`, or as near as the leg reaches without
/// being stretched further than it was or than most_stretch. The knee stays in the plane in which the leg is
/// bent, turned with it by the shortest way; the foot keeps its rotation in the world.
inline void reach(Motion& motion, std::size_t frame, const Leg& leg, const Vec3& target) {
  namespace detail = legs_detail;
  const WorldJoint hip = world_joint(motion, frame, leg.thigh), knee = world_joint(motion, frame, leg.knee),
                   ankle = world_joint(motion, frame, leg.ankle);
  const Vec3 thigh = subtract(knee.position, hip.position), shin = subtract(ankle.position, knee.position),
             now = subtract(ankle.position, hip.position), wish = subtract(target, hip.position);
  const double a = length(thigh), b = length(shin), wished = length(wish);
  if (a <= 0 || b <= 0 || wished <= 0) return;
  const double most = std::max(length(now), most_stretch * (a + b));
  const double distance = std::clamp(wished, std::abs(a - b) + 1e-3 * (a + b), most);
  const auto angle_at_knee = [&](double d) {
    return std::acos(std::clamp((a * a + b * b - d * d) / (2 * a * b), -1.0, 1.0));
  };
  Vec3 axis = cross(scale(thigh, -1), shin);
  if (length(axis) < 1e-6 * a * b) {  // a straight leg: the knee bends towards where the foot points
    const Vec3 toes = subtract(world_joint(motion, frame, leg.foot).position, ankle.position);
    axis = cross(toes, scale(now, -1));
  }
  const double across = length(axis), angle = angle_at_knee(distance) - angle_at_knee(length(now));
  const Quat bend = across > 0 ? quat_from_expmap(scale(axis, angle / across)) : Quat{};
  const Vec3 bent = add(thigh, rotate(bend, shin));
  const Quat turn = shortest_rotation(scale(bent, 1 / length(bent)), scale(wish, 1 / wished), {});
  detail::set_world_rotation(motion, frame, leg.thigh, multiply(turn, hip.rotation));
  detail::set_world_rotation(motion, frame, leg.knee, multiply(turn, multiply(bend, knee.rotation)));
  detail::set_world_rotation(motion, frame, leg.ankle, ankle.rotation);
}

}  // namespace motiongan::motion
