// The stick figure that the player and the pose strip draw: points and bones, size, floor height and heading.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/body_side.hpp"
#include "motiongan/motion/kinematics.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::view {

/// What a motion was asked for, in its world: drawn beside it.
struct Marks {
  /// A point, and when a joint should be there.
  struct Target {
    motion::Vec3 place{};     ///< in the world
    double from = 0, to = 0;  ///< seconds
  };
  std::vector<motion::Vec3> path = {};      ///< over the ground; heights do not count
  std::vector<Target> targets = {};         ///< points that a joint should be at
  std::vector<motion::Motion> ghosts = {};  ///< poses, one frame each, of the motion's skeleton
};

/// A motion and its caption.
struct ViewedMotion {
  std::string title;  ///< UTF-8
  motion::Motion motion;
  std::size_t seed_frames = 0;  ///< number of given frames at the start, drawn in grey
  Marks marks = {};             ///< what it was asked for
};

using motion::Side;
using motion::side_of;

/// A motion as points and bones. A joint that always coincides with its parent is merged with it.
struct Figure {
  double rate = 0;  ///< frames per second
  std::size_t frames = 0;
  std::vector<int> parents;  ///< [nodes], parent node; -1 for the first node, the root
  std::vector<Side> sides;   ///< [nodes], side of the bone that ends in the node
  std::vector<char> heads;   ///< [nodes], 1: the bone that ends in the node is the head, 2: the head sits on
                             ///< the node, 0: neither
  std::vector<motion::Vec3> points;  ///< [frames, nodes], world space, y up, in the file's unit
  double height = 1;                 ///< approximate standing height, in the file's unit
  double floor = 0;                  ///< height of the floor, in the file's unit
  double heading = 0;                ///< rotation about y from facing +z, radians

  std::size_t nodes() const { return parents.size(); }
  const motion::Vec3& point(std::size_t frame, std::size_t node) const {
    return points[frame * nodes() + node];
  }
};

namespace detail {

/// The topmost joint to draw: joints above it form a static handle ("joint_Root"), not a bone.
inline std::size_t first_drawn_joint(const motion::Motion& m) {
  const auto below = motion::children(m.skeleton);
  const auto rests = [&](std::size_t j) {
    for (std::size_t f = 1; f < m.frames; ++f)
      if (m.rotation(f, j) != m.rotation(0, j)) return false;
    return !motion::has_moving_track(m, j);
  };
  std::size_t j = 0;
  // In a single frame every joint is static, which proves nothing.
  while (m.frames > 1 && below[j].size() == 1 && rests(j)) j = below[j].front();
  return below[j].empty() ? 0 : j;
}

/// Approximate standing height: for people, the longest path from the hips to an end effector (hand or toe)
/// is about three quarters of it.
inline double standing_height(const motion::Skeleton& skeleton, std::size_t first) {
  std::vector<double> reach(skeleton.size(), 0);
  double longest = 0;
  for (std::size_t j = first; j < skeleton.size(); ++j) {
    const motion::Joint& joint = skeleton.joints[j];
    if (j > first && joint.parent >= static_cast<int>(first))
      reach[j] = reach[static_cast<std::size_t>(joint.parent)] + motion::length(joint.offset);
    longest = std::max(longest, reach[j] + (joint.end_site ? motion::length(*joint.end_site) : 0));
  }
  return longest > 0 ? 1.3 * longest : 1;
}

/// The largest coordinate that is drawn: pages compute in single precision.
inline double furthest_drawn(double height) { return std::min(1e7 * height, 1e12); }

/// Mean heading of the figure over its first `frames` frames, from its first left and right nodes; 0 if it
/// has no sides.
inline double mean_heading(const Figure& figure, std::size_t frames) {
  std::size_t left = 0, right = 0;
  for (std::size_t n = figure.nodes(); n-- > 1;) {
    if (figure.sides[n] == Side::left) left = n;
    if (figure.sides[n] == Side::right) right = n;
  }
  if (left == 0 || right == 0) return 0;
  double sine = 0, cosine = 0, first = 0;
  for (std::size_t f = 0; f < frames; ++f) {
    const motion::Vec3 across = motion::subtract(figure.point(f, left), figure.point(f, right));
    const double angle = std::atan2(-across[2], across[0]);  // forward = across x up
    if (f == 0) first = angle;
    sine += std::sin(angle);
    cosine += std::cos(angle);
  }
  // A figure that keeps turning has no mean heading: use the first frame's.
  const bool turns = std::hypot(sine, cosine) < 0.3 * static_cast<double>(frames);
  return turns ? first : std::atan2(sine, cosine);
}

/// Height of the floor: the 5th percentile of the frames' lowest points, which is robust to a few bad frames.
inline double ground(const Figure& figure) {
  std::vector<double> lowest(figure.frames, 0);
  for (std::size_t f = 0; f < figure.frames; ++f) {
    lowest[f] = figure.point(f, 0)[1];
    for (std::size_t n = 1; n < figure.nodes(); ++n) lowest[f] = std::min(lowest[f], figure.point(f, n)[1]);
  }
  const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(figure.frames / 20);
  std::nth_element(lowest.begin(), at, lowest.end());
  return *at;
}

}  // namespace detail

