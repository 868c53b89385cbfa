// The last correction of a directed motion: what is a little off is put right by smooth offsets.
#pragma once
#include <algorithm>
#include <cmath>
#include <map>
#include <variant>
#include <vector>

#include "motiongan/direct/errors.hpp"
#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/legs.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/rotation_fit.hpp"

namespace motiongan {

namespace detail {

/// Offsets at some frames, and between and around them smoothly to each other and to nothing.
class SmoothOffsets {
 public:
  void set(std::size_t frame, const motion::Vec3& value) { knots_[frame] = value; }
  bool empty() const { return knots_.empty(); }

  /// The offset at a frame. An offset reaches `reach` frames; between two that are nearer than twice that,
  /// one changes into the other.
  motion::Vec3 at(std::size_t frame, double reach) const {
    const auto next = knots_.lower_bound(frame);
    if (next != knots_.end() && next->first == frame) return next->second;
    const auto fading = [&](const auto& knot) {
      const double far = std::abs(static_cast<double>(frame) - static_cast<double>(knot.first));
      return motion::scale(knot.second, 1 - motion::clean_detail::ease(std::min(far / reach, 1.0)));
    };
    motion::Vec3 out{};
    if (next == knots_.begin()) return next == knots_.end() ? out : fading(*next);
    const auto& before = *std::prev(next);
    if (next == knots_.end()) return fading(before);
    const double gap = static_cast<double>(next->first - before.first);
    if (gap >= 2 * reach) return motion::add(fading(before), fading(*next));
    const double t = motion::clean_detail::ease(static_cast<double>(frame - before.first) / gap);
    return motion::add(motion::scale(before.second, 1 - t), motion::scale(next->second, t));
  }

 private:
  std::map<std::size_t, motion::Vec3> knots_;
};

/// Corrects one motion: first where it is, then its poses, then single joints.
class ExactPass {
 public:
  ExactPass(motion::Motion motion, std::size_t root, double seconds, double reach)
      : motion_(std::move(motion)), root_(root), reach_(reach * motion_.rate), seconds_(seconds) {}

  motion::Motion run(const std::vector<Constraint>& constraints) {
    for (const Constraint& c : constraints)
      if (const auto* path = std::get_if<PathConstraint>(&c)) walk(*path);
    for (const Constraint& c : constraints)
      if (const auto* pose = std::get_if<PoseConstraint>(&c); pose != nullptr && pose->placed) place(*pose);
    move_root();
    turns_.assign(motion_.skeleton.size(), {});
    for (const Constraint& c : constraints) {
      if (const auto* pose = std::get_if<PoseConstraint>(&c)) take_pose(*pose);
      if (const auto* loop = std::get_if<LoopConstraint>(&c)) close(*loop);
    }
    for (const Constraint& c : constraints)
      if (const auto* joint = std::get_if<JointConstraint>(&c); joint != nullptr && joint->rotation)
        for (const std::size_t f : frames(joint->from, joint->to)) turn_to(f, joint->joint, *joint->rotation);
    apply_turns();
    for (const Constraint& c : constraints) {
      if (const auto* pose = std::get_if<PoseConstraint>(&c)) reach_some(*pose);
      if (const auto* joint = std::get_if<JointConstraint>(&c); joint != nullptr && joint->position)
        for (const std::size_t f : frames(joint->from, joint->to)) reach(f, joint->joint, *joint->position);
      if (const auto* contact = std::get_if<ContactConstraint>(&c)) stand(*contact);
    }
    apply_turns();
    move_root();
    return std::move(motion_);
  }

 private:
  std::vector<std::size_t> frames(double from, double to) const {
    std::vector<std::size_t> out;
    for (std::size_t f = frame_at(from, motion_.rate); f <= frame_at(to, motion_.rate); ++f)
      if (f < motion_.frames) out.push_back(f);
    return out;
  }

  WorldPose pose_of(std::size_t f) const { return world_pose(motion_, f, root_); }

