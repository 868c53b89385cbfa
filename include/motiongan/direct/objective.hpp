// The constraints as a loss on what a network makes, with derivatives.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "motiongan/direct/constraints.hpp"
#include "motiongan/direct/directed_body.hpp"
#include "motiongan/direct/path.hpp"

namespace motiongan {

namespace detail {

/// Squared differences from targets, weighted, over values [rows, frames * batch].
class WeightedTargets {
 public:
  WeightedTargets() = default;
  WeightedTargets(std::size_t rows, std::size_t poses)
      : rows_(rows), poses_(poses), root_weights_(rows * poses, 0), targets_(rows * poses, 0) {}

  bool used() const { return used_; }

  /// A second target of the same value adds its weight; the targets are averaged.
  void add(std::size_t row, std::size_t pose, double weight, double target) {
    double &r = root_weights_[row * poses_ + pose], &t = targets_[row * poses_ + pose];
    const double before = r * r;
    t = (before * t + weight * target) / (before + weight);
    r = std::sqrt(before + weight);
    used_ = true;
  }

  void finish(const Context& context) {
    if (!used_) return;
    weight_ = Var::constant(Tensor::from(context, {rows_, poses_}, root_weights_));
    target_ = Var::constant(Tensor::from(context, {rows_, poses_}, targets_));
  }

  /// Added to `loss`, [1].
  Var added(const Var& loss, const Var& values) const {
    return used_ ? loss + sum(square(weight_ * (values - target_))) : loss;
  }

 private:
  std::size_t rows_ = 0, poses_ = 0;
  std::vector<double> root_weights_, targets_;
  bool used_ = false;
  Var weight_, target_;
};

}  // namespace detail

/// The loss of a batch of motions in which every sample has constraints of its own.
class DirectObjective {
 public:
  /// For motions of `frames` frames, of which the first is frame `first` of the whole motion.
  DirectObjective(const Context& context, const motion::MotionFormat& format, std::size_t frames,
                  std::size_t batch, std::size_t first = 0)
      : DirectObjective(WorldView(context, format), directed_body(format), frames, batch, first) {}
  DirectObjective(const Context& context, const motion::PositionFormat& format, std::size_t frames,
                  std::size_t batch, std::size_t first = 0)
      : DirectObjective(PlaceView(context, format), directed_body(format), frames, batch, first) {}

  /// Adds the constraints of a sample, as far as they fall into these frames. `anchor` is where the root is
  /// in the first of them, `seconds` the length of the whole motion.
  void add(std::size_t sample, const std::vector<Constraint>& constraints, const motion::RootTrack& anchor,
           double seconds) {
    anchor_ = anchor, sample_ = sample, seconds_ = seconds;
    for (const Constraint& c : constraints) std::visit([&](const auto& one) { take(one); }, c);
  }

  /// After the last add().
  void finish(const Context& context) {
    for (detail::WeightedTargets* t : {&places_, &bodies_, &rotations_, &headings_, &ways_, &steps_})
      t->finish(context);
    for (auto& [last, loop] : loops_) {
      for (double& weight : loop.weights) weight = std::sqrt(weight);
      loop.root_weight = Var::constant(Tensor::from(context, {1, batch_}, loop.weights));
    }
    if (!ways_.used()) return;
    const Shape shape{2, frames_ * batch_};
    way_x_ = Var::constant(Tensor::from(context, shape, ways_x_));
    way_z_ = Var::constant(Tensor::from(context, shape, ways_z_));
  }

  /// For loops: motions should not become loops by standing still, where `motion` [N, B, dof], their own
  /// before the optimisation, moves.
  void keep_moving(const Var& motion) {
    if (!loops_.empty()) activity_ = activity(view_(motion)).detach();
  }

  /// The loss, [1], of normalised motion [N, B, dof], summed over the samples: squared lengths are in
  /// legs if a twentieth of a leg is allowed, and more or less otherwise.
  Var operator()(const Var& motion) const {
    const WorldRows world = view_(motion);
    const std::size_t poses = frames_ * batch_, root = own_.root;
    Var loss = zeros(motion.context(), {1});
    if (places_.used()) loss = places_.added(loss, concatenate({world.x, world.y, world.z}, 0));
    if (bodies_.used()) loss = bodies_.added(loss, concatenate({world.body.x, world.body.z}, 0));
    if (rotations_.used()) loss = rotations_.added(loss, world.rotations);
    if (headings_.used()) loss = headings_.added(loss, concatenate({world.cosine, world.sine}, 0));
    if (ways_.used()) {
      const Var x = broadcast_to(slice(world.x, 0, root, 1), {2, poses}),
                z = broadcast_to(slice(world.z, 0, root, 1), {2, poses});
      loss = ways_.added(loss, way_x_ * x + way_z_ * z);
    }
    if (steps_.used()) {
      const Var all = concatenate({world.x, world.y, world.z}, 0);
      loss = steps_.added(loss, slice(all, 1, batch_, poses - batch_) - slice(all, 1, 0, poses - batch_));
    }
    for (const auto& [last, loop] : loops_) loss = loss + loop_loss(world, last, loop.root_weight);
    return loss;
  }

