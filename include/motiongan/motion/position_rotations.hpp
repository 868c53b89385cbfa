// Joint rotations from joint positions, so that positions can be written as BVH.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/position_clip.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/rotation_fit.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// The skeleton with channels for any rotation of its joints and any position of its root. A skeleton without
/// channels (from a bone list) gets Z X Y rotations everywhere and root positions. Existing channels are
/// kept, except that a joint with children and fewer than three rotations gets all three, and a root with
/// fewer than three positions gets all three.
inline Skeleton with_bvh_channels(Skeleton skeleton) {
  const bool none = skeleton.channel_count() == 0;
  const auto below = children(skeleton);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    std::vector<Channel>& channels = skeleton.joints[j].channels;
    const auto turns = std::count_if(channels.begin(), channels.end(), is_rotation);
    if (turns < 3 && (none || !below[j].empty())) {
      std::erase_if(channels, is_rotation);
      channels.insert(channels.end(), {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation});
    }
    const auto places = static_cast<std::ptrdiff_t>(channels.size()) -
                        std::count_if(channels.begin(), channels.end(), is_rotation);
    if (j == 0 && places < 3) {
      std::erase_if(channels, [](Channel c) { return !is_rotation(c); });
      channels.insert(channels.begin(), {Channel::x_position, Channel::y_position, Channel::z_position});
    }
  }
  return skeleton;
}

/// Joint indices in BVH order, depth first: each joint's whole branch before the next one.
inline std::vector<std::size_t> depth_first_order(const Skeleton& skeleton) {
  const auto below = children(skeleton);
  std::vector<std::size_t> order, open;
  if (skeleton.size() > 0) open.push_back(0);
  while (!open.empty()) {
    order.push_back(open.back());
    open.pop_back();
    const auto& next = below[order.back()];
    open.insert(open.end(), next.rbegin(), next.rend());
  }
  return order;
}

/// The clip with its joints in depth_first_order. A clip already in that order, such as any from a BVH file,
/// is returned unchanged.
inline PositionClip depth_first(const PositionClip& clip) {
  const std::size_t joints = clip.skeleton.size();
  const std::vector<std::size_t> order = depth_first_order(clip.skeleton);
  if (std::is_sorted(order.begin(), order.end())) return clip;
  PositionClip out = clip;
  std::vector<int> place(joints, 0);
  for (std::size_t n = 0; n < joints; ++n) place[order[n]] = static_cast<int>(n);
  for (std::size_t n = 0; n < joints; ++n) {
    Joint& joint = out.skeleton.joints[n] = clip.skeleton.joints[order[n]];
    if (joint.parent >= 0) joint.parent = place[static_cast<std::size_t>(joint.parent)];
    for (std::size_t f = 0; f < clip.frames; ++f)
      out.positions[f * joints + n] = clip.positions[f * joints + order[n]];
  }
  return out;
}

