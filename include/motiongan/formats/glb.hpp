// Writing glTF 2.0 binaries (GLB): skeletons, their animations and a simple body.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/capsule_body.hpp"
#include "motiongan/formats/glb_document.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/kinematics.hpp"

namespace motiongan::motion {

/// A motion and the name of its animation.
struct NamedMotion {
  std::string name;
  Motion motion;
};

/// Metres from the hips to the toes of a grown person along the bones, as body_unit() measures it: CMU's
/// subjects have 1.1.
inline constexpr double typical_leg = 1.05;

/// Options of GLB files that are written.
struct GlbOptions {
  double unit_metres = 0;  ///< metres per unit of the motions; 0: unknown, the legs become typical_leg
  bool body = true;        ///< a body of capsules, skinned to the joints, so that viewers show something
};

/// Metres per unit of a motion that is written in metres.
inline double metres_per_unit(const Skeleton& skeleton, const GlbOptions& options) {
  const double leg = body_unit(skeleton);
  return options.unit_metres > 0 ? options.unit_metres : leg > 0 ? typical_leg / leg : 1;
}

/// Throws Error if the motion has no frames, a skeleton without joints or a value that is not finite.
inline void check_writable(const NamedMotion& named) {
  const Motion& motion = named.motion;
  check_motion(motion);
  require(motion.frames > 0 && motion.skeleton.size() > 0, "'", named.name,
          "' has no frames or no joints and cannot be written");
  for (const Vec3& p : motion.positions)
    require(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]), "'", named.name,
            "' has a position that is not a finite number");
}

namespace glb_detail {

inline void append(std::vector<float>& out, const Vec3& v) {
  for (const double x : v) out.push_back(static_cast<float>(x));
}

/// A skeleton's nodes in a document.
struct Nodes {
  std::vector<std::size_t> of_joint;  ///< [joints]
  double scale = 1;                   ///< metres per unit
};

/// Adds a skeleton at rest under a node of its own, and its body.
inline Nodes add_skeleton(Document& document, const Skeleton& skeleton, const GlbOptions& options,
                          const std::string& name) {
  Nodes out;
  out.scale = metres_per_unit(skeleton, options);
  const std::size_t top = document.push("nodes", {{"name", name}});
  const std::size_t first = top + 1;
  out.of_joint.resize(skeleton.size());
  std::iota(out.of_joint.begin(), out.of_joint.end(), first);
  std::vector<nlohmann::json> below(skeleton.size(), nlohmann::json::array());
  for (std::size_t j = 1; j < skeleton.size(); ++j)
    below[static_cast<std::size_t>(skeleton.joints[j].parent)].push_back(first + j);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Vec3 offset = scale(skeleton.joints[j].offset, out.scale);
    nlohmann::json node = {{"name", skeleton.joints[j].name},
                           {"translation", {offset[0], offset[1], offset[2]}}};
    if (!below[j].empty()) node["children"] = below[j];
    document.push("nodes", std::move(node));
  }
  nlohmann::json parts = {first};
  if (options.body) {
    const CapsuleBody body = capsule_body(skeleton, out.scale);
    nlohmann::json joints = nlohmann::json::array();
    std::vector<float> to_joint;  // inverse bind matrices, column by column
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      joints.push_back(first + j);
      const Vec3& at = body.rest[j];
      for (const double v :
           {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -at[0], -at[1], -at[2], 1.0})
        to_joint.push_back(static_cast<float>(v));
    }
    constexpr int vertices = 34962, triangles = 34963;  // glTF's kinds of buffer views
    const std::size_t skin =
        document.push("skins", {{"joints", joints},
                                {"skeleton", first},
                                {"inverseBindMatrices", document.add(to_joint, "MAT4", 16)}});
    const nlohmann::json attributes = {{"POSITION", document.add(body.positions, "VEC3", 3, true, vertices)},
                                       {"NORMAL", document.add(body.normals, "VEC3", 3, false, vertices)},
                                       {"JOINTS_0", document.add(body.joints, "VEC4", 4, false, vertices)},
                                       {"WEIGHTS_0", document.add(body.weights, "VEC4", 4, false, vertices)}};
    if (document["materials"].is_null())
      document.push("materials", {{"name", "body"},
                                  {"pbrMetallicRoughness",
                                   {{"baseColorFactor", {0.55, 0.62, 0.7, 1.0}},
                                    {"metallicFactor", 0.0},
                                    {"roughnessFactor", 0.8}}}});
    const std::size_t mesh =
        document.push("meshes", {{"name", name + " body"},
                                 {"primitives",
                                  {{{"attributes", attributes},
                                    {"indices", document.add(body.triangles, "SCALAR", 1, false, triangles)},
                                    {"material", 0}}}}});
    parts.push_back(document.push("nodes", {{"name", name + " body"}, {"mesh", mesh}, {"skin", skin}}));
  }
  document["nodes"][top]["children"] = parts;
  document["scenes"][0]["nodes"].push_back(top);
  return out;
}

