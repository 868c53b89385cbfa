// A character in a GLB file: motion for its skeleton, and the file again with that motion.
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/formats/glb.hpp"
#include "motiongan/formats/glb_reader.hpp"
#include "motiongan/formats/scene_motion.hpp"

namespace motiongan::motion {

/// The skeleton of a GLB or VRM file, with the mesh and materials that hang from it. Motion that a Retargeter
/// put on it can be written into the file, for its own joints with their own axes.
class GlbCharacter {
 public:
  /// Throws Error if the file cannot be read or has no skeleton.
  explicit GlbCharacter(const std::filesystem::path& path)
      : name_(path.string()),
        parts_(parse_glb(read_text(path, "GLB file"), name_)),
        scene_(scene_of(parts_, name_)),
        skeleton_(skeleton_of(scene_, name_)) {
    const std::vector<std::size_t> order = scene_detail::parents_first(scene_, name_);
    const int above = scene_.nodes[skeleton_.nodes.front()].parent;
    if (above >= 0) base_ = scene_detail::at_rest(scene_, order)[static_cast<std::size_t>(above)];
  }

  /// The skeleton with the motion of the file's first animation, if it has one; in metres, y up.
  Motion motion() const {
    if (!scene_.animations.empty()) {
      Motion moving = motion_of(scene_, skeleton_, scene_.animations.front(), 0, name_);
      moving.skeleton = skeleton_.skeleton;
      if (moving.frames > 0) return moving;
    }
    Motion still;
    still.skeleton = skeleton_.skeleton;
    still.rate = 30;
    return still;
  }

  /// The bytes of the file with these motions, of its skeleton, as its only animations. Throws Error if there
  /// are none, or for a motion without frames or of another skeleton.
  std::string file(std::span<const NamedMotion> motions) const {
    require(!motions.empty(), "there are no motions to write");
    glb_detail::Document document(parts_);
    document["animations"] = nlohmann::json::array();
    for (const std::size_t n : skeleton_.nodes) use_channels(document["nodes"][n], scene_.nodes[n]);
    for (const NamedMotion& named : motions) {
      check_writable(named);
      require(named.motion.skeleton.size() == skeleton_.nodes.size(), "'", named.name, "' has ",
              named.motion.skeleton.size(), " joints, expected the ", skeleton_.nodes.size(), " of ", name_);
      glb_detail::add_animation(document, {named.name, of_nodes(named.motion)}, {skeleton_.nodes, 1});
    }
    return document.file();
  }

 private:
  /// A node that moves has a translation and a rotation rather than a matrix.
  static void use_channels(nlohmann::json& node, const SceneNode& at) {
    if (node.erase("matrix") == 0) return;
    node["translation"] = at.translation, node["scale"] = at.scale;
    node["rotation"] = {at.rotation.x, at.rotation.y, at.rotation.z, at.rotation.w};
  }

  /// The motion relative to the nodes' parents, along their axes.
  Motion of_nodes(Motion motion) const {
    const std::size_t joints = skeleton_.nodes.size();
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = skeleton_.skeleton.joints[j].parent;
      const auto p = static_cast<std::size_t>(std::max(parent, 0));
      const Quat turn = inverse(parent < 0 ? base_.turn : skeleton_.rest[p]);
      const double size = 1 / (parent < 0 ? base_.size : skeleton_.scales[p]);
      require(std::isfinite(size), name_, ": joint '", motion.skeleton.joints[j].name,
              "' is below a node whose scale is 0, and cannot be moved");
      const Vec3 from = parent < 0 ? base_.at : Vec3{};
      for (std::size_t f = 0; f < motion.frames; ++f) {
        motion.position(f, j) = scale(rotate(turn, subtract(motion.position(f, j), from)), size);
        motion.rotation(f, j) = multiply(multiply(turn, motion.rotation(f, j)), skeleton_.rest[j]);
      }
      motion.skeleton.joints[j].offset = scene_.nodes[skeleton_.nodes[j]].translation;
    }
    return motion;
  }

  std::string name_;
  GlbParts parts_;
  NodeScene scene_;
  SceneSkeleton skeleton_;
  scene_detail::Placed base_;  ///< what the root hangs from
};

}  // namespace motiongan::motion
