// GLB files: nodes, joints and animations.
#include <motiongan/formats/glb_character.hpp>
#include <motiongan/formats/read_motion.hpp>

#include "../memory_folder.hpp"
#include "../mutate_json.hpp"

namespace motiongan::fuzz {
namespace {

/// Changes the JSON of the file and puts the parts together again, or changes the file's bytes.
std::string mutate_glb(std::string_view bytes, const ChangeBytes& change, Random& random) {
  if (below(4, random) == 0) return change(bytes);
  motion::GlbParts parts;
  try {
    parts = motion::parse_glb(bytes, "input");
  } catch (const Error&) {
    return change(bytes);
  }
  nlohmann::json changed =
      nlohmann::json::parse(mutate_json(parts.json.dump(), change, random), nullptr, false);
  if (!changed.is_object()) return change(bytes);
  parts.json = std::move(changed);
  if (below(4, random) == 0) parts.binary = change(parts.binary);
  return motion::glb_detail::Document(std::move(parts)).file();
}

}  // namespace

const Target glb_target{
    "glb",
    [](std::string_view bytes) {
      const std::filesystem::path file = memory_folder().write("input.glb", bytes);
      const motion::GlbCharacter character(file);
      const motion::Motion made = character.motion();
      motion::check_motion(made);
      demand(made.skeleton.size() > 0, "a character has joints");
      motion::read_motion(file);
      if (made.frames == 0 || made.frames > 1000) return;
      const std::string text = character.file(std::vector<motion::NamedMotion>{{"made", made}});
      must("a written character can be read", [&] {
        return motion::skeleton_of(motion::scene_of(motion::parse_glb(text, "again"), "again"), "again");
      });
    },
    mutate_glb};

}  // namespace motiongan::fuzz
