// Writes motions in the format of a file's extension: BVH, GLB, FBX or VRMA.
#pragma once
#include <cctype>
#include <optional>
#include <set>

#include "fbx/fbx.hpp"
#include "motiongan/formats/bvh_stream.hpp"
#include "motiongan/formats/glb_character.hpp"
#include "motiongan/formats/vrma.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/resampler.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Adds --format. `others` are further formats, and what they are.
inline void add_format_option(CLI::App& verb, std::string& format, const std::set<std::string>& others = {},
                              const std::string& what = "") {
  std::set<std::string> names{"bvh", "glb", "fbx", "vrma"};
  names.insert(others.begin(), others.end());
  verb.add_option("--format", format,
                  "file format: bvh; glb (glTF: an animated skeleton with a simple body, in metres; or the "
                  "character of a GLB file that motion is put on); fbx (the same, in centimetres); vrma (an "
                  "animation for VRM avatars)" +
                      what)
      ->check(CLI::IsMember(names))
      ->capture_default_str();
}

/// "BVH file", "GLB file".
inline std::string file_kind(std::string format) {
  for (char& c : format) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return format + " file";
}

/// A motion file that is written piece by piece, resampled. BVH grows on disk; other formats are kept
/// in memory until they are finished.
class GrowingFile {
 public:
  /// For `frames` frames at `from` per second, written at `to`. `unit_metres` is the motion's unit; 0:
  /// unknown. If the skeleton is that of a GLB file's character, GLB files hold that character.
  GrowingFile(fs::path path, const motion::Skeleton& skeleton, std::size_t frames, double from, double to,
              double unit_metres, const motion::GlbCharacter* character = nullptr)
      : path_(std::move(path)),
        unit_metres_(unit_metres),
        character_(character),
        resampler_(frames, from, to) {
    if (path_.extension() == ".bvh") writer_.emplace(path_, skeleton, to, resampler_.total());
    if (path_.extension() == ".fbx") require_fbx();
  }

  void append(const motion::Motion& piece) {
    motion::Motion next = resampler_.append(piece);
    if (writer_)
      writer_->append(next);
    else if (next.frames > 0)
      kept_ = kept_.frames == 0 ? std::move(next) : join(std::move(kept_), next);
  }

  void finish() {
    if (writer_) return writer_->finish();
    const motion::NamedMotion named{path_.stem().string(), std::move(kept_)};
    if (path_.extension() == ".vrma") return motion::write_vrma(path_, named.name, named.motion);
    if (path_.extension() == ".fbx") return write_fbx(path_, named, {.unit_metres = unit_metres_});
    if (character_ != nullptr) return motion::write_text_atomically(path_, character_->file({&named, 1}));
    motion::write_glb(path_, {&named, 1}, {.unit_metres = unit_metres_});
  }

 private:
  fs::path path_;
  double unit_metres_;
  const motion::GlbCharacter* character_;
  motion::Resampler resampler_;
  std::optional<motion::BvhStreamWriter> writer_;
  motion::Motion kept_;
};

/// Writes a whole motion at `rate` (0: its own). See GrowingFile.
inline void write_motion(const fs::path& path, const motion::Motion& motion, double rate = 0,
                         double unit_metres = 0, const motion::GlbCharacter* character = nullptr) {
  GrowingFile file(path, motion.skeleton, motion.frames, motion.rate, rate > 0 ? rate : motion.rate,
                   unit_metres, character);
  file.append(motion);
  file.finish();
}

}  // namespace motiongan::command
