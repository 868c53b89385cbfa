// The parts of `motiongan info`.
#pragma once
#include "motiongan/formats/clip_options.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Prints a safetensors file: a model, a checkpoint or any other.
void print_tensors(const fs::path& file);
/// Prints the folder of a training run.
void print_run(const fs::path& folder);
/// Prints a folder of clips and their captions.
void print_folder(const fs::path& folder, const fs::path& captions, const motion::ClipOptions& options);

}  // namespace motiongan::command
