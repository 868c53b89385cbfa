// Files of nodes and animations (GLB, VRM, VRMA; others where a program reads them) as clips.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/clip_files.hpp"
#include "motiongan/formats/glb_reader.hpp"
#include "motiongan/formats/scene_motion.hpp"

namespace motiongan::motion {

/// Reads a file of nodes and animations; throws Error if it cannot.
using SceneReader = NodeScene (*)(const std::filesystem::path& file);

/// The readers of such files, by extension. A program may add some before it reads files; the motiongan
/// command adds ".fbx" where it is built with Assimp.
inline std::map<std::string, SceneReader, std::less<>>& scene_readers() {
  static std::map<std::string, SceneReader, std::less<>> readers{
      {".glb", read_glb}, {".vrm", read_glb}, {".vrma", read_glb}};
  return readers;
}

/// Whether a file holds nodes and animations, by its extension.
inline bool holds_scene(const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
  return extension == ".fbx" || scene_readers().contains(extension);
}

/// Reads such a file; `file` may name an animation in it, see ClipPath. Throws Error if it cannot be read.
inline NodeScene read_scene(const std::filesystem::path& file) {
  const auto reader = scene_readers().find(extension_of(file));
  require(reader != scene_readers().end(), file.string(),
          ": this program reads no FBX files; build the motiongan command where libassimp-dev is installed, "
          "or save the file as GLB (.glb)");
  return reader->second(ClipPath(file).file);
}

/// What an animation is called in a ClipPath: by its name, without slashes, or by its number from 1 if it has
/// none or shares it.
inline std::string animation_label(const NodeScene& scene, std::size_t animation) {
  const std::string& name = scene.animations[animation].name;
  std::size_t uses = 0;
  for (const SceneAnimation& other : scene.animations) uses += other.name == name;
  if (name.empty() || uses > 1) return concat(animation + 1);
  std::string out = name;
  for (char& c : out) c = c == '/' || c == '\\' || c == '.' ? '_' : c;
  return out;
}

/// The animation that a path names: by its label, its name or its number from 1; without a name the first.
/// Throws Error, naming those that there are, for another one.
inline std::size_t find_animation(const NodeScene& scene, const std::filesystem::path& path) {
  const std::string wanted = ClipPath(path).animation;
  if (wanted.empty()) return 0;
  std::string known;
  for (std::size_t a = 0; a < scene.animations.size(); ++a) {
    const std::string label = animation_label(scene, a);
    if (wanted == label || wanted == scene.animations[a].name || wanted == concat(a + 1)) return a;
    if (a < 20) known += concat(a == 0 ? "" : ", ", "'", label, "'");
  }
  throw Error(path.string(), ": there is no animation '", wanted, "' in the file",
              known.empty() ? std::string(", which has none") : concat("; it has ", known));
}

/// The clips in a file of nodes and animations: the file itself if it has one animation, none if it has none,
/// or else a ClipPath for each. Throws Error if it cannot be read.
inline std::vector<std::filesystem::path> clips_of_scene(const std::filesystem::path& file) {
  const NodeScene scene = read_scene(file);
  if (scene.animations.size() < 2) return std::vector<std::filesystem::path>(scene.animations.size(), file);
  std::vector<std::filesystem::path> out;
  for (std::size_t a = 0; a < scene.animations.size(); ++a) {
    out.push_back(file);
    out.back() += "#" + animation_label(scene, a);
  }
  return out;
}

/// The motion of a clip in such a file, y up, in the scene's unit, which goes to `unit_metres`. `rate` is in
/// frames per second; 0: the animation's own. A file without animations gives a motion without frames. Adds
/// to `notes` what was ignored. Throws Error if the file cannot be read or has no skeleton.
inline Motion read_scene_motion(const std::filesystem::path& path, double rate, double& unit_metres,
                                std::vector<std::string>& notes) {
  const NodeScene scene = read_scene(path);
  const SceneSkeleton skeleton = skeleton_of(scene, path.string());
  notes.insert(notes.end(), scene.notes.begin(), scene.notes.end());
  unit_metres = scene.unit_metres;
  const std::size_t animation = find_animation(scene, path);
  if (scene.animations.empty()) {
    Motion still;
    still.skeleton = skeleton.skeleton;
    still.rate = 30;
    return still;
  }
  if (ClipPath(path).animation.empty() && scene.animations.size() > 1)
    notes.push_back(concat(path.string(), " has ", scene.animations.size(), " animations; the first, '",
                           animation_label(scene, 0), "', is read; ", path.string(), "#",
                           animation_label(scene, 1), " names another"));
  return motion_of(scene, skeleton, scene.animations[animation], rate, path.string());
}

}  // namespace motiongan::motion
