// Bone lists: joints and parents.
#include <motiongan/formats/bone_list.hpp>

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target bone_list_target{
    "bone_list", [](std::string_view bytes) {
      const motion::Skeleton skeleton = motion::parse_bone_list(bytes, "bones.tsv");
      const std::filesystem::path file = memory_folder().path() / "written.tsv";
      must("a bone list can be written", [&] { motion::write_bone_list(file, skeleton); });
      const motion::Skeleton again =
          must("a written list can be read", [&] { return motion::read_bone_list(file); });
      demand(again == skeleton, "a written list reads back as the same");
    }};

}  // namespace motiongan::fuzz
