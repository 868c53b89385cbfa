// Search indexes. The checksum of an input is set right, so that what lies behind it is reached.
#include <motiongan/search/index.hpp>

#include "../memory_folder.hpp"
#include "../mutate_safetensors.hpp"

namespace motiongan::fuzz {
namespace {

/// A body of two joints that moves in two dimensions, of which one is relative: two plain columns and a
/// track.
motion::MotionFormat small_format() {
  motion::MotionFormat format;
  motion::Skeleton skeleton = motion::parse_hierarchy(
      "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 1 0 } }",
      "skeleton");
  format.layout = motion::PoseLayout(std::move(skeleton), true);
  format.normalizer = motion::Normalizer({0, 0, 0, 0, 0, 0}, {1, 1, 0, 1, 0, 0});
  format.rate = 30;
  format.frames = 2;
  format.relative_dims = {2};
  return format;
}

void read_index(const std::filesystem::path& file) {
  static const motion::MotionFormat format = small_format();
  const auto index = SearchIndex::read(file, format);
  if (!index) return;
  for (const SearchWindow& window : index->windows(1))
    demand(index->poses(window).size() == 2 * format.dof(), "a window holds two poses");
}

}  // namespace

const Target search_index_target{"search_index",
                                 [](std::string_view bytes) {
                                   const std::filesystem::path file =
                                       memory_folder().write("index.safetensors", bytes);
                                   try {
                                     read_index(file);
                                   } catch (const Error&) {  // mostly the checksum
                                   }
                                   io::SafeTensors content = io::SafeTensors::read(file);
                                   content.metadata["checksum"] = search_detail::checksum(content);
                                   content.metadata["search_format"] = search_key(small_format());
                                   content.write(file);
                                   read_index(file);
                                 },
                                 mutate_safetensors};

}  // namespace motiongan::fuzz
