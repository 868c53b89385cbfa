// The size of a body, and which way is up in a file: everything in the library takes y to be up.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/core/fields.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/position_clip.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The world axis that points up.
enum class UpAxis { y, z };
constexpr NameTable<UpAxis, 2> enum_names(UpAxis) { return {{{UpAxis::y, "y"}, {UpAxis::z, "z"}}}; }

namespace body_detail {

/// From the middle of the feet to the head; nothing if the skeleton has no such names, or no length.
inline std::optional<Vec3> feet_to_head(const Skeleton& skeleton, const std::vector<std::size_t>& feet,
                                        int head, const Vec3* positions) {
  if (feet.size() != 2 || head < 0) return std::nullopt;
  const Vec3 middle = scale(add(positions[feet[0]], positions[feet[1]]), 0.5);
  const Vec3 out = subtract(positions[static_cast<std::size_t>(head)], middle);
  double size = 0;
  for (const Joint& joint : skeleton.joints) size += length(joint.offset);
  if (length(out) <= 1e-6 * size || length(out) <= 0) return std::nullopt;
  return out;
}

inline bool points_along(const Vec3& direction, std::size_t axis, double share) {
  return direction[axis] > share * length(direction);
}

/// Mean unit vector from the feet to the head over about 16 frames; positions_of(frame) gives [joints].
template <class Positions>
Vec3 mean_stance(const Skeleton& skeleton, std::size_t frames, const Positions& positions_of) {
  const std::vector<std::size_t> feet = feet_detail::feet_by_name(skeleton);
  const int head = find_head(skeleton);
  Vec3 sum{};
  std::size_t count = 0;
  if (feet.size() != 2 || head < 0) return sum;
  for (std::size_t f = 0; f < frames; f += 1 + frames / 16)
    if (const auto body = feet_to_head(skeleton, feet, head, positions_of(f))) {
      sum = add(sum, scale(*body, 1 / length(*body)));
      ++count;
    }
  return count > 0 ? scale(sum, 1 / static_cast<double>(count)) : sum;
}

/// Whether the root travels over the ground that a body standing along z would walk on: further than a leg
/// along y, with little change along z. root_at(frame) gives its position.
template <class Root>
bool walks_under_z(const Skeleton& skeleton, std::size_t frames, const Root& root_at) {
  Vec3 low = root_at(0), high = low;
  for (std::size_t f = 1; f < frames; ++f)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], root_at(f)[a]);
      high[a] = std::max(high[a], root_at(f)[a]);
    }
  const double leg = leg_length(skeleton);
  return leg > 0 && high[1] - low[1] > leg && high[2] - low[2] < 0.3 * leg;
}

}  // namespace body_detail

/// The axis along which the body stands at rest, from its feet to its head; nothing if joint names do not
/// tell feet and head, or the rest pose stands along neither y nor z.
inline std::optional<UpAxis> rest_up_axis(const Skeleton& skeleton) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  const auto body = body_detail::feet_to_head(skeleton, feet_detail::feet_by_name(skeleton),
                                              find_head(skeleton), rest.data());
  if (body && body_detail::points_along(*body, 1, 0.8)) return UpAxis::y;
  if (body && body_detail::points_along(*body, 2, 0.8)) return UpAxis::z;
  return std::nullopt;
}

