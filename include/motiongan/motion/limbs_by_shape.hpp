// The limbs of a skeleton whose joint names say nothing, by its rest pose.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The limb parts of a side, in the order of BodyPart from left_collar or right_collar on.
enum class Limb : std::uint8_t { collar, arm, forearm, hand, thigh, shin, foot, toe };
/// The number of limb parts of a side.
inline constexpr std::size_t limb_count = 8;

/// The joints of one side's limbs, [limb_count].
using LimbJoints = std::array<std::optional<std::size_t>, limb_count>;

/// The limbs and the head of a body, as far as they were found.
struct ShapedLimbs {
  LimbJoints left, right;
  std::optional<std::size_t> head;
};

namespace shape_detail {

/// What is asked of a skeleton at rest.
class Shape {
 public:
  explicit Shape(const Skeleton& skeleton)
      : skeleton_(skeleton), at_(rest_positions(skeleton)), below_(children(skeleton)) {}

  const Vec3& at(std::size_t joint) const { return at_[joint]; }
  /// The end of the bone that begins at a joint without children.
  Vec3 tip(std::size_t joint) const {
    return add(at_[joint], skeleton_.joints[joint].end_site.value_or(Vec3{}));
  }
  const std::vector<std::size_t>& below(std::size_t joint) const { return below_[joint]; }
  std::size_t size() const { return at_.size(); }

  /// The joints from below `above` to `end`, from the top; empty if it does not hang on `above`.
  std::vector<std::size_t> chain(std::size_t above, std::size_t end) const {
    std::vector<std::size_t> out;
    for (int j = static_cast<int>(end); j >= 0; j = skeleton_.joints[static_cast<std::size_t>(j)].parent) {
      if (static_cast<std::size_t>(j) == above) return {out.rbegin(), out.rend()};
      out.push_back(static_cast<std::size_t>(j));
    }
    return {};
  }

  /// The joints without children at or below `top`, but for those at or below one of `without`.
  std::vector<std::size_t> ends(std::size_t top, const std::vector<std::size_t>& without = {}) const {
    std::vector<std::size_t> out, open{top};
    while (!open.empty()) {
      const std::size_t j = open.back();
      open.pop_back();
      if (std::find(without.begin(), without.end(), j) != without.end()) continue;
      if (below_[j].empty()) out.push_back(j);
      open.insert(open.end(), below_[j].begin(), below_[j].end());
    }
    return out;
  }

  /// The place in a chain at which two long bones begin that lead on from each other, such as thigh and shin;
  /// nothing if it has no two bones. A collar bone may be as long as a forearm, so that of pairs of about the
  /// same length the last one counts.
  std::optional<std::size_t> long_bones(const std::vector<std::size_t>& chain) const {
    std::vector<double> shorter;
    double most = 0;
    for (std::size_t i = 0; i + 2 < chain.size(); ++i) {
      shorter.push_back(std::min(length(subtract(at_[chain[i + 1]], at_[chain[i]])),
                                 length(subtract(at_[chain[i + 2]], at_[chain[i + 1]]))));
      most = std::max(most, shorter.back());
    }
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < shorter.size(); ++i)
      if (shorter[i] > 0.7 * most) best = i;
    return best;
  }

 private:
  const Skeleton& skeleton_;
  std::vector<Vec3> at_;
  std::vector<std::vector<std::size_t>> below_;
};

/// A leg or an arm: two long bones, the joint before them and those after them.
struct LongLimb {
  std::optional<std::size_t> before, upper, lower, end, after;
};

inline LongLimb limb_along(const Shape& shape, const std::vector<std::size_t>& chain) {
  LongLimb out;
  const std::optional<std::size_t> first = shape.long_bones(chain);
  if (!first) return out;
  if (*first > 0) out.before = chain[*first - 1];
  out.upper = chain[*first], out.lower = chain[*first + 1], out.end = chain[*first + 2];
  if (*first + 3 < chain.size()) out.after = chain[*first + 3];
  return out;
}

/// The joint at which the body divides into two legs, and the lowest end of each.
struct Legs {
  std::size_t hips = 0;
  std::array<std::size_t, 2> tops{}, ends{};
};

