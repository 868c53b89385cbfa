// One frame of a motion as the constraints see it.
#pragma once
#include <span>
#include <vector>

#include "motiongan/data/position_layout.hpp"
#include "motiongan/motion/heading.hpp"
#include "motiongan/motion/support.hpp"

namespace motiongan {

/// The joints of a frame: about the root in its heading, and where that is. Joints that do not hang on the
/// root are where it is. Heights are those of the motion.
struct WorldPose {
  std::vector<motion::Vec3> body;  ///< [joints]: x and z about the root in its heading, and the height
  double x = 0, z = 0, yaw = 0;    ///< of the root

  /// The place of a joint in the world.
  motion::Vec3 joint(std::size_t j) const {
    motion::Vec3 out = body[j];
    motion::turn_ground(out[0], out[2], yaw);
    return {out[0] + x, out[1], out[2] + z};
  }
};

/// Frame `frame` of a motion, whose root is joint `root`.
inline WorldPose world_pose(const motion::Motion& motion, std::size_t frame, std::size_t root) {
  const std::size_t joints = motion.skeleton.size();
  const auto own = [&](const auto& values) { return std::span(values).subspan(frame * joints, joints); };
  const motion::Vec3& place = motion.position(frame, root);
  WorldPose out{
      motion::joints_about_root(motion.skeleton, root, own(motion.rotations), own(motion.positions)),
      place[0], place[2], motion::heading_from_quat(motion.rotation(frame, root))[1]};
  for (motion::Vec3& p : out.body) p[1] += place[1];
  return out;
}

/// All frames of positions [frames, joints], whose root is joint 0; the heading is that of the layout.
inline std::vector<WorldPose> world_poses(const motion::PositionLayout& layout,
                                          std::span<const motion::Vec3> positions) {
  std::vector<WorldPose> out;
  const std::size_t joints = layout.skeleton().size();
  for (std::size_t f = 0; const motion::RootTrack& at : layout.places(positions)) {
    WorldPose pose{{}, at.x, at.z, at.yaw};
    for (const motion::Vec3& p : positions.subspan(f++ * joints, joints)) {
      motion::Vec3 own{p[0] - at.x, p[1], p[2] - at.z};
      motion::turn_ground(own[0], own[2], -at.yaw);
      pose.body.push_back(own);
    }
    out.push_back(std::move(pose));
  }
  return out;
}

/// The places of all joints in a frame, [joints].
inline std::vector<motion::Vec3> world_joints(const WorldPose& pose) {
  std::vector<motion::Vec3> out;
  for (std::size_t j = 0; j < pose.body.size(); ++j) out.push_back(pose.joint(j));
  return out;
}

}  // namespace motiongan
