// A tree of nodes with animations, as glTF and FBX files hold them, and the skeleton in it.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A node: scaled first, then turned, then moved, relative to its parent.
struct SceneNode {
  std::string name;
  int parent = -1;        ///< index of a node, in any order; -1: none
  Vec3 translation{};     ///< where it is
  Quat rotation{};        ///< how it is turned
  Vec3 scale{1, 1, 1};    ///< factors along its axes
  bool is_joint = false;  ///< of a skin
  bool is_thing = false;  ///< a mesh, camera or light
};

/// What of a node a track changes.
enum class TrackKind { translation, rotation };
/// How values between two keys are found, as in glTF.
enum class Between { linear, step, cubic };

/// How a property of a node changes. `values` are [keys, 3] or, for rotations, [keys, 4] as x, y, z, w; cubic
/// ones are [keys, 3, width]: tangent before, value, tangent after.
struct NodeTrack {
  std::size_t node = 0;  ///< index into NodeScene::nodes
  TrackKind kind = TrackKind::rotation;
  Between between = Between::linear;
  std::vector<double> times;  ///< [keys], seconds, increasing
  std::vector<double> values;
};

/// An animation of a scene: tracks that play together.
struct SceneAnimation {
  std::string name;
  double rate = 0;  ///< frames per second, if the file says so; 0: told by the times
  std::vector<NodeTrack> tracks;
};

/// y is up.
struct NodeScene {
  std::vector<SceneNode> nodes;
  std::vector<SceneAnimation> animations;
  double unit_metres = 1;          ///< metres per unit of length
  std::vector<std::string> notes;  ///< what was ignored, one sentence each
};

/// The skeleton of a scene. Its joints have the world's axes at rest, as those of BVH files, whatever axes
/// their nodes have.
struct SceneSkeleton {
  Skeleton skeleton;
  std::vector<std::size_t> nodes;  ///< [joints], the node of each
  std::vector<Quat> rest;          ///< [joints], world rotations of the nodes at rest
  std::vector<double> scales;      ///< [joints], size of a node's unit in that of the scene, at rest
};

namespace scene_detail {

/// Place, rotation and size of a node in the world.
struct Placed {
  Vec3 at{};
  Quat turn{};
  double size = 1;
};

/// `local` placed by its parent. Where a scale differs by axis, its mean is used.
inline Placed under(const Placed& parent, const Vec3& translation, const Quat& rotation,
                    const Vec3& scaling) {
  const double mean = std::cbrt(std::abs(scaling[0] * scaling[1] * scaling[2]));
  return {add(parent.at, rotate(parent.turn, scale(translation, parent.size))),
          normalize(multiply(parent.turn, rotation)), parent.size * mean};
}

/// Nodes with parents before children. Throws Error for a node that is below itself or below no node.
inline std::vector<std::size_t> parents_first(const NodeScene& scene, const std::string& where) {
  std::vector<std::vector<std::size_t>> below(scene.nodes.size());
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    const int parent = scene.nodes[n].parent;
    require(parent < static_cast<int>(scene.nodes.size()), where, ": node ", n, " is below node ", parent,
            ", but there are ", scene.nodes.size());
    if (parent < 0)
      order.push_back(n);
    else
      below[static_cast<std::size_t>(parent)].push_back(n);
  }
  for (std::size_t i = 0; i < order.size(); ++i)
    order.insert(order.end(), below[order[i]].begin(), below[order[i]].end());
  require(order.size() == scene.nodes.size(), where, ": ", scene.nodes.size() - order.size(),
          " nodes are below themselves");
  return order;
}

/// All nodes at rest, [nodes].
inline std::vector<Placed> at_rest(const NodeScene& scene, const std::vector<std::size_t>& order) {
  std::vector<Placed> out(scene.nodes.size());
  for (const std::size_t n : order) {
    const SceneNode& node = scene.nodes[n];
    out[n] = under(node.parent < 0 ? Placed{} : out[static_cast<std::size_t>(node.parent)], node.translation,
                   node.rotation, node.scale);
  }
  return out;
}