  /// Where the root passes nearest to a point, or at its time, it goes through it.
  void walk(const PathConstraint& c) {
    const TimedPath path(c.points, seconds_);
    std::vector<WorldPose> poses;
    for (std::size_t f = 0; f < motion_.frames; ++f) poses.push_back(pose_of(f));
    std::size_t from = 0;  // points are passed one after the other
    for (std::size_t i = 0; i < path.points().size(); ++i) {
      const PathPoint& p = path.points()[i];
      std::size_t at = std::min(frame_at(*p.time, motion_.rate), motion_.frames - 1);
      if (!path.timed() && i > 0 && i + 1 < path.points().size()) {
        const auto far = [&](std::size_t f) { return std::hypot(poses[f].x - p.x, poses[f].z - p.z); };
        const std::size_t last = std::min(at + static_cast<std::size_t>(reach_), motion_.frames - 1);
        std::size_t nearest = std::max(from, at - std::min(at, static_cast<std::size_t>(reach_)));
        for (std::size_t f = nearest; f <= last; ++f)
          if (far(f) < far(nearest)) nearest = f;
        at = nearest;
      }
      from = at;
      moves_.set(at, {p.x - poses[at].x, 0, p.z - poses[at].z});
      if (p.yaw) yaws_.set(at, {0, std::remainder(*p.yaw - poses[at].yaw, 2 * motion::pi), 0});
    }
  }

  void place(const PoseConstraint& c) {
    for (std::size_t i = 0; i < c.pose.frames; ++i) {
      const std::size_t f = frame_at(c.time, motion_.rate) + i;
      if (f >= motion_.frames) break;
      const WorldPose is = pose_of(f), wish = world_pose(c.pose, i, root_);
      moves_.set(f, {wish.x - is.x, 0, wish.z - is.z});
      yaws_.set(f, {0, std::remainder(wish.yaw - is.yaw, 2 * motion::pi), 0});
    }
  }

  /// Applies moves_ and yaws_.
  void move_root() {
    const int parent = motion_.skeleton.joints[root_].parent;
    for (std::size_t f = 0; f < motion_.frames; ++f) {
      if (!moves_.empty()) motion::shift(motion_, f, root_, moves_.at(f, reach_));
      if (yaws_.empty()) continue;
      const motion::Quat above =
          parent < 0 ? motion::Quat{}
                     : motion::world_joint(motion_, f, static_cast<std::size_t>(parent)).rotation;
      const motion::Quat turn = motion::axis_rotation(1, yaws_.at(f, reach_)[1]);
      motion_.rotation(f, root_) =
          multiply(multiply(multiply(inverse(above), turn), above), motion_.rotation(f, root_));
    }
    moves_ = {}, yaws_ = {};
  }

  void turn_to(std::size_t f, std::size_t joint, const motion::Quat& wish) {
    turns_[joint].set(f, motion::expmap_from_quat(multiply(inverse(motion_.rotation(f, joint)), wish)));
  }

  /// All joints of a pose turn to it; only its root keeps its heading unless it is placed.
  void take_pose(const PoseConstraint& c) {
    if (!c.joints.empty()) return;  // single joints are reached for afterwards
    for (std::size_t i = 0; i < c.pose.frames; ++i)
      if (const std::size_t f = frame_at(c.time, motion_.rate) + i; f < motion_.frames) match(f, c.pose, i);
  }

  void match(std::size_t f, const motion::Motion& pose, std::size_t i) {
    for (std::size_t j = 0; j < motion_.skeleton.size(); ++j) {
      motion::Quat wish = pose.rotation(i, j);
      if (j == root_) {
        motion::Vec3 facing = motion::heading_from_quat(wish);
        facing[1] = motion::heading_from_quat(motion_.rotation(f, j))[1];
        wish = motion::quat_from_heading(facing);
      }
      turn_to(f, j, wish);
    }
    moves_.set(f, {0, pose.position(i, root_)[1] - motion_.position(f, root_)[1], 0});
  }

  void close(const LoopConstraint& c) {
    const std::size_t last = frame_at(c.seconds > 0 ? c.seconds : seconds_, motion_.rate);
    if (last == 0 || last >= motion_.frames) return;
    const motion::Motion first = slice(motion_, 0, 1);
    match(last, first, 0);
    if (static_cast<double>(last) < reach_) match(0, first, 0);
  }

  void apply_turns() {
    for (std::size_t j = 0; j < turns_.size(); ++j)
      for (std::size_t f = 0; !turns_[j].empty() && f < motion_.frames; ++f)
        motion_.rotation(f, j) = motion::normalize(
            multiply(motion_.rotation(f, j), motion::quat_from_expmap(turns_[j].at(f, reach_))));
    turns_.assign(motion_.skeleton.size(), {});
    move_root();
  }

