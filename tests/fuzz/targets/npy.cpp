// NumPy arrays: as numbers, and as joint positions of the skeletons that their shape tells.
#include <motiongan/formats/npz.hpp>
#include <motiongan/formats/read_motion.hpp>

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target npy_target{
    "npy", [](std::string_view bytes) {
      try {
        const motion::NpyArray array = motion::parse_npy_array(bytes, "input.npy");
        std::size_t count = 1;
        for (const std::size_t extent : array.shape) count *= extent;
        demand(array.values.size() == count, "an array holds as many numbers as its shape says");
      } catch (const Error&) {  // positions may still be read
      }
      try {
        const motion::Skeleton joints = motion::joints_without_bones(bytes, true, "input.npy");
        const motion::PositionClip clip = motion::parse_position_npy(bytes, joints, 30, "input.npy");
        const std::string text =
            must("a clip can be written", [&] { return motion::format_position_npy(clip); });
        const motion::PositionClip again = must("a written clip can be read", [&] {
          return motion::parse_position_npy(text, joints, 30, "again");
        });
        demand(again.positions == clip.positions, "a written clip reads back as the same");
      } catch (const Error&) {
      }
      motion::ClipOptions options;
      options.fps = 30;
      motion::read_motion(memory_folder().write("input.npy", bytes), options);
    }};

}  // namespace motiongan::fuzz
