// The same for models of positions: where their joints are in the world, with derivatives.
#pragma once
#include <vector>

#include "motiongan/networks/position_rows.hpp"
#include "motiongan/networks/world_view.hpp"

namespace motiongan {

/// Follows the root of poses of positions over the ground. The heading of a frame is that of
/// PositionLayout::places: across the body, as the joints are.
class PlaceView {
 public:
  /// Throws Error for a format without the root's track.
  PlaceView(const Context& context, const motion::PositionFormat& format) : reader_(context, format) {
    require(
        format.layout.root_track(),
        "this model was trained without the root's track (--no-root), so that its characters stay in place: "
        "there is nowhere to lead them");
    const std::size_t joints = format.skeleton().size();
    std::vector<double> across(joints);
    const auto pairs = motion::across_body(format.skeleton());
    for (const auto& [left, right] : pairs) across[left] += 1, across[right] -= 1;
    has_heading_ = !pairs.empty();
    across_ = Var::constant(Tensor::from(context, {1, joints}, across));
  }

  /// Of normalised motion [N, B, dof]; there are no rotations. Throws Error for another dof, or for fewer
  /// than 2 frames.
  WorldRows operator()(const Var& motion) const {
    const BodyRows rows = reader_(motion);
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const auto earlier = [&](const Var& row) { return slice(row, 1, 0, poses - batch); };

    // Where the track leads, from facing +z in the first frame.
    const Var yaw = detail::summed(rows.turn, frames, batch), cosine = cos(yaw), sine = sin(yaw);
    Ground root = detail::summed(turned(rows.step, earlier(cosine), earlier(sine)), frames, batch);
    Ground about = turned(rows.body, cosine, sine);

    WorldRows out;
    out.y = rows.height;
    out.body = rows.body, out.cosine = cosine, out.sine = sine;
    if (has_heading_) {  // what a network makes is not exactly across its own heading
      const Var x = matmul(across_, rows.body.x), z = matmul(across_, rows.body.z),
                wide = sqrt(square(x) + square(z) + 1e-12), c = x / wide, s = -z / wide;
      out.body = turned(rows.body, c, -s);
      const Var first_c = detail::first_frame(c, frames, batch),
                first_s = detail::first_frame(s, frames, batch);
      root = turned(root, first_c, -first_s), about = turned(about, first_c, -first_s);
      // The angles yaw + own - that of the first frame.
      const Var by_c = c * first_c + s * first_s, by_s = s * first_c - c * first_s;
      out.cosine = cosine * by_c - sine * by_s, out.sine = sine * by_c + cosine * by_s;
    }
    out.x = about.x + reader_.over_joints(root.x), out.z = about.z + reader_.over_joints(root.z);
    return out;
  }

 private:
  PositionReader reader_;
  bool has_heading_ = false;
  Var across_;
};

}  // namespace motiongan
