// The same for models of positions: where their joints are in the world, with derivatives.
#pragma once
#include <algorithm>
#include <vector>

#include "motiongan/data/position_format.hpp"
#include "motiongan/networks/world_view.hpp"

namespace motiongan {

/// Follows the root of poses of positions over the ground. The heading of a frame is that of
/// PositionLayout::places: across the body, as the joints are.
class PlaceView {
 public:
  /// Throws Error for a format without the root's track.
  PlaceView(const Context& context, const motion::PositionFormat& format)
      : joints_(format.skeleton().size()), dof_(format.dof()) {
    require(
        format.layout.root_track(),
        "this model was trained without the root's track (--no-root), so that its characters stay in place: "
        "there is nowhere to lead them");
    const std::size_t rows = 3 * joints_ + 4;
    std::vector<double> map(rows * dof_), shift(rows), across(joints_);
    const motion::Normalizer& normalizer = format.normalizer;
    // Rows: x of all joints, y, z, then the track.
    for (std::size_t d = 0; d < rows; ++d) {
      const std::size_t row = d < 3 * joints_ ? d % 3 * joints_ + d / 3 : d;
      shift[row] = normalizer.mean()[d];
      const auto& kept = normalizer.kept();
      const auto at = std::lower_bound(kept.begin(), kept.end(), d);
      if (at != kept.end() && *at == d)
        map[row * dof_ + static_cast<std::size_t>(at - kept.begin())] = normalizer.std()[d];
    }
    const auto pairs = motion::across_body(format.skeleton());
    for (const auto& [left, right] : pairs) across[left] += 1, across[right] -= 1;
    has_heading_ = !pairs.empty();
    map_ = Var::constant(Tensor::from(context, {rows, dof_}, map));
    shift_ = Var::constant(Tensor::from(context, {rows, 1}, shift));
    across_ = Var::constant(Tensor::from(context, {1, joints_}, across));
  }

  /// Of normalised motion [N, B, dof]; there are no rotations. Throws Error for another dof, or for fewer
  /// than 2 frames.
  WorldRows operator()(const Var& motion) const {
    require(motion.value().rank() == 3 && motion.dim(2) == dof_ && motion.dim(0) >= 2, "PlaceView: motion ",
            motion.shape(), ", expected [2 or more frames, batch, ", dof_, "]");
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const Var full = matmul(map_, reshape(motion, {poses, dof_}), false, true) +
                     broadcast_to(shift_, {shift_.dim(0), poses});
    const auto joints = [&](std::size_t axis) { return slice(full, 0, axis * joints_, joints_); };
    const auto track = [&](std::size_t row) { return slice(full, 0, 3 * joints_ + row, 1); };
    const auto over_joints = [&](const Var& row) { return broadcast_to(row, {joints_, poses}); };
    const auto later = [&](const Var& row) { return slice(row, 1, batch, poses - batch); };
    const auto earlier = [&](const Var& row) { return slice(row, 1, 0, poses - batch); };

    // Where the track leads, from facing +z in the first frame.
    const Var yaw = detail::summed(later(track(3)), frames, batch), cosine = cos(yaw), sine = sin(yaw);
    Ground root = detail::summed(turned({later(track(0)), later(track(1))}, earlier(cosine), earlier(sine)),
                                 frames, batch);
    const Ground own{joints(0), joints(2)};
    Ground about = turned(own, cosine, sine);

    WorldRows out;
    out.y = joints(1) + over_joints(track(2));
    out.body = own, out.cosine = cosine, out.sine = sine;
    if (has_heading_) {  // what a network makes is not exactly across its own heading
      const Var x = matmul(across_, own.x), z = matmul(across_, own.z),
                wide = sqrt(square(x) + square(z) + 1e-12), c = x / wide, s = -z / wide;
      out.body = turned(own, c, -s);
      const Var first_c = detail::first_frame(c, frames, batch),
                first_s = detail::first_frame(s, frames, batch);
      root = turned(root, first_c, -first_s), about = turned(about, first_c, -first_s);
      // The angles yaw + own - that of the first frame.
      const Var by_c = c * first_c + s * first_s, by_s = s * first_c - c * first_s;
      out.cosine = cosine * by_c - sine * by_s, out.sine = sine * by_c + cosine * by_s;
    }
    out.x = about.x + over_joints(root.x), out.z = about.z + over_joints(root.z);
    return out;
  }

 private:
  std::size_t joints_, dof_;
  bool has_heading_ = false;
  Var map_, shift_, across_;
};

}  // namespace motiongan
