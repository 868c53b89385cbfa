// Writing FBX files through Assimp: a skeleton, its body and one animation.
#if MOTIONGAN_WITH_ASSIMP
#include <assimp/scene.h>

#include <array>
#include <assimp/Exporter.hpp>

#include "fbx/fbx.hpp"
#include "fbx/fbx_records.hpp"

namespace motiongan::command {
namespace {

constexpr double centimetres = 100;

aiVector3D vec3(const motion::Vec3& v) {
  return {static_cast<ai_real>(v[0]), static_cast<ai_real>(v[1]), static_cast<ai_real>(v[2])};
}

/// A list that an aiScene owns: it deletes what it points at.
template <class T>
T** list_of(const std::vector<T*>& items) {
  T** const out = new T*[items.size()];
  std::copy(items.begin(), items.end(), out);
  return out;
}

/// The body as a mesh that hangs from the joints, in centimetres.
aiMesh* mesh_of(const motion::CapsuleBody& body, const motion::Skeleton& skeleton) {
  auto* const mesh = new aiMesh();
  mesh->mName = "body";
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mNumVertices = static_cast<unsigned>(body.positions.size() / 3);
  mesh->mVertices = new aiVector3D[mesh->mNumVertices];
  mesh->mNormals = new aiVector3D[mesh->mNumVertices];
  for (std::size_t v = 0; v < mesh->mNumVertices; ++v) {
    const auto at = [&](const std::vector<float>& values) {
      return aiVector3D(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
    };
    mesh->mVertices[v] = at(body.positions) * static_cast<ai_real>(centimetres);
    mesh->mNormals[v] = at(body.normals);
  }
  mesh->mNumFaces = static_cast<unsigned>(body.triangles.size() / 3);
  mesh->mFaces = new aiFace[mesh->mNumFaces];
  for (std::size_t t = 0; t < mesh->mNumFaces; ++t) {
    mesh->mFaces[t].mNumIndices = 3;
    mesh->mFaces[t].mIndices =
        new unsigned[3]{body.triangles[3 * t], body.triangles[3 * t + 1], body.triangles[3 * t + 2]};
  }
  std::vector<aiBone*> bones;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    auto* const bone = new aiBone();
    bone->mName = skeleton.joints[j].name;
    aiMatrix4x4::Translation(vec3(motion::scale(body.rest[j], -centimetres)), bone->mOffsetMatrix);
    std::vector<aiVertexWeight> weights;
    for (std::size_t v = 0; v < mesh->mNumVertices; ++v)
      for (std::size_t k = 4 * v; k < 4 * v + 4; ++k)
        if (body.joints[k] == j && body.weights[k] > 0)
          weights.emplace_back(static_cast<unsigned>(v), body.weights[k]);
    // A joint without a part of the body hangs on by nothing; it would not be a joint without any weight.
    if (weights.empty()) weights.emplace_back(0U, 0.0F);
    bone->mNumWeights = static_cast<unsigned>(weights.size());
    bone->mWeights = new aiVertexWeight[weights.size()];
    std::copy(weights.begin(), weights.end(), bone->mWeights);
    bones.push_back(bone);
  }
  mesh->mNumBones = static_cast<unsigned>(bones.size());
  mesh->mBones = list_of(bones);
  return mesh;
}

/// The joints as nodes below `top`, at rest.
void add_nodes(aiNode& top, const motion::Skeleton& skeleton, double scale) {
  std::vector<aiNode*> nodes;
  for (const motion::Joint& joint : skeleton.joints) {
    nodes.push_back(new aiNode(joint.name));
    aiMatrix4x4::Translation(vec3(motion::scale(joint.offset, scale)), nodes.back()->mTransformation);
  }
  std::vector<std::vector<aiNode*>> below(nodes.size());
  for (std::size_t j = 1; j < nodes.size(); ++j)
    below[static_cast<std::size_t>(skeleton.joints[j].parent)].push_back(nodes[j]);
  for (std::size_t j = 0; j < nodes.size(); ++j)
    if (!below[j].empty()) nodes[j]->addChildren(static_cast<unsigned>(below[j].size()), below[j].data());
  top.addChildren(1, nodes.data());
}

aiAnimation* animation_of(const motion::NamedMotion& named, double scale) {
  const motion::Motion& motion = named.motion;
  auto* const out = new aiAnimation();
  out->mName = named.name;
  out->mTicksPerSecond = 1;  // times are in seconds; Assimp 5.2 writes no others
  out->mDuration = static_cast<double>(motion.frames - 1) / motion.rate;
  std::vector<aiNodeAnim*> channels;
  for (std::size_t j = 0; j < motion.skeleton.size(); ++j) {
    auto* const channel = new aiNodeAnim();
    channel->mNodeName = motion.skeleton.joints[j].name;
    channel->mNumRotationKeys = channel->mNumPositionKeys = static_cast<unsigned>(motion.frames);
    channel->mRotationKeys = new aiQuatKey[motion.frames];
    channel->mPositionKeys = new aiVectorKey[motion.frames];
    channel->mNumScalingKeys = 1;
    channel->mScalingKeys = new aiVectorKey[1]{aiVectorKey(0, aiVector3D(1, 1, 1))};
    for (std::size_t f = 0; f < motion.frames; ++f) {
      const motion::Quat& q = motion.rotation(f, j);
      const double time = static_cast<double>(f) / motion.rate;
      const auto real = [](double v) { return static_cast<ai_real>(v); };
      channel->mRotationKeys[f] = {time, aiQuaternion(real(q.w), real(q.x), real(q.y), real(q.z))};
      channel->mPositionKeys[f] = {time, vec3(motion::scale(motion.position(f, j), scale))};
    }
    channels.push_back(channel);
  }
  out->mNumChannels = static_cast<unsigned>(channels.size());
  out->mChannels = list_of(channels);
  return out;
}

/// Writes the angles of all joints anew, without jumps from one key to the next. Assimp's lie between -180
/// and 180 degrees; between two frames a joint would spin. Every joint has nine curves: x, y and z of its
/// position, its rotation and its scale.
void unwrap_angles(std::string& file, const motion::Motion& motion) {
  const std::size_t joints = motion.skeleton.size();
  const std::vector<fbx_records::Curve> curves = fbx_records::curves_of(file);
  require(curves.size() == 9 * joints, "an FBX file from Assimp has ", curves.size(), " curves, expected ",
          9 * joints);
  constexpr std::array about{motion::Channel::z_rotation, motion::Channel::y_rotation,
                             motion::Channel::x_rotation};
  const motion::EulerOrder order(about);
  for (std::size_t j = 0; j < joints; ++j) {
    motion::Vec3 angles{};  // about z, y, x
    for (std::size_t f = 0; f < motion.frames; ++f) {
      angles = motion::euler_from_quat_near(order, motion.rotation(f, j), angles);
      for (std::size_t a = 0; a < 3; ++a) {
        const fbx_records::Curve& curve = curves[9 * j + 3 + a];
        require(curve.keys == motion.frames, "an FBX file from Assimp has a curve of ", curve.keys,
                " keys, expected ", motion.frames);
        const auto value = static_cast<float>(motion::degrees(angles[2 - a]));
        std::memcpy(&file[curve.at + f * sizeof value], &value, sizeof value);
      }
    }
  }
}

}  // namespace

void write_fbx(const std::filesystem::path& path, const motion::NamedMotion& named,
               const motion::GlbOptions& options) {
  motion::check_writable(named);
  const motion::Skeleton& skeleton = named.motion.skeleton;
  const double metres = motion::metres_per_unit(skeleton, options), scale = centimetres * metres;
  aiScene scene;
  scene.mRootNode = new aiNode("scene");
  add_nodes(*scene.mRootNode, skeleton, scale);
  aiNode* body = new aiNode("body");
  body->mNumMeshes = 1;
  body->mMeshes = new unsigned[1]{0};
  scene.mRootNode->addChildren(1, &body);
  scene.mNumMeshes = 1;
  scene.mMeshes = list_of<aiMesh>({mesh_of(motion::capsule_body(skeleton, metres), skeleton)});
  scene.mNumMaterials = 1;
  scene.mMaterials = list_of<aiMaterial>({new aiMaterial()});
  scene.mNumAnimations = 1;
  scene.mAnimations = list_of<aiAnimation>({animation_of(named, scale)});
  Assimp::Exporter exporter;
  const aiExportDataBlob* const blob = exporter.ExportToBlob(&scene, "fbx");
  require(blob != nullptr, path.string(), " cannot be written as FBX: ", exporter.GetErrorString());
  io::AtomicFile file(path);
  std::string bytes = fbx_records::with_ends_of_lists({static_cast<const char*>(blob->data), blob->size});
  for (const char* const end : {"LocalStop", "ReferenceStop"})
    fbx_records::set_time(bytes, end, scene.mAnimations[0]->mDuration);
  unwrap_angles(bytes, named.motion);
  file.write(bytes);
  file.commit();
}

}  // namespace motiongan::command
#endif
