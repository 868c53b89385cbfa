// Where a motion goes: its joints in the world, from the pose vectors of a network, with derivatives.
#pragma once
#include <vector>

#include "motiongan/networks/body_rows.hpp"

namespace motiongan {

/// Motions in the world. It begins under the root of the first frame, and that frame faces +z, so that it
/// does not depend on where a motion was recorded. Poses are numbered f * batch + b; lengths are in the
/// clips' unit, heights are those of the clips.
struct WorldRows {
  Var x, y, z;       ///< joints, [joints, poses]
  Ground body;       ///< joints about the root in its heading, [joints, poses]
  Var cosine, sine;  ///< of the root's heading, [1, poses]
  Var rotations;     ///< exponential maps as the pose layout has them, [3 * joints, poses]
};

namespace detail {

/// Sums over the frames of changes [1, poses - batch], from 0 in the first frame: [1, poses].
inline Var summed(const Var& changes, std::size_t frames, std::size_t batch) {
  std::vector<double> below(frames * (frames - 1), 0);
  for (std::size_t f = 1; f < frames; ++f)
    for (std::size_t g = 0; g < f; ++g) below[f * (frames - 1) + g] = 1;
  const Var triangle = Var::constant(Tensor::from(changes.context(), {frames, frames - 1}, below));
  return reshape(matmul(triangle, reshape(changes, {frames - 1, batch})), {1, frames * batch});
}
inline Ground summed(const Ground& steps, std::size_t frames, std::size_t batch) {
  return {summed(steps.x, frames, batch), summed(steps.z, frames, batch)};
}

/// The first frame of a row [1, poses], repeated `frames` times.
inline Var first_frame(const Var& row, std::size_t frames, std::size_t batch) {
  return reshape(broadcast_to(slice(row, 1, 0, batch), {frames, batch}), {1, frames * batch});
}

}  // namespace detail

/// Follows the root over the ground. For all forms of the root's rotation.
class WorldView {
 public:
  WorldView(const Context& context, const motion::MotionFormat& format)
      : reader_(context, format), root_(format.layout.root()) {}

  /// Of normalised motion [N, B, dof] in window form. Throws Error as BodyReader does.
  WorldRows operator()(const Var& motion) const {
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const BodyRows rows = reader_(motion);
    WorldRows out;
    out.y = rows.height, out.body = rows.body, out.rotations = rows.rotations;
    Ground root;
    if (rows.turn.empty()) {
      face_by_rotation(rows, out);
      out.body = turned(out.body, out.cosine, -out.sine);
      // Everything is turned so that the first frame faces +z.
      const auto first = [&](const Var& row, std::size_t times) {
        return detail::first_frame(row, times, batch);
      };
      root = detail::summed(turned(rows.step, first(out.cosine, frames - 1), -first(out.sine, frames - 1)),
                            frames, batch);
      const Var cosine = first(out.cosine, frames), sine = first(out.sine, frames);
      const Var faces = cosine * out.cosine + sine * out.sine;
      out.sine = cosine * out.sine - sine * out.cosine;
      out.cosine = faces;
    } else {
      const Var yaw = detail::summed(rows.turn, frames, batch);
      out.cosine = cos(yaw), out.sine = sin(yaw);
      root = detail::summed(
          turned(rows.step, slice(out.cosine, 1, 0, poses - batch), slice(out.sine, 1, 0, poses - batch)),
          frames, batch);
    }
    const Ground about = turned(out.body, out.cosine, out.sine);
    out.x = about.x + reader_.over_joints(root.x), out.z = about.z + reader_.over_joints(root.z);
    return out;
  }

 private:
  /// The heading of an exponential map e, as motion::heading_from_quat: half of it has the cosine and sine of
  /// cos(|e| / 2) and e_y sin(|e| / 2) / |e|, up to a common factor.
  void face_by_rotation(const BodyRows& rows, WorldRows& out) const {
    const auto part = [&](std::size_t axis) { return slice(rows.rotations, 0, 3 * root_ + axis, 1); };
    const Var angle = sqrt(square(part(0)) + square(part(1)) + square(part(2)) + 1e-12);
    const Var w = cos(0.5 * angle), y = part(1) * (sin(0.5 * angle) / angle);
    const Var all = square(w) + square(y) + 1e-12;
    out.cosine = (square(w) - square(y)) / all;
    out.sine = 2 * (w * y / all);
  }

  BodyReader reader_;
  std::size_t root_;
};

}  // namespace motiongan
