// Action data sets from real clips, if available (MOTIONGAN_SHARED, else ../shared). Skips with a message
// otherwise.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <vector>

#include "motiongan/data/action_dataset.hpp"

namespace action_shared_data_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// A folder of the data; empty if it does not exist.
fs::path shared_data(const char* name) {
  const char* set = std::getenv("MOTIONGAN_SHARED");
  const fs::path shared = set ? fs::path(set) : fs::path(MOTIONGAN_SOURCE_DIR) / ".." / "shared";
  if (fs::is_directory(shared / "data" / name)) return shared / "data" / name;
  MESSAGE("skipped: no data/" << std::string(name) << " in " << shared.string());
  return {};
}

double worst_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, length(subtract(a[i], b[i])));
  return worst;
}

/// Positions of a file by forward kinematics round-trip through poses, over places and over a track; no turn
/// exceeds `most` radians per frame.
void check_round_trip(const fs::path& file, double most) {
  Motion motion = to_motion(read_bvh(file));
  drop_first_frames(motion, FirstFrame::automatic);
  const PositionClip positions = positions_of(motion, file.stem().string(), 30);
  const PositionLayout layout(positions.skeleton, true);
  const std::vector<double> poses = layout.encode(positions.positions);
  const std::vector<RootTrack> places = layout.places(positions.positions);
  CHECK(worst_distance(layout.restore(poses, places), positions.positions) < 1e-9);
  RootTrack track = places[0];
  track.started = false;
  CHECK(worst_distance(layout.decode(poses, &track), positions.positions) < 1e-9);
  for (std::size_t f = 0; f < positions.frames; ++f)
    CHECK(std::abs(poses[(f + 1) * layout.dof() - 1]) < most);
}

}  // namespace

TEST_CASE("CMU clips: joints that coincide with the root, a T-pose at the start") {
  const fs::path folder = shared_data("cmu");
  if (folder.empty()) return;
  check_round_trip(folder / "16" / "16_15.bvh", 0.2);
  check_round_trip(folder / "02" / "02_01.bvh", 0.2);
  ActionDatasetOptions options;
  options.folders = true;
  options.classes = {"02", "16"};  // by subject: the names of the folders
  const ActionDataset data = ActionDataset::from_folder(folder, options);
  CHECK(data.format.skeleton().size() == 31);
  CHECK(data.format.layout.dof() == 97);
  CHECK(data.format.bones().size() < 30);  // some joints coincide with their parent
  CHECK(data.format.dof() <= 97 - 3 * 3);
  CHECK(data.dropped_frames == data.train.size() + data.test.size());
  for (const ActionClip& clip : data.train) CHECK(data.starts(clip) > 0);
}

TEST_CASE("Bandai-Namco clips: the hips travel below a resting joint") {
  for (const char* name : {"bandai-1", "bandai-2"}) {
    const fs::path folder = shared_data(name);
    if (folder.empty()) continue;
    ActionDatasetOptions options;
    options.pattern = "dataset-*_{label}_*_*";
    options.classes = {"walk", "run"};
    const ActionDataset data = ActionDataset::from_folder(folder, options);
    CHECK(data.format.classes == std::vector<std::string>{"run", "walk"});
    CHECK(data.format.skeleton().joints[0].name == "Hips");
    CHECK(data.format.skeleton().size() == 21);
    CHECK(data.format.dof() == 64);  // 3 * 21 + 4, without the root's own position
    CHECK(data.dropped_frames == 0);
    double travelled = 0;
    for (const ActionClip& clip : data.train)
      travelled = std::max(travelled, std::hypot(clip.places.back().x - clip.places[0].x,
                                                 clip.places.back().z - clip.places[0].z));
    CHECK(travelled > 100);  // centimetres
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().stem().string().ends_with("_normal_001")) check_round_trip(entry.path(), 0.3);
  }
}

}  // namespace action_shared_data_test