/// Which axis is up in the motion's world, where that is sure; `root` is its moving root. y: on average the
/// body stands along y. z: on average it stands along z, and either its rest pose does too or it walks over
/// the xy plane. Nothing for bodies that lie or crawl, and without joints named like feet and head.
inline std::optional<UpAxis> detect_up_axis(const Motion& motion, std::size_t root) {
  if (motion.frames == 0) return std::nullopt;
  const std::size_t joints = motion.skeleton.size();
  std::vector<Vec3> p(joints);
  std::vector<Quat> q(joints);
  const Vec3 stance = body_detail::mean_stance(motion.skeleton, motion.frames, [&](std::size_t f) {
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = motion.skeleton.joints[j].parent;
      const auto up = static_cast<std::size_t>(std::max(parent, 0));
      p[j] = parent < 0 ? motion.position(f, j) : add(p[up], rotate(q[up], motion.position(f, j)));
      q[j] = parent < 0 ? motion.rotation(f, j) : multiply(q[up], motion.rotation(f, j));
    }
    return p.data();
  });
  if (stance[1] > 0.7) return UpAxis::y;
  if (stance[2] <= 0.7) return std::nullopt;
  const bool walks = body_detail::walks_under_z(motion.skeleton, motion.frames,
                                                [&](std::size_t f) { return motion.position(f, root); });
  if (walks || rest_up_axis(motion.skeleton) == UpAxis::z) return UpAxis::z;
  return std::nullopt;
}

/// The same for joint positions [frames, joints], which have no rest pose.
inline std::optional<UpAxis> detect_up_axis(const Skeleton& skeleton, std::span<const Vec3> positions) {
  const std::size_t joints = skeleton.size(), frames = joints == 0 ? 0 : positions.size() / joints;
  if (frames == 0) return std::nullopt;
  const Vec3 stance =
      body_detail::mean_stance(skeleton, frames, [&](std::size_t f) { return &positions[f * joints]; });
  if (stance[1] > 0.7) return UpAxis::y;
  const bool walks = stance[2] > 0.7 && body_detail::walks_under_z(skeleton, frames, [&](std::size_t f) {
                       return positions[f * joints];
                     });
  return walks ? std::optional(UpAxis::z) : std::nullopt;
}

/// The motion of a z-up world in a y-up world: x stays, z becomes y, y becomes -z. If the rest pose stands
/// along z, the whole skeleton is turned (offsets, local rotations and the axes of channels), so that it then
/// stands along y; if it stands along y (as SMPL bodies in z-up worlds do), only the first joint is. Exact:
/// values are permuted and negated.
inline Motion from_z_up(Motion motion) {
  const auto turn = [](const Vec3& v) { return Vec3{v[0], v[2], -v[1]}; };
  if (rest_up_axis(motion.skeleton) == UpAxis::y) {
    const Quat quarter = axis_rotation(0, -pi / 2);
    for (std::size_t f = 0; f < motion.frames; ++f) {
      motion.position(f, 0) = turn(motion.position(f, 0));
      motion.rotation(f, 0) = multiply(quarter, motion.rotation(f, 0));
    }
    motion.skeleton.joints.front().offset = turn(motion.skeleton.joints.front().offset);
    return motion;
  }
  const auto turned = [](Channel c) {
    constexpr std::array<Channel, 6> to{Channel::x_position, Channel::z_position, Channel::y_position,
                                        Channel::x_rotation, Channel::z_rotation, Channel::y_rotation};
    return to[static_cast<std::size_t>(c)];
  };
  for (Joint& joint : motion.skeleton.joints) {
    joint.offset = turn(joint.offset);
    if (joint.end_site) joint.end_site = turn(*joint.end_site);
    for (Channel& c : joint.channels) c = turned(c);
  }
  for (Vec3& p : motion.positions) p = turn(p);
  for (Quat& q : motion.rotations) q = {q.w, q.x, q.z, -q.y};
  return motion;
}

/// The skeleton with all lengths multiplied by `factor`.
inline Skeleton scaled(Skeleton skeleton, double factor) {
  if (factor == 1) return skeleton;
  for (Joint& joint : skeleton.joints) {
    joint.offset = scale(joint.offset, factor);
    if (joint.end_site) joint.end_site = scale(*joint.end_site, factor);
  }
  return skeleton;
}

/// The motion with all lengths multiplied by `factor`.
inline Motion scaled(Motion motion, double factor) {
  if (factor == 1) return motion;
  motion.skeleton = scaled(std::move(motion.skeleton), factor);
  for (Vec3& p : motion.positions) p = scale(p, factor);
  return motion;
}

