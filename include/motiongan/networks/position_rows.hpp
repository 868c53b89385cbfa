// Poses of positions taken apart, as body_rows.hpp does it for poses of rotations.
#pragma once
#include <algorithm>
#include <vector>

#include "motiongan/data/position_format.hpp"
#include "motiongan/networks/body_rows.hpp"

namespace motiongan {

/// Takes normalised motion of a model of positions apart.
class PositionReader {
 public:
  PositionReader(const Context& context, const motion::PositionFormat& format)
      : joints_(format.skeleton().size()), dof_(format.dof()), root_track_(format.layout.root_track()) {
    // Rows: x of all joints, y, z, then the track.
    const std::size_t rows = format.layout.dof();
    std::vector<double> map(rows * dof_), shift(rows);
    const motion::Normalizer& normalizer = format.normalizer;
    for (std::size_t d = 0; d < rows; ++d) {
      const std::size_t row = d < 3 * joints_ ? d % 3 * joints_ + d / 3 : d;
      shift[row] = normalizer.mean()[d];
      const auto& kept = normalizer.kept();
      const auto at = std::lower_bound(kept.begin(), kept.end(), d);
      if (at != kept.end() && *at == d)
        map[row * dof_ + static_cast<std::size_t>(at - kept.begin())] = normalizer.std()[d];
    }
    map_ = Var::constant(Tensor::from(context, {rows, dof_}, map));
    shift_ = Var::constant(Tensor::from(context, {rows, 1}, shift));
  }

  std::size_t root() const { return 0; }
  /// Whether a joint has a place of its own: all but the root, which is joint 0.
  bool hangs(std::size_t joint) const { return joint > 0; }

  /// Of normalised motion [N, B, dof]. Without the root's track it stays at the origin and does not turn.
  /// Throws Error for another dof, or for fewer than 2 frames.
  BodyRows operator()(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(2) == dof_ && motion.dim(0) >= 2,
            "PositionReader: motion ", motion.shape(), ", expected [2 or more frames, batch, ", dof_, "]");
    const std::size_t batch = motion.dim(1), poses = motion.dim(0) * batch, later = poses - batch;
    const Var full = matmul(map_, reshape(motion, {poses, dof_}), false, true) +
                     broadcast_to(shift_, {shift_.dim(0), poses});
    const auto joints = [&](std::size_t axis) { return slice(full, 0, axis * joints_, joints_); };
    const auto track = [&](std::size_t row) { return slice(full, 0, 3 * joints_ + row, 1); };
    const auto now = [&](const Var& v) { return slice(v, 1, batch, later); };
    const auto before = [&](const Var& v) { return slice(v, 1, 0, later); };

    BodyRows out;
    out.body = {joints(0), joints(2)}, out.height = joints(1);
    Ground moved{now(out.body.x), now(out.body.z)};
    if (root_track_) {
      out.height = out.height + over_joints(track(2));
      out.step = {now(track(0)), now(track(1))}, out.turn = now(track(3));
      moved = turned(moved, out.turn);
    } else {
      out.step.x = out.step.z = out.turn = zeros(motion.context(), {1, later});
    }
    out.moved = {moved.x - before(out.body.x), moved.z - before(out.body.z)};
    return out;
  }

  /// A row [1, poses] for every joint, [joints, poses].
  Var over_joints(const Var& row) const { return broadcast_to(row, {joints_, row.dim(1)}); }

 private:
  std::size_t joints_, dof_;
  bool root_track_;
  Var map_, shift_;
};

}  // namespace motiongan
