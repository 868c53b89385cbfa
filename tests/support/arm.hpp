// An arm of three joints, for positions computed by hand.
#pragma once
#include <cstddef>
#include <vector>

#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

inline const std::vector<Channel> six{Channel::x_position, Channel::y_position, Channel::z_position,
                                      Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
inline const std::vector<Channel> three{Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};

/// Shoulder at the root, upper arm 2 along x, lower arm 1 along x, hand 0.5 as end site.
inline Motion arm(std::size_t frames) {
  Motion m;
  m.skeleton.joints = {{"Shoulder", -1, {0, 0, 0}, six, {}},
                       {"Elbow", 0, {2, 0, 0}, three, {}},
                       {"Wrist", 1, {1, 0, 0}, three, Vec3{0.5, 0, 0}}};
  m.rate = 10;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f)
    for (const Joint& j : m.skeleton.joints) {
      m.rotations.push_back({});
      m.positions.push_back(j.offset);
    }
  return m;
}

inline bool near(const Vec3& a, const Vec3& b) { return length(subtract(a, b)) < 1e-12; }

}  // namespace motiongan::motion