/// The clip with all lengths multiplied by `factor`.
inline PositionClip scaled(PositionClip clip, double factor) {
  if (factor == 1) return clip;
  clip.skeleton = scaled(std::move(clip.skeleton), factor);
  for (Vec3& p : clip.positions) p = scale(p, factor);
  return clip;
}

/// Height of the body, without the joints above its hips, in the file's unit: from the lowest to the highest
/// point of the rest pose along the axis it stands on. If it does not stand, or joint names do not tell how:
/// the longest extent of the rest pose, which for arms stretched sideways is about the height too. 0 if no
/// bone has a length.
inline double body_height(const Skeleton& skeleton) {
  const std::vector<Vec3> rest = rest_positions(skeleton);
  // The lowest joint above both feet; without feet, the whole skeleton counts.
  const std::vector<std::size_t> feet = feet_detail::feet_by_name(skeleton);
  const std::vector<std::size_t> feet_below = feet_detail::count_below(skeleton, feet);
  std::size_t hips = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j)
    if (feet_below[j] == 2) hips = j;
  std::vector<char> in_body(skeleton.size(), 0);
  std::vector<Vec3> points;
  for (std::size_t j = hips; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    in_body[j] = j == hips || (joint.parent >= 0 && in_body[static_cast<std::size_t>(joint.parent)] != 0);
    if (in_body[j] == 0) continue;
    points.push_back(rest[j]);
    if (joint.end_site) points.push_back(add(rest[j], *joint.end_site));
  }
  if (points.empty()) return 0;
  const std::optional<UpAxis> up = rest_up_axis(skeleton);
  double height = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (up && a != (*up == UpAxis::y ? 1U : 2U)) continue;
    const auto [low, high] =
        std::minmax_element(points.begin(), points.end(),
                            [a](const Vec3& left, const Vec3& right) { return left[a] < right[a]; });
    height = std::max(height, (*high)[a] - (*low)[a]);
  }
  return height;
}

/// The metres of a unit in which a body of this height (in units) would be a grown person: 1, 0.01 or 0.001.
/// 0 if none is plausible.
inline double likely_unit_metres(double height) {
  for (const double unit : {1.0, 0.01, 0.001})
    if (height * unit >= 1.2 && height * unit <= 2.3) return unit;
  return 0;
}

/// Unit and up axis of the clips that a model was trained on. Its own motion has that unit, and y up.
struct ClipSpace {
  double unit_metres = 0;       ///< metres per unit; 0: unknown
  UpAxis clips_up = UpAxis::y;  ///< of the files; they were turned to y
};

/// The space of a motion in words: "y up, in metres", "y up, 1 unit = 0.056 m", "y up, in the clips' unit".
inline std::string describe(const ClipSpace& space) {
  const double unit = space.unit_metres;
  std::string text = "y up, ";
  if (unit <= 0)
    text += "in the clips' unit";
  else if (unit == 1)
    text += "in metres";
  else if (unit == 0.01)
    text += "in centimetres";
  else
    text += concat("1 unit = ", unit, " m");
  return space.clips_up == UpAxis::y ? text : text + " (the clips had z up)";
}

/// The factor that scales a body's lengths to those of a model's: the ratio of leg lengths or, without joints
/// named like feet, of heights. 1 if the sizes differ by less than half, as those of people do, or if either
/// is unknown.
inline double scale_to(const Skeleton& model, const Skeleton& body) {
  double wanted = leg_length(model), found = leg_length(body);
  if (wanted <= 0 || found <= 0) wanted = body_height(model), found = body_height(body);
  if (wanted <= 0 || found <= 0) return 1;
  const double ratio = wanted / found;
  return ratio < 1 / 1.5 || ratio > 1.5 ? ratio : 1;
}

}  // namespace motiongan::motion
