// Animations of a tree of nodes as motions, at a constant frame rate.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/formats/node_scene.hpp"

namespace motiongan::motion {

namespace scene_detail {

/// The value of a track at a time, held before its first key and after its last: [3], or [4] normalised.
inline std::array<double, 4> value_at(const NodeTrack& track, double time) {
  const std::size_t width = track.kind == TrackKind::rotation ? 4 : 3, keys = track.times.size();
  const bool cubic = track.between == Between::cubic;
  const std::size_t stride = cubic ? 3 * width : width, value = cubic ? width : 0;
  const auto after = static_cast<std::size_t>(std::upper_bound(track.times.begin(), track.times.end(), time) -
                                              track.times.begin());
  const std::size_t a = after == 0 ? 0 : after - 1, b = std::min(after, keys - 1);
  const double gap = track.times[b] - track.times[a];
  const double t =
      after == 0 || gap <= 0 || track.between == Between::step ? 0 : (time - track.times[a]) / gap;
  const double* const from = &track.values[a * stride + value];
  const double* const to = &track.values[b * stride + value];
  std::array<double, 4> out{};
  if (width == 4 && !cubic) {
    const Quat q = slerp(normalize(Quat{from[3], from[0], from[1], from[2]}),
                         normalize(Quat{to[3], to[0], to[1], to[2]}), t);
    return {q.x, q.y, q.z, q.w};
  }
  for (std::size_t i = 0; i < width; ++i) {
    if (cubic) {  // a Hermite spline, glTF 2.0, appendix C
      const double t2 = t * t, t3 = t2 * t, leaves = gap * from[width + i], arrives = gap * *(to + i - width);
      out[i] = (2 * t3 - 3 * t2 + 1) * from[i] + (t3 - 2 * t2 + t) * leaves + (3 * t2 - 2 * t3) * to[i] +
               (t3 - t2) * arrives;
    } else {
      out[i] = from[i] + t * (to[i] - from[i]);
    }
  }
  return out;
}

inline Quat quat_of(const std::array<double, 4>& v) { return normalize(Quat{v[3], v[0], v[1], v[2]}); }

/// Frames per second of an animation whose file does not say: by the shortest step between keys that is
/// usual in it, a whole number where it is near one. Keyframes that are seconds apart give 30.
inline double rate_of(const SceneAnimation& animation) {
  std::vector<double> steps;
  for (const NodeTrack& track : animation.tracks)
    for (std::size_t k = 1; k < track.times.size(); ++k) steps.push_back(track.times[k] - track.times[k - 1]);
  std::erase_if(steps, [](double s) { return s < 1e-3; });
  if (steps.empty()) return 30;
  const auto tenth = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 10);
  std::nth_element(steps.begin(), tenth, steps.end());
  const double rate = 1 / *tenth;
  if (rate < 9.5) return 30;
  return std::abs(rate - std::round(rate)) < 2e-3 * rate ? std::round(rate) : rate;
}

}  // namespace scene_detail

/// An animation as the motion of a skeleton of the scene, in the scene's unit. `rate` is in frames per
/// second; 0: the animation's own. Joints other than the root that move get position channels; scales that
/// change do not count. Throws Error, naming the file `where`, for an animation of more than 50 million joint
/// positions: its times are wrong.
inline Motion motion_of(const NodeScene& scene, const SceneSkeleton& skeleton,
                        const SceneAnimation& animation, double rate, const std::string& where) {
  namespace detail = scene_detail;
  Motion out;
  out.skeleton = skeleton.skeleton;
  out.rate = rate > 0 ? rate : animation.rate > 0 ? animation.rate : detail::rate_of(animation);
  double first = std::numeric_limits<double>::infinity(), last = -first;
  std::vector<const NodeTrack*> turns(scene.nodes.size()), moves(scene.nodes.size());
  for (const NodeTrack& track : animation.tracks) {
    (track.kind == TrackKind::rotation ? turns : moves)[track.node] = &track;
    first = std::min(first, track.times.front());
    last = std::max(last, track.times.back());
  }
  if (!(first <= last)) return out;  // nothing moves
  const double frames = std::floor((last - first) * out.rate + 1e-3) + 1;
  const double most = std::floor(5e7 / static_cast<double>(skeleton.nodes.size()));
  require(frames <= most, where, ": the animation '", animation.name, "' lasts ", last - first, " s, ",
          frames, " frames at ", out.rate, " per second, expected at most ", most,
          "; --fps gives another rate");
  out.frames = static_cast<std::size_t>(frames);

  const auto local = [&](std::size_t n, double time) {
    const SceneNode& node = scene.nodes[n];
    Vec3 at = node.translation;
    if (moves[n] != nullptr) {
      const std::array<double, 4> v = detail::value_at(*moves[n], time);
      at = {v[0], v[1], v[2]};
    }
    return std::pair{
        at, turns[n] != nullptr ? detail::quat_of(detail::value_at(*turns[n], time)) : node.rotation};
  };
  std::vector<std::size_t> above;  // the nodes above the root, from the top, which may move
  for (int n = scene.nodes[skeleton.nodes.front()].parent; n >= 0;
       n = scene.nodes[static_cast<std::size_t>(n)].parent)
    above.insert(above.begin(), static_cast<std::size_t>(n));
  const std::size_t joints = skeleton.nodes.size();
  out.rotations.reserve(out.frames * joints), out.positions.reserve(out.frames * joints);
  for (std::size_t f = 0; f < out.frames; ++f) {
    const double time = first + static_cast<double>(f) / out.rate;
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = out.skeleton.joints[j].parent;
      const auto [at, turn] = local(skeleton.nodes[j], time);
      if (parent < 0) {
        detail::Placed root;
        for (const std::size_t n : above) {
          const auto [there, turned] = local(n, time);
          root = detail::under(root, there, turned, scene.nodes[n].scale);
        }
        root = detail::under(root, at, turn, {1, 1, 1});
        out.positions.push_back(root.at);
        out.rotations.push_back(normalize(multiply(root.turn, inverse(skeleton.rest[j]))));
        continue;
      }
      const auto p = static_cast<std::size_t>(parent);
      const Quat& axes = skeleton.rest[p];
      out.positions.push_back(rotate(axes, scale(at, skeleton.scales[p])));
      out.rotations.push_back(normalize(multiply(multiply(axes, turn), inverse(skeleton.rest[j]))));
    }
  }
  double size = 0;
  for (const Joint& joint : out.skeleton.joints) size += joint.parent < 0 ? 0 : length(joint.offset);
  for (std::size_t j = 0; j < joints; ++j) {
    Joint& joint = out.skeleton.joints[j];
    if (joint.parent < 0) continue;
    bool moving = false;
    for (std::size_t f = 0; f < out.frames; ++f)
      moving = moving || length(subtract(out.position(f, j), joint.offset)) > 1e-4 * size;
    if (moving)
      joint.channels.insert(joint.channels.begin(),
                            {Channel::x_position, Channel::y_position, Channel::z_position});
    else  // rounded in the file
      for (std::size_t f = 0; f < out.frames; ++f) out.position(f, j) = joint.offset;
  }
  return out;
}

}  // namespace motiongan::motion
