// Pose vectors of a network taken apart: rotations, joints about the root, and the root's steps and turns, by
// differentiable forward kinematics.
#pragma once
#include <algorithm>
#include <vector>

#include "motiongan/data/motion_format.hpp"
#include "motiongan/ops/forward_kinematics.hpp"
#include "motiongan/ops/matmul.hpp"

namespace motiongan {

/// Ground coordinates of joints, one row each: [joints, poses].
struct Ground {
  Var x, z;
};

/// Rotates ground coordinates as motion::turn_ground does, by the cosine and the sine of an angle per pose,
/// [1, poses].
inline Ground turned(const Ground& ground, const Var& cosine, const Var& sine) {
  const Var c = broadcast_to(cosine, ground.x.shape()), s = broadcast_to(sine, ground.x.shape());
  return {c * ground.x + s * ground.z, c * ground.z - s * ground.x};
}
/// The same by an angle per pose, in radians.
inline Ground turned(const Ground& ground, const Var& yaw) { return turned(ground, cos(yaw), sin(yaw)); }

/// Poses by rows. Poses are numbered frame by frame: f * batch + b. Lengths are in the clips' unit.
struct BodyRows {
  /// [3 * joints, poses], exponential maps, the root's as the pose layout has it; empty in poses of
  /// positions.
  Var rotations;
  /// [4, poses]: x, y, z of the root's position, and its yaw or turn, as the layout has them; likewise.
  Var track;
  Ground body;  ///< joints about the root, [joints, poses], in its heading (in the world without yaw)
  Var height;   ///< above the ground, [joints, poses]
  /// From the second frame on, in the heading of the frame before: the root's step, [1, poses - batch], and
  /// how far the joints move about the root, [joints, poses - batch].
  Ground step, moved;
  Var turn;  ///< radians, [1, poses - batch]; empty without yaw
};

/// Takes normalised motion in window form apart.
class BodyReader {
 public:
  BodyReader(const Context& context, const motion::MotionFormat& format)
      : layout_(format.layout),
        joints_(format.skeleton().size()),
        dof_(format.dof()),
        tree_(context, format.skeleton(), format.layout.root()) {
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
  }

  const motion::PoseLayout& layout() const { return layout_; }
  std::size_t root() const { return layout_.root(); }
  std::size_t joints() const { return joints_; }
  /// Whether a joint hangs on the root; others, and the root, are taken to be where the root is.
  bool hangs(std::size_t joint) const { return tree_.parent[joint] >= 0; }

  /// Of normalised motion [N, B, dof]. Throws Error for another dof, or for fewer than 2 frames.
  BodyRows operator()(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(2) == dof_ && motion.dim(0) >= 2, "BodyReader: motion ",
            motion.shape(), ", expected [2 or more frames, batch, ", dof_, "]");
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const Var full = matmul(map_, reshape(motion, {poses, dof_}), false, true) +
                     broadcast_to(shift_, {shift_.dim(0), poses});
    BodyRows out;
    out.rotations = slice(full, 0, 0, 3 * joints_);
    out.track = slice(full, 0, 3 * joints_, 4);
    const Var places = reshape(forward_kinematics(out.rotations, tree_), {joints_, 3, poses});
    const auto axis = [&](std::size_t a) { return reshape(slice(places, 1, a, 1), {joints_, poses}); };
    const auto track = [&](std::size_t a) { return slice(full, 0, 3 * joints_ + a, 1); };
    out.body = {axis(0), axis(2)};
    const Ground root{track(0), track(2)};
    const Var below = axis(1);
    out.height =
        below +
        over_joints(layout_.has_support() ? lifted(track(1)) - weighted(support(below), below) : track(1));

    const auto now = [&](const Var& v) { return slice(v, 1, batch, poses - batch); };
    const auto before = [&](const Var& v) { return slice(v, 1, 0, poses - batch); };
    out.step = {now(root.x), now(root.z)}, out.moved = {now(out.body.x), now(out.body.z)};
    if (!layout_.has_steps()) {
      out.step = {out.step.x - before(root.x), out.step.z - before(root.z)};
      if (layout_.has_yaw()) out.step = turned(out.step, -before(track(3)));
    }
    if (layout_.has_yaw()) {
      out.turn = layout_.has_steps() ? now(track(3)) : now(track(3)) - before(track(3));
      out.moved = turned(out.moved, out.turn);
    }
    out.moved = {out.moved.x - before(out.body.x), out.moved.z - before(out.body.z)};
    if (layout_.has_support()) {
      const Var weights = support(affine(now(below) + before(below), 0.5));
      out.step = {out.step.x - weighted(weights, out.moved.x), out.step.z - weighted(weights, out.moved.z)};
    }
    return out;
  }

  /// A row [1, poses] for every joint, [joints, poses].
  Var over_joints(const Var& row) const { return broadcast_to(row, {joints_, row.dim(1)}); }

 private:
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

  /// The weighted sum over the joints of each pose: [joints, poses] to [1, poses].
  static Var weighted(const Var& weights, const Var& values) {
    return reshape(sum(weights * values, 0), {1, values.dim(1)});
  }

  motion::PoseLayout layout_;
  std::size_t joints_, dof_;
  JointTree tree_;
  Var map_, shift_;
};

}  // namespace motiongan
