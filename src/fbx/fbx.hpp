// FBX files, through Assimp, with which motion::read_motion() reads them too. A command that is built without
// it says so when one is to be read or written.
#pragma once
#include <filesystem>
#include <span>

#include "motiongan/formats/glb.hpp"

namespace motiongan::command {

/// Throws Error, saying which package to install, if the command is built without Assimp.
void require_fbx();

/// Writes a motion as an FBX file in centimetres, y up, with a simple body, replacing it at once. Throws
/// Error if it cannot, and as glb_file() does.
void write_fbx(const std::filesystem::path& path, const motion::NamedMotion& motion,
               const motion::GlbOptions& options);

}  // namespace motiongan::command
