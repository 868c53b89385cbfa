// ZIP archives of NumPy arrays, as AMASS has them.
#include <motiongan/formats/amass.hpp>

#include "../../support/npz_bytes.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {
namespace {

/// Changes an array of the archive and packs all of them anew, or changes the archive's bytes.
std::string mutate_npz(std::string_view bytes, const ChangeBytes& change, Random& random) {
  if (below(4, random) == 0) return change(bytes);
  std::vector<testing::ZipPart> parts;
  try {
    const motion::ZipArchive archive(bytes, "input");
    for (const motion::ZipEntry& entry : archive.entries())
      parts.push_back({std::string(entry.name), archive.read(entry)});
  } catch (const Error&) {
    return change(bytes);
  }
  if (parts.empty()) return change(bytes);
  testing::ZipPart& part = parts[below(parts.size(), random)];
  constexpr const char *shapes[] = {"()", "(1,)", "(2, 66)", "(1, 66)", "(2, 3)", "(0, 66)", "(1, 156)"},
                       *types[] = {"<f8", "<f4", ">f8", "<i2"};
  switch (below(4, random)) {
    case 0:
      part.data = testing::npy_file(types[below(4, random)], shapes[below(7, random)], part.data);
      break;
    case 1:
      part.data = testing::npy_file(types[below(4, random)], shapes[below(7, random)],
                                    testing::doubles(std::vector<double>(below(200, random), 0.25)));
      break;
    case 2:
      part.name = change(part.name).substr(0, 200);
      break;
    default:
      part.data = change(part.data);
  }
  return testing::zip_file(parts, below(2, random) == 0);
}

}  // namespace

const Target npz_target{"npz",
                        [](std::string_view bytes) {
                          const motion::Motion motion = motion::parse_amass(bytes, "input.npz");
                          const std::size_t joints = motion.skeleton.size();
                          demand(motion.rotations.size() == motion.frames * joints &&
                                     motion.positions.size() == motion.frames * joints,
                                 "a motion holds all joints of all frames");
                        },
                        mutate_npz};

}  // namespace motiongan::fuzz