 private:
  using View = std::function<WorldRows(const Var& motion)>;

  DirectObjective(View view, DirectedBody body, std::size_t frames, std::size_t batch, std::size_t first)
      : view_(std::move(view)),
        own_(std::move(body)),
        leg_(motion::body_unit(own_.skeleton)),
        joints_(own_.skeleton.size()),
        frames_(frames),
        batch_(batch),
        first_(first) {
    const std::size_t poses = frames * batch;
    places_ = {3 * joints_, poses}, bodies_ = {2 * joints_, poses}, rotations_ = {3 * joints_, poses};
    headings_ = {2, poses}, ways_ = {2, poses};
    ways_x_.resize(2 * poses), ways_z_.resize(2 * poses), steps_ = {3 * joints_, poses - batch};
  }

  // Weights of what helps beside what is asked for.
  static constexpr double pace = 0.1,  // of the way along a path without times
      facing = 0.05,                   // of facing along it
      standing = 4,                    // of a foot's step from frame to frame
      speed = 4,                       // of the movement at a loop's ends
      liveliness = 0.02;               // of moving less in a loop than before

  std::size_t pose_of(std::size_t frame) const { return (frame - first_) * batch_ + sample_; }
  bool inside(std::size_t frame) const { return frame >= first_ && frame < first_ + frames_; }
  /// Errors count by what is allowed, in twentieths of a leg: what has to be met closely counts more.
  template <class C>
  double per_square_length(const C& c) const {
    const double allowed = std::max(c.tolerance > 0 ? c.tolerance / leg_ : default_tolerance(c), 0.01);
    return c.weight * (0.05 / allowed) * (0.05 / allowed) / (leg_ * leg_);
  }

  /// A place relative to the anchor.
  motion::Vec3 local(motion::Vec3 p) const {
    p[0] -= anchor_.x, p[2] -= anchor_.z;
    motion::turn_ground(p[0], p[2], -anchor_.yaw);
    return p;
  }
  void face(std::size_t frame, double yaw, double weight) {
    headings_.add(0, pose_of(frame), weight, std::cos(yaw - anchor_.yaw));
    headings_.add(1, pose_of(frame), weight, std::sin(yaw - anchor_.yaw));
  }
  void place(std::size_t joint, std::size_t frame, const motion::Vec3& at, double weight) {
    const motion::Vec3 p = local(at);
    for (std::size_t axis = 0; axis < 3; ++axis)
      places_.add(axis * joints_ + joint, pose_of(frame), weight, p[axis]);
  }

  void take(const PoseConstraint& c) {
    const std::size_t at = frame_at(c.time, own_.rate);
    const double count = static_cast<double>(c.joints.empty() ? joints_ : c.joints.size());
    const double weight = per_square_length(c) / count;
    for (std::size_t i = 0; i < c.pose.frames; ++i) {
      if (!inside(at + i)) continue;
      const WorldPose pose = own_.read(c.pose, i);
      const auto hold = [&](std::size_t j) {
        if (c.placed) return place(j, at + i, pose.joint(j), weight);
        places_.add(joints_ + j, pose_of(at + i), weight, pose.body[j][1]);
        bodies_.add(j, pose_of(at + i), weight, pose.body[j][0]);
        bodies_.add(joints_ + j, pose_of(at + i), weight, pose.body[j][2]);
      };
      for (std::size_t j = 0; c.joints.empty() && j < joints_; ++j) hold(j);
      for (const std::size_t j : c.joints) hold(j);
      if (c.placed) face(at + i, pose.yaw, c.weight);
    }
  }

  void take(const JointConstraint& c) {
    const std::size_t last = frame_at(c.to, own_.rate), root = own_.root;
    for (std::size_t f = frame_at(c.from, own_.rate); f <= last; ++f) {
      if (!inside(f)) continue;
      if (c.position) place(c.joint, f, *c.position, per_square_length(c));
      if (!c.rotation) continue;
      const bool turns = c.joint == root && own_.root_turns;
      const motion::Vec3 r =
          turns ? motion::heading_from_quat(*c.rotation) : motion::expmap_from_quat(*c.rotation);
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (!turns || axis != 1)
          rotations_.add(3 * c.joint + axis, pose_of(f), c.weight, r[axis]);
        else
          face(f, r[1], c.weight);
    }
  }