/// Adds a motion as an animation of a skeleton's nodes: rotations of joints that turn, positions of those
/// that move.
inline void add_animation(Document& document, const NamedMotion& named, const Nodes& nodes) {
  const Motion& motion = named.motion;
  const std::size_t joints = motion.skeleton.size();
  std::vector<float> times;
  for (std::size_t f = 0; f < motion.frames; ++f)
    times.push_back(static_cast<float>(static_cast<double>(f) / motion.rate));
  const std::size_t input = document.add(times, "SCALAR", 1, true);
  nlohmann::json samplers = nlohmann::json::array(), channels = nlohmann::json::array();
  const auto channel = [&](std::size_t joint, const char* path, std::size_t output) {
    channels.push_back(
        {{"sampler", samplers.size()}, {"target", {{"node", nodes.of_joint[joint]}, {"path", path}}}});
    samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
  };
  for (std::size_t j = 0; j < joints; ++j) {
    std::vector<float> turns, places;
    bool moves = false;
    Quat before{};
    for (std::size_t f = 0; f < motion.frames; ++f) {
      Quat q = normalize(motion.rotation(f, j));
      if (dot(q, before) < 0) q = {-q.w, -q.x, -q.y, -q.z};  // linear interpolation takes the short way
      before = q;
      for (const double v : {q.x, q.y, q.z, q.w}) turns.push_back(static_cast<float>(v));
      append(places, scale(motion.position(f, j), nodes.scale));
      moves = moves || length(subtract(motion.position(f, j), motion.skeleton.joints[j].offset)) >
                           1e-6 * (1 + length(motion.skeleton.joints[j].offset));
    }
    channel(j, "rotation", document.add(turns, "VEC4", 4));
    if (moves) channel(j, "translation", document.add(places, "VEC3", 3));
  }
  document.push("animations", {{"name", named.name}, {"channels", channels}, {"samplers", samplers}});
}

}  // namespace glb_detail

/// The bytes of a GLB file with the motions as animations, in metres, y up. Motions of equal skeletons share
/// their nodes. Throws Error if there are no motions, or if one has no frames, a skeleton without joints or a
/// value that is not finite.
inline std::string glb_file(std::span<const NamedMotion> motions, const GlbOptions& options = {}) {
  require(!motions.empty(), "there are no motions to write");
  glb_detail::Document document;
  std::vector<std::pair<const Skeleton*, glb_detail::Nodes>> skeletons;
  for (const NamedMotion& named : motions) {
    check_writable(named);
    const Motion& motion = named.motion;
    auto at = std::find_if(skeletons.begin(), skeletons.end(),
                           [&](const auto& known) { return *known.first == motion.skeleton; });
    if (at == skeletons.end()) {
      const std::string name = skeletons.empty() ? "skeleton" : concat("skeleton ", skeletons.size() + 1);
      skeletons.emplace_back(&motion.skeleton,
                             glb_detail::add_skeleton(document, motion.skeleton, options, name));
      at = skeletons.end() - 1;
    }
    glb_detail::add_animation(document, named, at->second);
  }
  return document.file();
}

/// Writes glb_file() to `path`, replacing it at once. Throws Error as that does, or if the file cannot be
/// written.
inline void write_glb(const std::filesystem::path& path, std::span<const NamedMotion> motions,
                      const GlbOptions& options = {}) {
  io::AtomicFile file(path);
  file.write(glb_file(motions, options));
  file.commit();
}

}  // namespace motiongan::motion