namespace position_rotations_detail {

/// A bone whose observed direction determines a joint's rotation.
struct Bone {
  std::size_t from = 0, to = 0;  ///< joints; `from` coincides with the rotating joint
  Vec3 direction{};              ///< at rest, unit length
  double weight = 0;             ///< its length
};

/// The bones that a joint rotates. `own` end at its children. `far` end at children of joints that coincide
/// with it (zero offset), so those joints may rotate them too.
struct TurnedBones {
  std::vector<Bone> own, far;
  bool on_a_line = true;  ///< all `own` bones are collinear: the twist is undetermined
};

/// Which joints are positioned directly rather than by a bone, [joints]: the root, and joints with position
/// channels on the unbranched chain below it.
inline std::vector<char> placed_joints(const Skeleton& skeleton) {
  const auto below = children(skeleton);
  std::vector<char> out(skeleton.size(), 0);
  for (std::size_t j = 0;; j = below[j].front()) {
    const std::vector<Channel>& channels = skeleton.joints[j].channels;
    out[j] = j == 0 || channels.size() >= 3 + static_cast<std::size_t>(std::count_if(
                                                  channels.begin(), channels.end(), is_rotation));
    if (below[j].size() != 1) return out;
  }
}

inline std::vector<TurnedBones> turned_bones(const Skeleton& skeleton, const std::vector<char>& placed) {
  const std::vector<double> lengths = bone_lengths(skeleton);
  double sum = 0;
  for (const double l : lengths) sum += l;
  std::vector<TurnedBones> out(skeleton.size());
  // Backwards, children come before their parents: a joint is complete before its parent uses it.
  for (std::size_t j = skeleton.size(); j-- > 1;) {
    const Joint& joint = skeleton.joints[j];
    const auto parent = static_cast<std::size_t>(joint.parent);
    TurnedBones& bones = out[parent];
    if (placed[j]) continue;
    if (lengths[j] > 1e-9 * sum) {
      bones.own.push_back({parent, j, scale(joint.offset, 1 / lengths[j]), lengths[j]});
      bones.on_a_line =
          bones.on_a_line && length(cross(bones.own.front().direction, bones.own.back().direction)) < 1e-5;
    } else {
      bones.far.insert(bones.far.end(), out[j].own.begin(), out[j].own.end());
      bones.far.insert(bones.far.end(), out[j].far.begin(), out[j].far.end());
    }
  }
  return out;
}

/// Bone directions at rest and as observed in a frame of `positions` [joints], the observed ones rotated by
/// `back`. Bones of zero observed length are skipped.
inline std::vector<DirectionPair> seen_bones(const std::vector<Bone>& bones, const Vec3* positions,
                                             const Quat& back) {
  std::vector<DirectionPair> out;
  for (const Bone& b : bones) {
    const Vec3 seen = rotate(back, subtract(positions[b.to], positions[b.from]));
    const double n = length(seen);
    if (n > 1e-9 * b.weight) out.push_back({b.direction, scale(seen, 1 / n), b.weight});
  }
  return out;
}

/// `q` followed by the rotation about `axis`, the direction of collinear bones after `q`, that fits `far`
/// best; `q` itself if they do not determine it.
inline Quat twisted_for(const Quat& q, const Vec3& axis, const std::vector<DirectionPair>& far) {
  double sine = 0, cosine = 0, weights = 0;
  for (const DirectionPair& p : far) {
    const Vec3 now = rotate(q, p.rest);
    sine += p.weight * dot(axis, cross(now, p.seen));
    cosine += p.weight * (dot(now, p.seen) - dot(now, axis) * dot(axis, p.seen));
    weights += p.weight;
  }
  if (std::hypot(sine, cosine) <= 1e-5 * weights) return q;
  const double half = std::atan2(sine, cosine) / 2, s = std::sin(half);
  return normalize(multiply({std::cos(half), s * axis[0], s * axis[1], s * axis[2]}, q));
}

/// The common direction of collinear bones, unit length, at rest and as observed; empty if none is observed.
inline std::optional<DirectionPair> line_of(const std::vector<DirectionPair>& bones) {
  if (bones.empty()) return std::nullopt;
  DirectionPair out{bones.front().rest, {}, 1};
  double weights = 0;
  for (const DirectionPair& p : bones) {
    out.seen = add(out.seen, scale(p.seen, dot(p.rest, out.rest) < 0 ? -p.weight : p.weight));
    weights += p.weight;
  }
  const double n = length(out.seen);
  if (n <= 1e-9 * weights) return std::nullopt;
  out.seen = scale(out.seen, 1 / n);
  return out;
}

/// Local rotation of a joint from the observed directions of its bones in the parent's frame. The twist is
/// zero relative to `reference`; `previous` is the rotation in the previous frame.
inline Quat joint_rotation(const TurnedBones& bones, const std::vector<DirectionPair>& own,
                           const std::vector<DirectionPair>& far, const Quat& reference,
                           const Quat& previous) {
  if (own.size() > 1 && !bones.on_a_line) return best_rotation(own, previous);
  if (own.empty() && far.size() > 1) return best_rotation(far, previous);
  const std::optional<DirectionPair> line = line_of(own.empty() ? far : own);
  if (!line) return previous;
  const Quat swing =
      shortest_rotation(rotate(reference, line->rest), line->seen, multiply(previous, inverse(reference)));
  const Quat q = multiply(swing, reference);
  return own.empty() ? q : twisted_for(q, line->seen, far);
}

/// The rotation with zero twist, as motion_from_positions documents it, for a joint observed as `lines`
/// [frames].
inline Quat twist_reference(const std::vector<std::optional<DirectionPair>>& lines) {
  Vec3 sum{};
  double lowest = 1;
  for (const std::optional<DirectionPair>& line : lines) {
    if (!line) continue;
    sum = add(sum, line->seen);
    lowest = std::min(lowest, dot(line->rest, line->seen));
  }
  const double n = length(sum);
  if (lowest > -0.7 || n <= 1e-6) return {};
  for (const std::optional<DirectionPair>& line : lines)
    if (line) return shortest_rotation(line->rest, scale(sum, 1 / n), {});
  return {};
}

}  // namespace position_rotations_detail

