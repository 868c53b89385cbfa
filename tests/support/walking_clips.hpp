// Small clips for the tests of data sets.
#pragma once
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "motiongan/data/dataset.hpp"

namespace motiongan::motion {

/// A walk along x at `speed` units per second from (start, 1, 5) with a bobbing root; the arm swings about x.
inline Motion walk(double seconds, double rate, double speed, double start = 0) {
  Motion m;
  m.skeleton.joints = {
      {"Hips",
       -1,
       {0, 0, 0},
       {Channel::x_position, Channel::y_position, Channel::z_position, Channel::z_rotation,
        Channel::x_rotation, Channel::y_rotation},
       {}},
      {"Arm", 0, {1, 0, 0}, {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation}, Vec3{1, 0, 0}}};
  m.rate = rate;
  m.frames = static_cast<std::size_t>(std::lround(seconds * rate));
  for (std::size_t f = 0; f < m.frames; ++f) {
    const double t = static_cast<double>(f) / rate;
    m.rotations.insert(m.rotations.end(), {quat_from_expmap({0, 0.1 * std::sin(t), 0}),
                                           quat_from_expmap({0.7 * std::sin(5 * t + start), 0, 0})});
    m.positions.insert(m.positions.end(),
                       {Vec3{start + speed * t, 1 + 0.1 * std::sin(9 * t), 5}, Vec3{1, 0, 0}});
  }
  return m;
}

/// A walk along a curve at 10 Hz, leaning forward, starting at any place and heading.
inline Motion curved_walk(double heading, const Vec3& place, std::size_t frames) {
  Motion m;
  m.skeleton.joints = {{"Hips", -1, {}, {}, {}}, {"Spine", 0, {0, 1, 0}, {}, {}}};
  m.rate = 10;
  m.frames = frames;
  Vec3 at = place;
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = 0.1 * static_cast<double>(f), yaw = heading + 0.9 * t;
    m.rotations.push_back(multiply(axis_rotation(1, yaw), axis_rotation(0, 0.2 + 0.1 * std::sin(3 * t))));
    m.rotations.push_back(axis_rotation(2, 0.3 * std::cos(2 * t)));
    m.positions.push_back(at);
    m.positions.push_back({0, 1, 0});
    at = add(at, {0.1 * std::sin(yaw), 0.01 * std::cos(t), 0.1 * std::cos(yaw)});
  }
  return m;
}

/// The same with two legs that swing; which foot is the lower one changes.
inline Motion curved_walk_on_legs(double heading, const Vec3& place, std::size_t frames) {
  const Motion body = curved_walk(heading, place, frames);
  Motion m;
  m.skeleton = body.skeleton;
  m.skeleton.joints.insert(m.skeleton.joints.end(), {{"LeftLeg", 0, {0.1, -0.1, 0}, {}, {}},
                                                     {"LeftFoot", 2, {0, -0.9, 0.1}, {}, {}},
                                                     {"RightLeg", 0, {-0.1, -0.1, 0}, {}, {}},
                                                     {"RightFoot", 4, {0, -0.9, 0.1}, {}, {}}});
  m.rate = body.rate;
  m.frames = frames;
  for (std::size_t f = 0; f < frames; ++f) {
    const double swing = 0.5 * std::sin(0.7 * static_cast<double>(f));
    m.rotations.insert(m.rotations.end(), {body.rotation(f, 0), body.rotation(f, 1), axis_rotation(0, swing),
                                           Quat{}, axis_rotation(0, -swing), Quat{}});
    m.positions.push_back(body.position(f, 0));
    for (std::size_t j = 1; j < m.skeleton.size(); ++j) m.positions.push_back(m.skeleton.joints[j].offset);
  }
  return m;
}

inline std::vector<LabelledMotion> several(std::size_t count) {
  std::vector<LabelledMotion> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back({"clip" + std::to_string(i),
                   walk(4 + 0.1 * double(i), 60, 1 + double(i % 3), double(i)),
                   {"walk number " + std::to_string(i), "go"}});
  return out;
}

inline DatasetOptions eight_at(double rate) {
  DatasetOptions o;
  o.frames = 8;
  o.rate = rate;
  o.root_rotation = RootRotation::expmap;  // RootRotation::heading is tested in heading_test.cpp
  return o;
}

}  // namespace motiongan::motion