/// The points and bones of a motion. Throws Error for a motion without frames or joints, or with a position
/// that is not finite or too far away to be drawn.
inline Figure make_figure(const ViewedMotion& viewed) {
  const motion::Motion& m = viewed.motion;
  const std::size_t joints = m.skeleton.size();
  require(m.frames > 0 && joints > 0, "the motion '", viewed.title, "' has ", m.frames, " frames and ",
          joints, " joints; there is nothing to show");
  const motion::GlobalPose global = motion::forward_kinematics(m);
  const std::vector<std::size_t> ends = motion::end_site_joints(m.skeleton);
  const std::vector<motion::Vec3> tips = motion::end_site_positions(m, global);
  const auto below = motion::children(m.skeleton);
  const std::size_t first = detail::first_drawn_joint(m);

  Figure out;
  out.rate = m.rate;
  out.frames = m.frames;
  out.height = detail::standing_height(m.skeleton, first);
  const double tiny = 1e-6 * out.height;
  const auto is_head = [](std::string_view name) {
    return name.find("Head") != std::string_view::npos || name.find("head") != std::string_view::npos;
  };

  // The source of each node's points: (false, joint) or (true, end site).
  std::vector<std::pair<bool, std::size_t>> sources;
  std::vector<int> node_of(joints, -1);  // [joints], -1 above the first drawn joint
  for (std::size_t j = first, tip = 0; j < joints; ++j) {
    const motion::Joint& joint = m.skeleton.joints[j];
    const int parent = j == first ? -1 : node_of[static_cast<std::size_t>(joint.parent)];
    const bool has_tip = joint.end_site && motion::length(*joint.end_site) > tiny;
    bool apart = j == first;
    for (std::size_t f = 0; f < m.frames && !apart; ++f) apart = motion::length(m.position(f, j)) > tiny;
    node_of[j] = apart ? static_cast<int>(sources.size()) : parent;
    if (apart) {
      sources.emplace_back(false, j);
      out.parents.push_back(parent);
      out.sides.push_back(side_of(joint.name));
      out.heads.push_back(is_head(joint.name) && below[j].empty() && !has_tip ? 2 : 0);
    }
    while (tip < ends.size() && ends[tip] < j) ++tip;
    if (has_tip) {
      sources.emplace_back(true, tip);
      out.parents.push_back(node_of[j]);
      out.sides.push_back(side_of(joint.name));
      out.heads.push_back(is_head(joint.name) ? 1 : 0);
    }
  }

  const double furthest = detail::furthest_drawn(out.height);
  out.points.reserve(m.frames * sources.size());
  for (std::size_t f = 0; f < m.frames; ++f) {
    for (const auto& [is_tip, index] : sources) {
      const motion::Vec3& p = is_tip ? tips[f * ends.size() + index] : global.positions[f * joints + index];
      require(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]), "the motion '", viewed.title,
              "' has a position that is not a finite number in frame ", f, "; it cannot be drawn");
      for (const double x : p)
        require(std::abs(x) <= furthest, "the motion '", viewed.title, "' has a position of ", x,
                " in frame ", f, ", expected at most ", furthest,
                " (10 million times the body's height); it cannot be drawn: check the file's root positions");
      out.points.push_back(p);
    }
  }
  out.floor = detail::ground(out);
  // Motions with the same seed frames are viewed from the same side, whatever they do afterwards.
  const bool seeded = viewed.seed_frames > 0;
  out.heading = detail::mean_heading(out, seeded ? std::min(viewed.seed_frames, out.frames) : out.frames);
  return out;
}

}  // namespace motiongan::view
