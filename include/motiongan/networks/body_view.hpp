// A motion as an onlooker sees it: where the joints are and how fast they move, computed from the pose
// vectors of a network by differentiable forward kinematics.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "motiongan/data/motion_format.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/ops/forward_kinematics.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// Places and velocities of the joints of normalised motion, for a critic or a loss that should judge what is
/// seen. For every joint: x and z relative to the root in the root's heading, the height above the ground,
/// and the velocity over the ground in the heading of the frame before. The first frame has the velocity of
/// the second. Joints that are always where another one is are left out.
///
/// Lengths are in legs (motion::body_unit), velocities in legs per second. Places are multiplied by
/// place_scale, after which both vary by about 1 in human motion. The values of a frame are x of all joints
/// but the root, their heights with the root's, z as x, and the velocities along x, y and z of all joints.
class BodyView {
 public:
  static constexpr double place_scale = 3;

  /// Throws Error for a skeleton without a bone of positive length.
  BodyView(const Context& context, const motion::MotionFormat& format)
      : layout_(format.layout), joints_(format.skeleton().size()), dof_(format.dof()) {
    const motion::Skeleton& skeleton = format.skeleton();
    tree_ = JointTree(context, skeleton, layout_.root());
    const double leg = motion::body_unit(skeleton);
    require(leg > 0, "the skeleton has no bones of positive length: its joints have no places to be seen");

    // Rows: 3 per joint, then x, y, z and yaw of the root.
    const std::size_t rows = 3 * joints_ + 4;
    std::vector<double> map(rows * dof_), shift(rows);
    const motion::Normalizer& normalizer = format.normalizer;
    const auto fill = [&](std::size_t row, std::size_t dim) {
      shift[row] = normalizer.mean()[dim];
      const auto& kept = normalizer.kept();
      const auto at = std::lower_bound(kept.begin(), kept.end(), dim);
      if (at != kept.end() && *at == dim)
        map[row * dof_ + static_cast<std::size_t>(at - kept.begin())] = normalizer.std()[dim];
    };
    for (std::size_t d = 0; d < 3 * joints_; ++d)
      if (!layout_.has_yaw() || d != layout_.yaw_dim()) fill(d, d);
    for (std::size_t d = 0; layout_.root_position() && d < 3; ++d)
      fill(3 * joints_ + d, layout_.position_dim() + d);
    if (layout_.has_yaw()) fill(rows - 1, layout_.yaw_dim());
    map_ = Var::constant(Tensor::from(context, {rows, dof_}, map));
    shift_ = Var::constant(Tensor::from(context, {rows, 1}, shift));

    // Rows: x, height and z of all joints, then their velocities.
    std::vector<std::pair<std::size_t, double>> seen;
    for (std::size_t part = 0; part < 6; ++part)
      for (std::size_t j = 0; j < joints_; ++j) {
        const bool fixed = j == layout_.root() && (part == 0 || part == 2);
        if (!fixed && shown(skeleton, j))
          seen.emplace_back(part * joints_ + j, (part < 3 ? place_scale : format.rate) / leg);
      }
    for (std::size_t j = 0; j < joints_; ++j)
      if (shown(skeleton, j)) shown_.push_back(j);
    size_ = seen.size();
    std::vector<double> select(6 * joints_ * size_);
    for (std::size_t k = 0; k < size_; ++k) select[seen[k].first * size_ + k] = seen[k].second;
    select_ = Var::constant(Tensor::from(context, {6 * joints_, size_}, select));
  }

  /// Values per frame.
  std::size_t size() const { return size_; }
  /// Joints that are seen, the first value of their heights, and of their velocities, in a frame.
  std::size_t joints() const { return shown_.size(); }
  std::size_t heights() const { return shown_.size() - 1; }
  std::size_t speeds() const { return 3 * shown_.size() - 2; }
  /// The place of a joint of the skeleton among those that are seen. Throws Error if it is not.
  std::size_t joint(std::size_t j) const {
    const auto at = std::lower_bound(shown_.begin(), shown_.end(), j);
    require(at != shown_.end() && *at == j, "joint ", j, " is always where another joint is");
    return static_cast<std::size_t>(at - shown_.begin());
  }

