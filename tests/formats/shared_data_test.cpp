// Real data, if available (MOTIONGAN_SHARED, else ../shared): the CMU clips converted to the exponential maps
// of the motion-prediction papers, and round trips. Skips with a message otherwise.
#include <doctest/doctest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "motiongan/data/dataset.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/rotation.hpp"

namespace shared_data_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// The data folder; empty if it does not exist.
fs::path shared_data() {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const fs::path shared = set ? fs::path(set) : fs::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared";
  if (fs::is_directory(shared / "data")) return shared / "data";
  MESSAGE("skipped: no data folder in " << shared.string());
  return {};
}

}  // namespace

TEST_CASE("CMU clips give the exponential maps of the motion-prediction papers") {
  const fs::path data = shared_data();
  if (data.empty() || !fs::exists(data / "cmu-expmap" / "match.txt")) return;
  std::istringstream matches(read_text(data / "cmu-expmap" / "match.txt", "list"));
  std::size_t compared = 0;
  double worst = 0, worst_position = 0;
  for (std::string line; std::getline(matches, line) && compared < 12;) {
    std::istringstream fields(line);
    std::string text_path, rows, id;
    fields >> text_path >> rows >> id;
    const fs::path bvh = data / "cmu" / id.substr(0, id.find('_')) / (id + ".bvh");
    if (id == "-" || !fs::exists(bvh) || !fs::exists(data / "cmu-expmap" / text_path)) continue;
    const Clip clip = read_bvh(bvh);  // frame 0 is part of the text
    const std::string text = read_text(data / "cmu-expmap" / text_path, "text");
    std::vector<double> columns;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t stop = std::min(text.find_first_of(",\r\n", at), text.size());
      double value = 0;
      if (std::from_chars(text.data() + at, text.data() + stop, value).ec == std::errc())
        columns.push_back(value);
      at = stop + 1;
    }
    REQUIRE(columns.size() == clip.frames * 117);
    std::vector<Channel> root_order{Channel::z_rotation, Channel::x_rotation, Channel::y_rotation};
    const std::size_t width = clip.skeleton.channel_count();
    for (std::size_t f = 0; f < clip.frames; ++f) {
      const double* value = clip.channels.data() + f * width;
      const double* expected = columns.data() + f * 117;
      for (std::size_t k = 0; k < 3; ++k)
        worst_position = std::max(worst_position, std::abs(value[k] - expected[k]));
      value += 3;
      expected += 3;
      for (std::size_t j = 0; j < clip.skeleton.size(); ++j) {
        const Joint& joint = clip.skeleton.joints[j];
        // Channels are z, y, x. The texts compose the root's angles in a different order.
        const Vec3 zyx{radians(value[0]), radians(value[1]), radians(value[2])};
        const Vec3 r = j == 0 ? expmap_from_euler(EulerOrder(root_order), {zyx[0], zyx[2], zyx[1]})
                              : expmap_from_euler(EulerOrder(joint.channels), zyx);
        worst = std::max(worst, length(add(r, {expected[0], expected[1], expected[2]})));
        value += 3;
        expected += joint.end_site ? 6 : 3;  // an end site has a triple of zeros
      }
    }
    ++compared;
  }
  MESSAGE("compared " << compared << " clips: worst rotation " << worst << ", worst position "
                      << worst_position);
  CHECK(compared > 0);
  CHECK(worst < 1e-8);
  CHECK(worst_position < 1e-8);
}

TEST_CASE("real files survive reading, writing and conversion to rotations") {
  const fs::path data = shared_data();
  if (data.empty()) return;
  std::size_t files = 0;
  double worst_angle = 0;
  for (const char* folder : {"cmu/01", "cmu/49", "bandai-1"}) {
    if (!fs::is_directory(data / folder)) continue;
    std::size_t here = 0;
    for (const fs::path& path : find_clip_files(data / folder)) {
      if (here++ == 5) break;
      const Clip clip = read_bvh(path);
      const Clip again = parse_bvh(format_bvh(clip), clip.id);
      CHECK(again.skeleton == clip.skeleton);
      CHECK(again.channels == clip.channels);
      CHECK(again.frame_time == clip.frame_time);
      const Motion motion = to_motion(clip), back = to_motion(to_clip(motion, clip.id));
      for (std::size_t i = 0; i < motion.rotations.size(); ++i)
        worst_angle = std::max(worst_angle, angle_between(motion.rotations[i], back.rotations[i]));
      ++files;
    }
  }
  MESSAGE(files << " files, worst angle after Euler angles and back " << worst_angle);
  CHECK(files > 0);
  CHECK(worst_angle < 1e-12);
}

TEST_CASE("the CMU clips make the paper's data set") {
  const fs::path data = shared_data();
  if (data.empty() || !fs::exists(data / "cmu" / "captions.tsv")) return;
  DatasetOptions options;
  options.captions = data / "cmu" / "captions.tsv";
  const Dataset set = Dataset::from_bvh(data / "cmu", options);
  CHECK(set.train.size() + set.test.size() == 35);  // the clips of at least 8 s
  CHECK(set.train.size() + set.test.size() + set.skipped.size() == 128);
  CHECK(set.stride == 30);
  CHECK(set.dropped_frames == 129);  // one T-pose each, two in 07_12
  CHECK(set.named == 0);
  CHECK(set.format.layout.dof() == 96);
  CHECK(set.format.relative_dims.size() == 3);  // x, z and yaw of the root
}

}  // namespace shared_data_test