/// Legs reach down to the lowest tenth of the body and begin in its middle. The joint furthest from the root
/// that has two such is the hips.
inline std::optional<Legs> find_legs(const Shape& shape) {
  double low = shape.at(0)[1], high = low;
  for (std::size_t j = 0; j < shape.size(); ++j)
    low = std::min(low, shape.at(j)[1]), high = std::max(high, shape.at(j)[1]);
  const double height = high - low;
  std::optional<Legs> out;
  for (std::size_t j = 0; j < shape.size(); ++j) {
    if (shape.at(j)[1] < low + 0.25 * height) continue;
    std::vector<std::pair<std::size_t, std::size_t>> legs;  // top and end
    for (const std::size_t top : shape.below(j)) {
      const std::vector<std::size_t> ends = shape.ends(top);
      const std::size_t end = *std::min_element(
          ends.begin(), ends.end(), [&](auto a, auto b) { return shape.at(a)[1] < shape.at(b)[1]; });
      if (shape.at(end)[1] < low + 0.1 * height && shape.at(top)[1] > low + 0.25 * height)
        legs.emplace_back(top, end);
    }
    if (legs.size() == 2) out = Legs{j, {legs[0].first, legs[1].first}, {legs[0].second, legs[1].second}};
  }
  return out;
}

}  // namespace shape_detail

/// Finds the limbs of a body that stands at rest, y up, with its arms stretched out or down. Legs are the two
/// chains that reach the floor, arms the two that reach furthest to the sides; the head is at the end of the
/// chain that reaches highest; feet point forward, which tells left from right. Nothing if the skeleton is
/// not like that.
inline std::optional<ShapedLimbs> limbs_by_shape(const Skeleton& skeleton) {
  namespace detail = shape_detail;
  if (skeleton.size() == 0) return std::nullopt;
  const detail::Shape shape(skeleton);
  const std::optional<detail::Legs> legs = detail::find_legs(shape);
  if (!legs) return std::nullopt;
  std::array<detail::LongLimb, 2> leg;
  Vec3 forward{};
  for (std::size_t s : {0u, 1u}) {
    leg[s] = detail::limb_along(shape, shape.chain(legs->hips, legs->ends[s]));
    if (!leg[s].end) return std::nullopt;
    forward = add(forward, subtract(shape.tip(legs->ends[s]), shape.at(*leg[s].end)));
  }
  const Vec3 left{forward[2], 0, -forward[0]};  // up x forward
  const auto leftward = [&](std::size_t j) { return dot(left, subtract(shape.at(j), shape.at(legs->hips))); };
  if (length(left) == 0 || leftward(*leg[0].upper) * leftward(*leg[1].upper) >= 0) return std::nullopt;
  if (leftward(*leg[0].upper) < 0) std::swap(leg[0], leg[1]);

  // The arms' ends are those furthest to both sides of what is above the hips or beside them.
  std::vector<std::size_t> ends = shape.ends(0, {legs->tops.begin(), legs->tops.end()});
  std::sort(ends.begin(), ends.end(), [&](auto a, auto b) { return leftward(a) > leftward(b); });
  if (ends.size() < 2) return std::nullopt;
  const std::array<std::size_t, 2> tips{ends.front(), ends.back()};
  std::size_t chest = 0;
  for (std::size_t j = 0; j < shape.size(); ++j)
    if (!shape.chain(j, tips[0]).empty() && !shape.chain(j, tips[1]).empty()) chest = j;
  std::array<detail::LongLimb, 2> arm;
  for (std::size_t s : {0u, 1u}) {
    arm[s] = detail::limb_along(shape, shape.chain(chest, tips[s]));
    if (!arm[s].end || leftward(tips[s]) * (s == 0 ? 1 : -1) <= 0) return std::nullopt;
  }
  ShapedLimbs out;
  for (std::size_t s : {0u, 1u})
    (s == 0 ? out.left : out.right) = LimbJoints{arm[s].before, arm[s].upper, arm[s].lower, arm[s].end,
                                                 leg[s].upper,  leg[s].lower, leg[s].end,   leg[s].after};
  // The highest end that hangs on the chest and on no arm.
  std::vector<std::size_t> tops{shape.chain(chest, tips[0]).front(), shape.chain(chest, tips[1]).front()};
  std::optional<std::size_t> crown;
  for (const std::size_t end : shape.ends(chest, tops))
    if (end != chest && (!crown || shape.at(end)[1] > shape.at(*crown)[1])) crown = end;
  if (crown && shape.at(*crown)[1] > shape.at(*arm[0].upper)[1]) {
    const std::vector<std::size_t> neck = shape.chain(chest, *crown);
    // What a head ends with, or an eye beside another, is not the head.
    const bool beyond = neck.size() > 1 && (shape.below(neck[neck.size() - 2]).size() > 1 ||
                                            (neck.size() > 2 && !skeleton.joints[*crown].end_site));
    out.head = neck[neck.size() - (beyond ? 2 : 1)];
  }
  return out;
}

}  // namespace motiongan::motion
