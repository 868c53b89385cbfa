// FBX in a command that is built without Assimp.
#if !MOTIONGAN_WITH_ASSIMP
#include "fbx/fbx.hpp"

namespace motiongan::command {

void require_fbx() {
  throw Error(
      "this command was built without Assimp and writes no FBX files; install libassimp-dev and build it "
      "again, or use --format glb");
}

void write_fbx(const std::filesystem::path&, const motion::NamedMotion&, const motion::GlbOptions&) {
  require_fbx();
}

}  // namespace motiongan::command
#endif
