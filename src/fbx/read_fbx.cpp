// Reading FBX files through Assimp: nodes, joints and animations.
#if MOTIONGAN_WITH_ASSIMP
#include <assimp/config.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <set>

#include "fbx/fbx.hpp"
#include "motiongan/formats/scene_files.hpp"

namespace motiongan::command {
namespace {

motion::Vec3 vec3(const aiVector3D& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

/// Adds a node and those below it, parents first.
void add_node(const aiNode& from, int parent, const std::set<std::string>& joints,
              const std::set<std::string>& things, motion::NodeScene& scene) {
  aiVector3D scaling, place;
  aiQuaternion turn;
  from.mTransformation.Decompose(scaling, turn, place);
  motion::SceneNode node;
  node.name = from.mName.C_Str();
  node.parent = parent;
  node.translation = vec3(place), node.scale = vec3(scaling);
  node.rotation = motion::normalize({turn.w, turn.x, turn.y, turn.z});
  node.is_joint = joints.contains(node.name);
  node.is_thing = from.mNumMeshes > 0 || things.contains(node.name);
  const auto own = static_cast<int>(scene.nodes.size());
  scene.nodes.push_back(std::move(node));
  for (unsigned i = 0; i < from.mNumChildren; ++i) add_node(*from.mChildren[i], own, joints, things, scene);
}

motion::SceneAnimation animation_of(const aiAnimation& from, const motion::NodeScene& scene) {
  motion::SceneAnimation out{from.mName.C_Str(), 0, {}};
  const double tick = 1 / (from.mTicksPerSecond > 0 ? from.mTicksPerSecond : 25);
  for (unsigned c = 0; c < from.mNumChannels; ++c) {
    const aiNodeAnim& channel = *from.mChannels[c];
    const auto node = std::find_if(scene.nodes.begin(), scene.nodes.end(), [&](const motion::SceneNode& n) {
      return n.name == channel.mNodeName.C_Str();
    });
    if (node == scene.nodes.end()) continue;
    motion::NodeTrack turns, moves;
    turns.node = moves.node = static_cast<std::size_t>(node - scene.nodes.begin());
    moves.kind = motion::TrackKind::translation;
    for (unsigned k = 0; k < channel.mNumRotationKeys; ++k) {
      const aiQuatKey& key = channel.mRotationKeys[k];
      turns.times.push_back(key.mTime * tick);
      for (const ai_real v : {key.mValue.x, key.mValue.y, key.mValue.z, key.mValue.w})
        turns.values.push_back(static_cast<double>(v));
    }
    for (unsigned k = 0; k < channel.mNumPositionKeys; ++k) {
      const aiVectorKey& key = channel.mPositionKeys[k];
      moves.times.push_back(key.mTime * tick);
      const motion::Vec3 at = vec3(key.mValue);
      moves.values.insert(moves.values.end(), at.begin(), at.end());
    }
    for (motion::NodeTrack* track : {&turns, &moves})
      if (!track->times.empty()) out.tracks.push_back(std::move(*track));
  }
  return out;
}

motion::NodeScene read_fbx(const std::filesystem::path& file) {
  motion::require_regular_file(file, "FBX file");
  Assimp::Importer importer;
  // Pivots are folded into their nodes, rather than kept as nodes of their own.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  const aiScene* const from = importer.ReadFile(file.string(), 0);
  require(from != nullptr && from->mRootNode != nullptr, file.string(),
          " cannot be read as FBX: ", importer.GetErrorString());
  motion::NodeScene out;
  std::set<std::string> joints, things;
  for (unsigned m = 0; m < from->mNumMeshes; ++m)
    for (unsigned b = 0; b < from->mMeshes[m]->mNumBones; ++b)
      joints.insert(from->mMeshes[m]->mBones[b]->mName.C_Str());
  for (unsigned c = 0; c < from->mNumCameras; ++c) things.insert(from->mCameras[c]->mName.C_Str());
  for (unsigned l = 0; l < from->mNumLights; ++l) things.insert(from->mLights[l]->mName.C_Str());
  add_node(*from->mRootNode, -1, joints, things, out);
  for (unsigned a = 0; a < from->mNumAnimations; ++a)
    out.animations.push_back(animation_of(*from->mAnimations[a], out));
  std::erase_if(out.animations, [](const motion::SceneAnimation& a) { return a.tracks.empty(); });
  double centimetres = 1;
  if (from->mMetaData != nullptr && !from->mMetaData->Get("UnitScaleFactor", centimetres)) {
    float narrow = 1;
    if (from->mMetaData->Get("UnitScaleFactor", narrow)) centimetres = static_cast<double>(narrow);
  }
  out.unit_metres = 0.01 * centimetres;
  return out;
}

[[maybe_unused]] const bool registered = motion::scene_readers().insert_or_assign(".fbx", read_fbx).second;

}  // namespace

void require_fbx() {}

}  // namespace motiongan::command
#endif