  /// [N, B, size()] of normalised motion [N, B, dof] in window form. Throws Error for another dof, or for
  /// fewer than 2 frames.
  Var operator()(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(2) == dof_ && motion.dim(0) >= 2, "BodyView: motion ",
            motion.shape(), ", expected [2 or more frames, batch, ", dof_, "]");
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const Var full = matmul(map_, reshape(motion, {poses, dof_}), false, true) +
                     broadcast_to(shift_, {shift_.dim(0), poses});
    const Var places =
        reshape(forward_kinematics(slice(full, 0, 0, 3 * joints_), tree_), {joints_, 3, poses});
    const auto axis = [&](std::size_t a) { return reshape(slice(places, 1, a, 1), {joints_, poses}); };
    const auto track = [&](std::size_t a) { return slice(full, 0, 3 * joints_ + a, 1); };
    const Ground body{axis(0), axis(2)}, root{track(0), track(2)};
    const Var below = axis(1);
    const Var height =
        below +
        over_joints(layout_.has_support() ? lifted(track(1)) - weighted(support(below), below) : track(1));

    const auto now = [&](const Var& v) { return slice(v, 1, batch, poses - batch); };
    const auto before = [&](const Var& v) { return slice(v, 1, 0, poses - batch); };
    Ground step{now(root.x), now(root.z)}, moved{now(body.x), now(body.z)};
    if (!layout_.has_steps()) {
      step = {step.x - before(root.x), step.z - before(root.z)};
      if (layout_.has_yaw()) step = turned(step, -before(track(3)));
    }
    if (layout_.has_yaw())
      moved = turned(moved, layout_.has_steps() ? now(track(3)) : now(track(3)) - before(track(3)));
    moved = {moved.x - before(body.x), moved.z - before(body.z)};
    if (layout_.has_support()) {
      const Var weights = support(affine(now(below) + before(below), 0.5));
      step = {step.x - weighted(weights, moved.x), step.z - weighted(weights, moved.z)};
    }
    const Var speed = concatenate(
        {moved.x + over_joints(step.x), now(height) - before(height), moved.z + over_joints(step.z)}, 0);
    const Var seen = concatenate(
        {concatenate({body.x, height, body.z}, 0), concatenate({slice(speed, 1, 0, batch), speed}, 1)}, 0);
    return reshape(matmul(seen, select_, true, false), {frames, batch, size_});
  }

 private:
  struct Ground {
    Var x, z;
  };

  /// Whether a joint is the root, or hangs on it in a place of its own.
  bool shown(const motion::Skeleton& skeleton, std::size_t j) const {
    return j == layout_.root() || (tree_.parent[j] >= 0 && motion::length(skeleton.joints[j].offset) > 0);
  }

  /// The height of the support, see PoseLayout::lifted().
  Var lifted(const Var& height) const {
    const auto& floor = layout_.floor();
    return floor ? affine(exp(height) - exp(-height), layout_.softness(), *floor) : height;
  }

  /// As motion::support_weights(), for the heights [joints, poses].
  Var support(const Var& heights) const {
    const Var fixed = heights.detach();  // weights do not depend on what is subtracted from all heights
    const Var lowest = over_joints(weighted(mark_lowest(fixed), fixed));
    const Var parts = exp(affine(heights - lowest, -1 / layout_.softness()));
    return parts / over_joints(reshape(sum(parts, 0), {1, heights.dim(1)}));
  }

  /// A row [1, poses] for every joint, [joints, poses].
  Var over_joints(const Var& row) const { return broadcast_to(row, {joints_, row.dim(1)}); }

  /// The weighted sum over the joints of each pose: [joints, poses] to [1, poses].
  static Var weighted(const Var& weights, const Var& values) {
    return reshape(sum(weights * values, 0), {1, values.dim(1)});
  }

  /// As motion::turn_ground; one angle per pose, [1, poses].
  static Ground turned(const Ground& ground, const Var& yaw) {
    const Var cosine = broadcast_to(cos(yaw), ground.x.shape()),
              sine = broadcast_to(sin(yaw), ground.x.shape());
    return {cosine * ground.x + sine * ground.z, cosine * ground.z - sine * ground.x};
  }

  motion::PoseLayout layout_;
  std::size_t joints_, dof_, size_ = 0;
  std::vector<std::size_t> shown_;
  JointTree tree_;
  Var map_, shift_, select_;
};

}  // namespace motiongan