  void take(const PathConstraint& c) {
    const TimedPath path(c.points, seconds_);
    const std::size_t last = frame_at(path.last_time(), own_.rate), poses = frames_ * batch_;
    for (std::size_t f = frame_at(path.first_time(), own_.rate); f <= last; ++f) {
      if (!inside(f)) continue;
      const PathFrame at = path.at(static_cast<double>(f) / own_.rate);
      const motion::Vec3 p = local({at.x, 0, at.z});
      double x = at.along_x, z = at.along_z;
      motion::turn_ground(x, z, -anchor_.yaw);
      const std::size_t pose = pose_of(f);
      // Across the path, and along it.
      ways_x_[pose] = z, ways_z_[pose] = -x;
      ways_x_[poses + pose] = x, ways_z_[poses + pose] = z;
      const double weight = per_square_length(c);
      ways_.add(0, pose, weight, z * p[0] - x * p[2]);
      ways_.add(1, pose, path.timed() || f == last ? weight : pace * weight, x * p[0] + z * p[2]);
      face(f, at.yaw.value_or(std::atan2(at.along_x, at.along_z)), at.yaw ? c.weight : facing * c.weight);
    }
  }

  void take(const LoopConstraint& c) {
    const std::size_t last = frame_at(c.seconds > 0 ? c.seconds : seconds_, own_.rate);
    if (first_ > 0 || last >= frames_ || last < 2) return;
    std::vector<double>& weights = loops_[last].weights;
    weights.resize(batch_, 0);
    weights[sample_] += per_square_length(c);
  }

  void take(const ContactConstraint& c) {
    const std::size_t last = frame_at(c.to, own_.rate);
    const std::vector<std::size_t> feet =
        motion::has_feet(own_.skeleton) ? motion::find_feet(own_.skeleton) : std::vector<std::size_t>();
    const bool on_floor = own_.floor && std::find(feet.begin(), feet.end(), c.joint) != feet.end();
    const double weight = per_square_length(c);
    for (std::size_t f = frame_at(c.from, own_.rate); f <= last; ++f) {
      if (!inside(f)) continue;
      if (on_floor) places_.add(joints_ + c.joint, pose_of(f), weight, *own_.floor);
      if (f == last || !inside(f + 1)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        steps_.add(axis * joints_ + c.joint, pose_of(f), standing * weight, 0);
    }
  }

  /// The logarithm of how much a motion moves: the mean square of its joints' steps in legs. [1, B].
  Var activity(const WorldRows& world) const {
    const std::size_t poses = frames_ * batch_;
    const Var all = concatenate({world.x, world.y, world.z}, 0);
    const Var steps = slice(all, 1, batch_, poses - batch_) - slice(all, 1, 0, poses - batch_);
    const Var each = sum(square(steps), 0, 1 / (static_cast<double>(joints_) * leg_ * leg_));
    const Var mean = sum(reshape(each, {frames_ - 1, batch_}), 0, 1 / static_cast<double>(frames_ - 1));
    return reshape(log(mean + 1e-6), {1, batch_});
  }

  /// Of the pose at a loop's end beside the first, and of the movements there. `root_weight` [1, B] is 0 for
  /// samples without this loop.
  Var loop_loss(const WorldRows& world, std::size_t last, const Var& root_weight) const {
    const std::size_t root = own_.root;
    const auto at = [&](const Var& v, std::size_t frame) { return slice(v, 1, frame * batch_, batch_); };
    const auto squared = [&](const Var& v) { return sum(square(broadcast_to(root_weight, v.shape()) * v)); };
    const Var body = concatenate({world.body.x, world.y, world.body.z}, 0);
    const Var pose = at(body, last) - at(body, 0);
    const Var moves = (at(body, last) - at(body, last - 1)) - (at(body, 1) - at(body, 0));
    // The root's step, in the heading of the frame that it comes from.
    const auto step = [&](std::size_t to) {
      const Var x = slice(world.x, 0, root, 1), z = slice(world.z, 0, root, 1);
      const Ground way{at(x, to) - at(x, to - 1), at(z, to) - at(z, to - 1)};
      const Ground own = turned(way, at(world.cosine, to - 1), -at(world.sine, to - 1));
      return concatenate({own.x, own.z}, 0);
    };
    const double each = 1 / static_cast<double>(joints_);
    Var loss = affine(squared(pose), each);
    loss = weighted_sum(loss, 1, squared(moves), speed * each);
    loss = weighted_sum(loss, 1, squared(step(last) - step(1)), speed);
    if (activity_.empty()) return loss;
    return weighted_sum(loss, 1, squared(relu(activity_ - activity(world))), liveliness * leg_ * leg_);
  }

  View view_;
  DirectedBody own_;
  double leg_;
  std::size_t joints_, frames_, batch_, first_;
  motion::RootTrack anchor_;  // of the sample that is being added
  std::size_t sample_ = 0;
  double seconds_ = 0;
  detail::WeightedTargets places_, bodies_, rotations_, headings_, ways_, steps_;
  std::vector<double> ways_x_, ways_z_;
  Var way_x_, way_z_;
  struct Loop {
    std::vector<double> weights;  // per sample
    Var root_weight;              // [1, B]
  };
  std::map<std::size_t, Loop> loops_;  // by their last frame
  Var activity_;
};

}  // namespace motiongan