/// The motion whose bones point in the directions given by the clip's positions. Bone lengths are exactly the
/// skeleton's, whatever the observed lengths; the root is where the clip has it. Joints are in the order of
/// depth_first(clip), with channels from with_bvh_channels, so the motion can be written as BVH.
///
/// Positions do not fully determine rotations. The rest is chosen as follows, from the root down, in the
/// frame of the already solved parent:
/// - A joint with one bone (or collinear bones) takes the shortest rotation from the bone's rest direction to
///   the observed one: its twist about the bone is zero relative to the rest pose. The shortest rotation
///   jumps near half a turn, so where the clip comes within 45 degrees of that (rest poses that nobody ever
///   takes, such as Bandai-Namco's) the twist is zero relative to the clip's mean direction instead. With
///   `reference` [joints of the clip], local rotations of a natural pose such as a frame of the seed's BVH,
///   it is zero relative to that pose; pass it also if the pieces of one motion are converted separately.
/// - A joint with two or more bones that are not collinear takes the rotation that fits all of them best,
///   weighted by length (best_rotation).
/// - A child of zero offset (CMU's LHipJoint) coincides with its parent. Its bones count for the parent if
///   the parent has no bones of its own, or only bones that leave its twist undetermined. The child then
///   takes the remaining rotation, so its bones point exactly in the observed directions.
/// - Joints without bones (hands, toes, heads) do not rotate, or keep the rotation in `reference`. If a bone
///   has no direction because both ends coincide, the joint keeps its rotation from the previous frame.
/// - Below a resting root (Bandai-Namco's joint_Root), a joint with position channels stays at its observed
///   position.
///
/// Positions computed from a motion of this skeleton are reproduced up to rounding; twists of single bones
/// are not. Throws Error if sizes do not match or a value is not finite.
inline Motion motion_from_positions(const PositionClip& clip, std::span<const Quat> reference = {}) {
  namespace detail = position_rotations_detail;
  const std::size_t joints = clip.skeleton.size();
  require(clip.positions.size() == clip.frames * joints && joints > 0, "clip '", clip.id, "' has ",
          clip.positions.size(), " positions, expected ", clip.frames, " frames x ", joints, " joints");
  require(reference.empty() || reference.size() == joints, "the reference pose has ", reference.size(),
          " rotations, expected one for each of the ", joints, " joints of clip '", clip.id, "', or none");
  for (std::size_t i = 0; i < clip.positions.size(); ++i)
    for (const double v : clip.positions[i])
      require(std::isfinite(v), "clip '", clip.id, "', frame ", i / joints, ", joint '",
              clip.skeleton.joints[i % joints].name, "': found ", v, ", expected a finite number");
  Motion out;
  out.rate = clip.rate;
  out.frames = clip.frames;
  out.skeleton = clip.skeleton;
  out.rotations.resize(clip.frames * joints);
  out.positions.resize(clip.frames * joints);
  check_motion(out);  // parents before children, a rate above 0
  const std::vector<std::size_t> order = depth_first_order(clip.skeleton);
  const PositionClip ordered = depth_first(clip);
  out.skeleton = with_bvh_channels(ordered.skeleton);

  const std::vector<char> placed = detail::placed_joints(ordered.skeleton);
  const auto bones = detail::turned_bones(out.skeleton, placed);
  std::vector<Quat> global(clip.frames * joints);  // world rotations
  std::vector<std::vector<DirectionPair>> own(clip.frames), far(clip.frames);
  std::vector<std::optional<DirectionPair>> lines(clip.frames);
  for (std::size_t j = 0; j < joints; ++j) {
    const Joint& joint = out.skeleton.joints[j];
    const auto parent = static_cast<std::size_t>(std::max(joint.parent, 0));
    const auto above = [&](std::size_t f) { return joint.parent < 0 ? Quat{} : global[f * joints + parent]; };
    for (std::size_t f = 0; f < clip.frames; ++f) {
      own[f] = detail::seen_bones(bones[j].own, &ordered.positions[f * joints], inverse(above(f)));
      far[f] = detail::seen_bones(bones[j].far, &ordered.positions[f * joints], inverse(above(f)));
      lines[f] = detail::line_of(own[f].empty() ? far[f] : own[f]);
    }
    const Quat zero = reference.empty() ? detail::twist_reference(lines) : normalize(reference[order[j]]);
    Quat previous = zero;
    for (std::size_t f = 0; f < clip.frames; ++f) {
      Quat q = detail::joint_rotation(bones[j], own[f], far[f], zero, previous);
      // q and -q are the same rotation: take the one nearer to the previous frame.
      if (dot(q, previous) < 0) q = {-q.w, -q.x, -q.y, -q.z};
      previous = q;
      global[f * joints + j] = normalize(multiply(above(f), q));
      out.rotation(f, j) = q;
      const Vec3* const seen = &ordered.positions[f * joints];
      out.position(f, j) = joint.parent < 0 ? seen[j]
                           : placed[j]      ? rotate(inverse(above(f)), subtract(seen[j], seen[parent]))
                                            : joint.offset;
    }
  }
  return out;
}

}  // namespace motiongan::motion
