// Acclaim text: an .asf file and, after a line `# amc`, an .amc file of this skeleton.
#include <motiongan/formats/amc.hpp>
#include <motiongan/formats/bvh_writer.hpp>

#include "../target.hpp"

namespace motiongan::fuzz {

const Target acclaim_target{
    "acclaim", [](std::string_view bytes) {
      constexpr std::string_view border = "\n# amc\n";
      const std::size_t end = bytes.find(border);
      const motion::AsfSkeleton asf = motion::parse_asf(bytes.substr(0, end), "input.asf");
      const std::size_t joints = asf.skeleton.size();
      demand(joints > 0 && asf.bones.size() == joints, "every joint has its bone");
      for (std::size_t j = 0; j < joints; ++j)
        demand(asf.skeleton.joints[j].parent < static_cast<int>(j), "parents come before their children");
      if (end == bytes.npos) return;
      const motion::Motion motion =
          motion::parse_amc(bytes.substr(end + border.size()), asf, 120, "input.amc");
      demand(motion.frames > 0 && motion.rotations.size() == motion.frames * joints &&
                 motion.positions.size() == motion.frames * joints,
             "a motion holds all joints of all frames");
    }};

}  // namespace motiongan::fuzz
