// CSV of joint positions, with and without a bone list.
#include <motiongan/formats/position_files.hpp>
#include <motiongan/formats/read_motion.hpp>

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target position_csv_target{
    "position_csv", [](std::string_view bytes) {
      if (motion::is_position_csv(bytes)) {
        const motion::Skeleton joints = motion::joints_without_bones(bytes, false, "input.csv");
        try {
          motion::parse_position_csv(bytes, joints, 30, "input.csv");
        } catch (const Error&) {  // it may still fit the bone list
        }
      }
      static const std::filesystem::path bones =
          memory_folder().write("three.tsv", "hips\t-\nleg\thips\nfoot\tleg\n");
      static const motion::Skeleton skeleton = motion::read_bone_list(bones);
      const motion::PositionClip clip = motion::parse_position_csv(bytes, skeleton, 30, "input.csv");
      demand(clip.positions.size() == clip.frames * skeleton.size(), "a clip holds all joints of all frames");
      must("a clip can be written", [&] { return motion::format_position_csv(clip); });
      motion::ClipOptions options;
      options.bones = bones;
      options.fps = 30;
      motion::read_motion(memory_folder().write("input.csv", bytes), options);
    }};

}  // namespace motiongan::fuzz
