// Constraints that cannot be meant: times outside of the motion, joints that do not exist, places that nobody
// gets to in time.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/direct/directed_body.hpp"
#include "motiongan/direct/path.hpp"

namespace motiongan {

/// The index of a joint by name; case does not matter. Throws Error, naming those that are most like it.
inline std::size_t find_joint(const motion::Skeleton& skeleton, const std::string& name) {
  if (const int j = skeleton.find(name); j >= 0) return static_cast<std::size_t>(j);
  const std::string wanted = motion::feet_detail::lower_case(name);
  std::vector<std::pair<std::size_t, std::string>> near;  // by the number of changed letters
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const std::string own = motion::feet_detail::lower_case(skeleton.joints[j].name);
    if (own == wanted) return j;
    near.emplace_back(motion::position_format_detail::edit_distance(wanted, own), skeleton.joints[j].name);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, near.size()); ++i)
    names += (i > 0 ? ", " : "") + near[i].second;
  throw Error("there is no joint \"", name, "\"; nearest: ", names);
}

namespace detail {

/// Checks the constraints of one motion.
class ConstraintCheck {
 public:
  ConstraintCheck(const DirectedBody& body, const motion::RootTrack& start, double seconds)
      : body_(body), start_(start), seconds_(seconds), leg_(motion::body_unit(body.skeleton)) {}

  void operator()(const PoseConstraint& c) const {
    require(c.pose.frames > 0, "the pose at ", c.time, " s has no frames");
    motion::require_same_joints(body_.skeleton, c.pose.skeleton, concat("the pose at ", c.time, " s"));
    for (const std::size_t j : c.joints) check_joint(j);
    check_time("a pose", c.time);
    if (!c.placed) return;
    const WorldPose pose = body_.read(c.pose, 0);
    check_way("the pose", pose.x, pose.z, c.time, 0);
  }

  void operator()(const JointConstraint& c) const {
    check_joint(c.joint);
    const std::string& name = body_.skeleton.joints[c.joint].name;
    check_span(name, c.from, c.to);
    require(c.position || c.rotation, name, " has neither a position nor a rotation to be met");
    require(!c.rotation || body_.rotates, "the rotation of ", name,
            " cannot be given for a model of positions; give its place, or a pose");
    require(!c.rotation || c.joint != body_.root || body_.root_turns, "the rotation of the root ", name,
            " cannot be given for a model of --root-rotation expmap; give a "
            "whole pose");
    if (!c.position) return;
    for (const double v : *c.position)
      require(std::isfinite(v), "the point of ", name, " has a number that is not finite");
    check_way(concat("the point of ", name), (*c.position)[0], (*c.position)[2], c.from, 2 * leg_);
  }

  void operator()(const PathConstraint& c) const {
    const TimedPath path(c.points, seconds_);
    for (std::size_t i = 1; i < path.points().size(); ++i) {
      const PathPoint &a = path.points()[i - 1], &b = path.points()[i];
      const double way = std::hypot(b.x - a.x, b.z - a.z), took = *b.time - *a.time;
      check_speed(concat("from point ", i, " to point ", i + 1, " of the path"), way, took);
    }
  }

  void operator()(const LoopConstraint& c) const {
    const double seconds = c.seconds > 0 ? c.seconds : seconds_;
    check_time("a loop", seconds);
    require(frame_at(seconds, body_.rate) >= 2, "a loop of ", seconds, " s is shorter than two frames, ",
            2 / body_.rate, " s");
  }

  void operator()(const ContactConstraint& c) const {
    check_joint(c.joint);
    check_span(body_.skeleton.joints[c.joint].name, c.from, c.to);
    require(frame_at(c.to, body_.rate) > frame_at(c.from, body_.rate), "a foot that stands from ", c.from,
            " to ", c.to, " s stands for less than a frame, ", 1 / body_.rate, " s");
  }

 private:
  void check_joint(std::size_t joint) const {
    require(joint < body_.skeleton.size(), "joint ", joint, " is not one of the skeleton's ",
            body_.skeleton.size(), " joints");
  }
  void check_time(const std::string& what, double time) const {
    require(time >= 0 && time <= seconds_ + 0.5 / body_.rate, what, " at ", time,
            " s is outside of the motion, which is from 0 to ", seconds_, " s; make it longer (--frames)");
  }
  void check_span(const std::string& what, double from, double to) const {
    check_time(what, from);
    check_time(what, to);
    require(to >= from, what, " ends at ", to, " s, before it begins at ", from, " s");
  }
  /// Whether a place can be reached from the start. Within `arm` of it the root need not move.
  void check_way(const std::string& what, double x, double z, double time, double arm) const {
    const double far = std::hypot(x - start_.x, z - start_.z) - arm;
    if (far > 0.5 * leg_) check_speed(concat("from the start to ", what), far, time);
  }
  void check_speed(const std::string& what, double way, double took) const {
    if (!body_.fastest || way <= 1.5 * *body_.fastest * took) return;
    throw Error("it is ", way / leg_, " leg lengths ", what, " in ", took, " s, ",
                took > 0 ? concat(way / leg_ / took, " a second") : std::string("at once"),
                "; the fastest of the training motion is ", *body_.fastest / leg_,
                " a second. Give more time, or a nearer "
                "place");
  }

  const DirectedBody& body_;
  motion::RootTrack start_;
  double seconds_, leg_;
};

}  // namespace detail

/// Throws Error for constraints that cannot be meant, for a motion of `seconds` that begins at `start`: times
/// outside of it, joints that do not exist, poses of another skeleton, places that are further away than one
/// and a half times the training motion's largest speed gets.
inline void check_constraints(const DirectedBody& body, const std::vector<Constraint>& constraints,
                              const motion::RootTrack& start, double seconds) {
  const detail::ConstraintCheck check(body, start, seconds);
  for (const Constraint& c : constraints) std::visit(check, c);
  const auto paths = std::count_if(constraints.begin(), constraints.end(), [](const Constraint& c) {
    return std::holds_alternative<PathConstraint>(c);
  });
  require(paths <= 1, "a motion follows one path, found ", paths);
}

}  // namespace motiongan
