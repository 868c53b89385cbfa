// A small body for the view tests: static handle, hips, spine with a head, two legs, a coincident joint.
#pragma once
#include <cmath>
#include <string>

#include "motiongan/view/figure.hpp"

namespace motiongan::test {

/// A body of 8 joints that walks along +x, facing +x and rotating its right leg.
inline view::ViewedMotion walker(std::size_t frames, double rate = 30, std::string title = "walk",
                                 std::size_t seed_frames = 0) {
  using motion::Joint;
  view::ViewedMotion out;
  out.title = std::move(title);
  out.seed_frames = seed_frames;
  auto& joints = out.motion.skeleton.joints;
  const auto add = [&](const char* name, int parent, motion::Vec3 offset) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.offset = offset;
    joints.push_back(joint);
  };
  add("handle", -1, {0, 0, 0});
  add("Hips", 0, {0, 90, 0});
  add("LowerBack", 1, {0, 0, 0});  // coincides with the hips
  add("Head", 2, {0, 60, 0});
  add("LeftUpLeg", 1, {10, -5, 0});
  add("LeftFoot", 4, {0, -80, 0});
  add("RightUpLeg", 1, {-10, -5, 0});
  add("RightFoot", 6, {0, -80, 0});
  joints[3].end_site = motion::Vec3{0, 20, 0};
  joints[5].end_site = motion::Vec3{0, 0, 15};
  joints[7].end_site = motion::Vec3{0, 0, 15};
  out.motion.rate = rate;
  out.motion.frames = frames;
  const double half = std::acos(0.0) / 2;  // +90 degrees about y: facing +x
  for (std::size_t f = 0; f < frames; ++f) {
    const double swing = 0.2 * std::sin(0.4 * static_cast<double>(f));
    for (std::size_t j = 0; j < joints.size(); ++j) {
      out.motion.rotations.push_back(j == 1   ? motion::Quat{std::cos(half), 0, std::sin(half), 0}
                                     : j == 6 ? motion::Quat{std::cos(swing), std::sin(swing), 0, 0}
                                              : motion::Quat{});
      out.motion.positions.push_back(joints[j].offset);
    }
    out.motion.position(f, 1)[0] += 4.0 * static_cast<double>(f);
  }
  return out;
}

}  // namespace motiongan::test
