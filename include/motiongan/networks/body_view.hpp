// A motion as an onlooker sees it: where the joints are and how fast they move, computed from the pose
// vectors of a network: of rotations, by differentiable forward kinematics, or of positions.
#pragma once
#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "motiongan/motion/feet.hpp"
#include "motiongan/networks/position_rows.hpp"

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
      : BodyView(context, BodyReader(context, format), format.skeleton(), format.rate) {}
  /// The same for poses of positions. Without the root's track it stays at the origin.
  BodyView(const Context& context, const motion::PositionFormat& format)
      : BodyView(context, PositionReader(context, format), format.skeleton(), format.rate) {}

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
    const std::size_t frames = motion.dim(0), batch = motion.dim(1), poses = frames * batch;
    const BodyRows rows = std::visit([&](const auto& reader) { return reader(motion); }, reader_);
    const auto over_joints = [&](const Var& row) { return broadcast_to(row, rows.moved.x.shape()); };
    const auto now = [&](const Var& v) { return slice(v, 1, batch, poses - batch); };
    const auto before = [&](const Var& v) { return slice(v, 1, 0, poses - batch); };
    const Var speed =
        concatenate({rows.moved.x + over_joints(rows.step.x), now(rows.height) - before(rows.height),
                     rows.moved.z + over_joints(rows.step.z)},
                    0);
    const Var seen = concatenate({concatenate({rows.body.x, rows.height, rows.body.z}, 0),
                                  concatenate({slice(speed, 1, 0, batch), speed}, 1)},
                                 0);
    return reshape(matmul(seen, select_, true, false), {frames, batch, size_});
  }

 private:
  using Reader = std::variant<BodyReader, PositionReader>;

  BodyView(const Context& context, Reader reader, const motion::Skeleton& skeleton, double rate)
      : reader_(std::move(reader)) {
    const std::size_t joints = skeleton.size();
    const double leg = motion::body_unit(skeleton);
    require(leg > 0, "the skeleton has no bones of positive length: its joints have no places to be seen");
    const std::size_t root = std::visit([](const auto& from) { return from.root(); }, reader_);

    // Rows: x, height and z of all joints, then their velocities.
    std::vector<std::pair<std::size_t, double>> seen;
    for (std::size_t part = 0; part < 6; ++part)
      for (std::size_t j = 0; j < joints; ++j) {
        const bool fixed = j == root && (part == 0 || part == 2);
        if (!fixed && (j == root || hangs_apart(skeleton, j)))
          seen.emplace_back(part * joints + j, (part < 3 ? place_scale : rate) / leg);
      }
    for (std::size_t j = 0; j < joints; ++j)
      if (j == root || hangs_apart(skeleton, j)) shown_.push_back(j);
    size_ = seen.size();
    std::vector<double> select(6 * joints * size_);
    for (std::size_t k = 0; k < size_; ++k) select[seen[k].first * size_ + k] = seen[k].second;
    select_ = Var::constant(Tensor::from(context, {6 * joints, size_}, select));
  }

  /// Whether a joint hangs on the root, in a place of its own.
  bool hangs_apart(const motion::Skeleton& skeleton, std::size_t j) const {
    return std::visit([&](const auto& from) { return from.hangs(j); }, reader_) &&
           motion::length(skeleton.joints[j].offset) > 0;
  }

  Reader reader_;
  std::size_t size_ = 0;
  std::vector<std::size_t> shown_;
  Var select_;
};

}  // namespace motiongan