  void reach_some(const PoseConstraint& c) {
    for (std::size_t i = 0; i < c.pose.frames; ++i) {
      const std::size_t f = frame_at(c.time, motion_.rate) + i;
      if (f >= motion_.frames) break;
      WorldPose wish = world_pose(c.pose, i, root_);
      if (!c.placed) {
        const WorldPose own = pose_of(f);
        wish.x = own.x, wish.z = own.z, wish.yaw = own.yaw;
      }
      for (const std::size_t j : c.joints) reach(f, j, wish.joint(j));
    }
  }

  void stand(const ContactConstraint& c) {
    const std::vector<std::size_t> all = frames(c.from, c.to);
    motion::Vec3 mean{};
    for (const std::size_t f : all)
      mean = motion::add(mean, motion::scale(pose_of(f).joint(c.joint), 1 / static_cast<double>(all.size())));
    for (const std::size_t f : all) reach(f, c.joint, mean);
  }

  /// Turns the three joints above `joint`, those near it most, until it is at a point (cyclic coordinate
  /// descent); if that is out of reach, the body moves by what is left.
  void reach(std::size_t f, std::size_t joint, const motion::Vec3& wish) {
    motion::Motion frame = slice(motion_, f, 1);
    const auto place = [&](std::size_t j) { return motion::world_joint(frame, 0, j).position; };
    const double near = 1e-7 * motion::body_unit(motion_.skeleton);
    const std::vector<std::size_t> chain = chain_of(joint);
    for (int sweep = 0; sweep < 100 && motion::length(motion::subtract(place(joint), wish)) > near; ++sweep)
      for (double share = 1; const std::size_t j : chain) {
        const motion::WorldJoint at = motion::world_joint(frame, 0, j);
        const motion::Vec3 is = motion::subtract(place(joint), at.position),
                           to = motion::subtract(wish, at.position);
        if (motion::length(is) <= 0 || motion::length(to) <= 0) continue;
        const motion::Quat turn =
            motion::slerp({},
                          motion::shortest_rotation(motion::scale(is, 1 / motion::length(is)),
                                                    motion::scale(to, 1 / motion::length(to)), {}),
                          share);
        frame.rotation(0, j) = motion::normalize(
            multiply(frame.rotation(0, j), multiply(multiply(inverse(at.rotation), turn), at.rotation)));
        share *= 0.6;
      }
    for (const std::size_t j : chain) turn_to(f, j, frame.rotation(0, j));
    const motion::Vec3 left = motion::subtract(wish, place(joint));
    if (motion::length(left) > near) moves_.set(f, left);
  }

  /// The joints above `joint` that reach for it: three at most, not the root.
  std::vector<std::size_t> chain_of(std::size_t joint) const {
    std::vector<std::size_t> out;
    for (int j = motion_.skeleton.joints[joint].parent;
         j >= 0 && static_cast<std::size_t>(j) != root_ && out.size() < 3;
         j = motion_.skeleton.joints[static_cast<std::size_t>(j)].parent)
      out.push_back(static_cast<std::size_t>(j));
    return out;
  }

  motion::Motion motion_;
  std::size_t root_;
  double reach_, seconds_;
  SmoothOffsets moves_, yaws_;
  std::vector<SmoothOffsets> turns_;  // per joint, from its rotation as it is
};

}  // namespace detail

/// The motion with its constraints met exactly: the root goes through the points of a path, poses and
/// rotations are taken over, joints are reached for by turning those above them, a loop closes. What changes
/// a frame fades over 0.4 s. Constraints that contradict each other cannot all be met: measure again with
/// constraint_errors(). A large correction shows; it is meant for what optimisation leaves. Throws Error as
/// constraint_errors() does.
inline motion::Motion meet_exactly(motion::Motion motion, std::size_t root,
                                   const std::vector<Constraint>& constraints, double reach = 0.4) {
  require(motion.frames > 0, "a motion without frames meets no constraint");
  const double seconds = static_cast<double>(motion.frames - 1) / motion.rate;
  return detail::ExactPass(std::move(motion), root, seconds, reach).run(constraints);
}

}  // namespace motiongan