/// Which nodes are joints: those of skins, or else those that animations turn, or else all that are not
/// meshes, cameras or lights; the nodes between them; and what hangs from them, such as ends of bones.
/// `order` has parents before children.
inline std::vector<char> joints_of(const NodeScene& scene, const std::vector<std::size_t>& order,
                                   const std::string& where) {
  const std::vector<SceneNode>& nodes = scene.nodes;
  std::vector<char> seed(nodes.size(), 0);
  bool any = false;
  const auto mark = [&](std::size_t n) { seed[n] = 1, any = true; };
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].is_joint) mark(n);
  if (!any)
    for (const SceneAnimation& animation : scene.animations)
      for (const NodeTrack& track : animation.tracks)
        if (track.kind == TrackKind::rotation && !nodes[track.node].is_thing) mark(track.node);
  if (!any)
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (!nodes[n].is_thing) mark(n);
  require(any, where, " has no skeleton: no joints, and no nodes that move");

  std::vector<std::size_t> count(nodes.size(), 0);  // of joints at or below each node
  for (std::size_t i = order.size(); i-- > 0;) {    // children first
    const std::size_t n = order[i];
    count[n] += seed[n] != 0;
    if (nodes[n].parent >= 0) count[static_cast<std::size_t>(nodes[n].parent)] += count[n];
  }
  // Of several trees the one with the most joints, from the deepest node above all of them.
  std::size_t root = order.front();
  for (const std::size_t n : order)
    if (nodes[n].parent < 0 && count[n] > count[root]) root = n;
  for (const std::size_t n : order)
    if (seed[root] == 0 && nodes[n].parent == static_cast<int>(root) && count[n] == count[root]) root = n;
  std::vector<char> out(nodes.size(), 0), below(nodes.size(), 0);
  for (const std::size_t n : order) {
    const int parent = nodes[n].parent;
    below[n] = n == root || (parent >= 0 && below[static_cast<std::size_t>(parent)] != 0);
    out[n] =
        below[n] != 0 && (count[n] > 0 || (!nodes[n].is_thing && out[static_cast<std::size_t>(parent)] != 0));
  }
  return out;
}

}  // namespace scene_detail

/// The skeleton of a scene, of which `where` names the file. Joints are in depth-first order; the root has
/// position channels, the others only rotations. Throws Error if there is none.
inline SceneSkeleton skeleton_of(const NodeScene& scene, const std::string& where) {
  require(!scene.nodes.empty(), where, " has no nodes, and so no skeleton");
  const std::vector<std::size_t> order = scene_detail::parents_first(scene, where);
  const std::vector<scene_detail::Placed> rest = scene_detail::at_rest(scene, order);
  const std::vector<char> chosen = scene_detail::joints_of(scene, order, where);
  std::vector<std::vector<std::size_t>> below(scene.nodes.size());
  std::vector<std::size_t> open;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (chosen[n] == 0) continue;
    const int parent = scene.nodes[n].parent;
    if (parent >= 0 && chosen[static_cast<std::size_t>(parent)] != 0)
      below[static_cast<std::size_t>(parent)].push_back(n);
    else
      open.push_back(n);
  }
  SceneSkeleton out;
  std::vector<int> joint_at(scene.nodes.size(), -1);
  while (!open.empty()) {
    const std::size_t n = open.back();
    open.pop_back();
    open.insert(open.end(), below[n].rbegin(), below[n].rend());
    const SceneNode& node = scene.nodes[n];
    Joint joint;
    joint.name = node.name.empty() ? concat("node_", n) : node.name;
    const int parent = node.parent;
    joint.parent = parent < 0 ? -1 : joint_at[static_cast<std::size_t>(parent)];
    joint.offset =
        joint.parent < 0 ? rest[n].at : subtract(rest[n].at, rest[static_cast<std::size_t>(parent)].at);
    if (joint.parent < 0) joint.channels = {Channel::x_position, Channel::y_position, Channel::z_position};
    joint.channels.insert(joint.channels.end(),
                          {Channel::z_rotation, Channel::x_rotation, Channel::y_rotation});
    joint_at[n] = static_cast<int>(out.skeleton.size());
    out.skeleton.joints.push_back(std::move(joint));
    out.nodes.push_back(n);
    out.rest.push_back(rest[n].turn);
    out.scales.push_back(rest[n].size);
    require(out.skeleton.size() <= most_joints, where, " has more than ", most_joints, " joints");
  }
  return out;
}

}  // namespace motiongan::motion
