// Forward kinematics as a differentiable operation: rotations of joints to their positions.
#pragma once
#include <vector>

#include "motiongan/motion/skeleton.hpp"
#include "motiongan/ops/elementwise.hpp"
#include "motiongan/ops/fused.hpp"
#include "motiongan/ops/reduce.hpp"
#include "motiongan/ops/reshape.hpp"

namespace motiongan {

namespace detail {
inline const ElementwiseKernel sine_kernel("sine_of", 1, "sin(v)");
inline const ElementwiseKernel cosine_kernel("cosine_of", 1, "cos(v)");
}  // namespace detail

inline Var cos(const Var& x);

/// The sine of each element, in radians.
inline Var sin(const Var& x) {
  return record("sin", {x}, detail::unary(detail::sine_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {g * cos(self.inputs[0])};
                });
}

/// The cosine of each element, in radians.
inline Var cos(const Var& x) {
  return record("cos", {x}, detail::unary(detail::cosine_kernel, x.value()),
                [](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {-(g * sin(self.inputs[0]))};
                });
}

/// Parents and offsets of a body's joints on the device.
struct JointTree {
  JointTree() = default;
  /// The joints that hang on `root`, which is at the origin whatever its own offset and parent are; so are
  /// joints that do not hang on it.
  JointTree(const Context& context, const motion::Skeleton& skeleton, std::size_t root = 0)
      : parent(skeleton.size(), -1), offset(3 * skeleton.size(), 0) {
    for (std::size_t j = root + 1; j < skeleton.size(); ++j) {
      const int p = skeleton.joints[j].parent;
      if (p < 0 || (static_cast<std::size_t>(p) != root && parent[static_cast<std::size_t>(p)] < 0)) continue;
      parent[j] = p;
      std::copy_n(skeleton.joints[j].offset.begin(), 3, offset.begin() + static_cast<std::ptrdiff_t>(3 * j));
    }
    parents = Indices(context, parent);
    offsets = Tensor::from(context, {offset.size()}, offset);
  }

  std::size_t size() const { return parent.size(); }

  std::vector<cl_int> parent;  ///< [joints], -1 for the root and for joints that do not hang on it
  std::vector<double> offset;  ///< [3 * joints], from the parents
  Indices parents;             ///< the same on the device
  Tensor offsets;
};

namespace detail {

/// A joint's global rotation, row by row, and its position: each [1, poses].
struct JointFrame {
  std::vector<Var> rotation, position;
};

/// The rotation matrix of an exponential map, see turn_of and matrix_of in cl/kinematics.cl.
inline std::vector<Var> rotation_matrix(const Var& x, const Var& y, const Var& z) {
  const Var s = square(x) + square(y) + square(z), squared = s + 1e-12, angle = sqrt(squared);
  const Var a = sin(angle) / angle, b = 2 * (square(sin(0.5 * angle)) / squared);
  const Var c = affine(b * s, -1, 1), bx = b * x, by = b * y;
  const Var xy = bx * y, xz = bx * z, yz = by * z, ax = a * x, ay = a * y, az = a * z;
  return {c + bx * x, xy - az, xz + ay, xy + az, c + by * y, yz - ax, xz - ay, yz + ax, c + b * square(z)};
}

inline Var forward_kinematics_composed(const Var& rotations, const JointTree& tree) {
  std::vector<JointFrame> frames;
  std::vector<Var> out;
  for (std::size_t j = 0; j < tree.size(); ++j) {
    const auto part = [&](std::size_t axis) { return slice(rotations, 0, 3 * j + axis, 1); };
    const std::vector<Var> own = rotation_matrix(part(0), part(1), part(2));
    const Var zero = zeros(rotations.context(), {1, rotations.dim(1)});
    JointFrame frame{own, {zero, zero, zero}};
    if (tree.parent[j] >= 0) {
      const JointFrame& above = frames[static_cast<std::size_t>(tree.parent[j])];
      for (std::size_t r = 0; r < 3; ++r) {
        Var at = above.position[r];
        for (std::size_t c = 0; c < 3; ++c) {
          at = weighted_sum(at, 1, above.rotation[3 * r + c], tree.offset[3 * j + c]);
          frame.rotation[3 * r + c] = above.rotation[3 * r] * own[c] +
                                      above.rotation[3 * r + 1] * own[3 + c] +
                                      above.rotation[3 * r + 2] * own[6 + c];
        }
        frame.position[r] = at;
      }
    }
    out.insert(out.end(), frame.position.begin(), frame.position.end());
    frames.push_back(std::move(frame));
  }
  return concatenate(out, 0);
}

}  // namespace detail

/// Positions of the joints of many poses relative to the tree's root: exponential maps of the local rotations
/// in radians, [3 * joints, poses], to positions in the unit of the offsets, [3 * joints, poses]. Throws
/// Error for another number of rotations.
inline Var forward_kinematics(const Var& rotations, const JointTree& tree) {
  const std::size_t joints = tree.size();
  require(rotations.value().rank() == 2 && rotations.dim(0) == 3 * joints, "forward_kinematics: rotations ",
          rotations.shape(), ", expected [", 3 * joints, ", poses]");
  const std::size_t poses = rotations.dim(1);
  const Context& context = rotations.context();
  const LaunchGrid grid = LaunchGrid::items(detail::vectors(context, poses));
  Tensor value(context, rotations.shape()), global(context, {9 * joints, poses});
  context.launch("kinematics", "joint_positions", grid, rotations.value(), tree.offsets, tree.parents, value,
                 global, joints, poses);
  return detail::fused(
      "forward_kinematics", {rotations}, std::move(value),
      [=](const Node& self, const Tensor& g, const Needs&) -> std::vector<Tensor> {
        const Tensor& q = self.inputs[0].value();
        Tensor out(q.context(), q.shape()), scratch(q.context(), {12 * joints, poses});
        q.context().launch("kinematics", "joint_positions_grad", grid, q, tree.offsets, tree.parents, global,
                           g, scratch, out, joints, poses);
        return {out};
      },
      [=](const std::vector<Var>& inputs) { return detail::forward_kinematics_composed(inputs[0], tree); });
}

/// For every pose 1 at the joint of least height, 0 at the others: [joints, poses]. A constant.
inline Var mark_lowest(const Var& heights) {
  require(heights.value().rank() == 2, "mark_lowest: heights ", heights.shape(),
          ", expected [joints, poses]");
  Tensor value(heights.context(), heights.shape());
  heights.context().launch("kinematics", "mark_lowest", LaunchGrid::items(heights.dim(1)), heights.value(),
                           value, heights.dim(0), heights.dim(1));
  return Var::constant(std::move(value));
}

}  // namespace motiongan
