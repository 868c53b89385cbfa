// A small body with legs, arms and a head, for tests of what depends on joint names and size.
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A body 170 units high, y up, facing z, arms stretched sideways at rest. Legs are 90 units long.
inline Skeleton body_skeleton() {
  const std::vector<Channel> turns{Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
  std::vector<Channel> all{Channel::x_position, Channel::y_position, Channel::z_position};
  all.insert(all.end(), turns.begin(), turns.end());
  Skeleton s;
  s.joints = {{"Hips", -1, {0, 95, 0}, all, {}},
              {"LeftUpLeg", 0, {10, -5, 0}, turns, {}},
              {"LeftLeg", 1, {0, -42, 0}, turns, {}},
              {"LeftFoot", 2, {0, -42, 0}, turns, Vec3{0, -6, 12}},
              {"RightUpLeg", 0, {-10, -5, 0}, turns, {}},
              {"RightLeg", 4, {0, -42, 0}, turns, {}},
              {"RightFoot", 5, {0, -42, 0}, turns, Vec3{0, -6, 12}},
              {"Spine", 0, {0, 20, 0}, turns, {}},
              {"LeftArm", 7, {18, 30, 0}, turns, {}},
              {"LeftForeArm", 8, {28, 0, 0}, turns, {}},
              {"LeftHand", 9, {25, 0, 0}, turns, Vec3{15, 0, 0}},
              {"RightArm", 7, {-18, 30, 0}, turns, {}},
              {"RightForeArm", 11, {-28, 0, 0}, turns, {}},
              {"RightHand", 12, {-25, 0, 0}, turns, Vec3{-15, 0, 0}},
              {"Head", 7, {0, 35, 0}, turns, Vec3{0, 20, 0}}};
  return s;
}

/// Raises the straight arms of a frame to `degrees` from hanging.
inline void set_arms(Motion& motion, std::size_t frame, double degrees_raised) {
  // At rest the arms point sideways, 90 degrees from hanging.
  for (const auto& [name, sign] : {std::pair{"LeftArm", 1.0}, {"RightArm", -1.0}})
    motion.rotation(frame, static_cast<std::size_t>(motion.skeleton.find(name))) =
        axis_rotation(2, sign * radians(degrees_raised - 90));
}

/// A body that walks along z and swings its legs, at 30 frames per second; arms hang.
inline Motion standing_body(std::size_t frames, double step = 2) {
  Motion m;
  m.skeleton = body_skeleton();
  m.rate = 30;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f);
    for (const Joint& joint : m.skeleton.joints) {
      m.positions.push_back(joint.offset);
      m.rotations.emplace_back();
    }
    m.position(f, 0)[2] = step * t;
    for (const std::size_t leg : {std::size_t{1}, std::size_t{4}})
      m.rotation(f, leg) = axis_rotation(0, (leg == 1 ? 0.4 : -0.4) * std::sin(0.2 * t));
    set_arms(m, f, 10);
  }
  return m;
}

/// The same motion with every joint's own axes turned: positions in the world are unchanged, the rest pose
/// becomes one that no body takes.
inline Motion with_turned_axes(Motion motion) {
  const std::size_t joints = motion.skeleton.size();
  std::vector<Quat> turns;
  for (std::size_t j = 0; j < joints; ++j)
    turns.push_back(quat_from_expmap({1.1, 0.7 * static_cast<double>(j % 3), j % 2 == 0 ? 0.9 : -0.8}));
  const auto above = [&](std::size_t j) {
    const int parent = motion.skeleton.joints[j].parent;
    return parent < 0 ? Quat{} : inverse(turns[static_cast<std::size_t>(parent)]);
  };
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = motion.skeleton.joints[j];
    joint.offset = rotate(above(j), joint.offset);
    if (joint.end_site) joint.end_site = rotate(inverse(turns[j]), *joint.end_site);
    for (std::size_t f = 0; f < motion.frames; ++f) {
      motion.position(f, j) = rotate(above(j), motion.position(f, j));
      motion.rotation(f, j) = multiply(multiply(above(j), motion.rotation(f, j)), turns[j]);
    }
  }
  return motion;
}

/// Puts a frame before the motion: legs straight, arms straight and raised to `degrees` from hanging.
inline void prepend_arms(Motion& motion, double degrees_raised) {
  const std::vector<Quat> rest(motion.skeleton.size());
  const std::vector<Vec3> first(motion.positions.begin(),
                                motion.positions.begin() + static_cast<std::ptrdiff_t>(rest.size()));
  motion.rotations.insert(motion.rotations.begin(), rest.begin(), rest.end());
  motion.positions.insert(motion.positions.begin(), first.begin(), first.end());
  ++motion.frames;
  set_arms(motion, 0, degrees_raised);
}

/// The body as a z-up program stores it: the inverse of from_z_up but for the channels, written out.
inline Motion in_z_up(Motion m) {
  const auto turn = [](const Vec3& v) { return Vec3{v[0], -v[2], v[1]}; };
  for (Joint& joint : m.skeleton.joints) {
    joint.offset = turn(joint.offset);
    if (joint.end_site) joint.end_site = turn(*joint.end_site);
  }
  for (Vec3& p : m.positions) p = turn(p);
  for (Quat& q : m.rotations) q = {q.w, q.x, -q.z, q.y};
  return m;
}

}  // namespace motiongan::motion
