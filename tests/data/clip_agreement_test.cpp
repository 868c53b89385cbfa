// Which clips belong to one data set: skeletons, channel orders, sizes, up axes, and files that cannot be
// read.
#include "motiongan/data/clip_agreement.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "../support/bodies.hpp"
#include "motiongan/data/action_dataset.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/formats/bvh.hpp"

namespace clip_agreement_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_agreement_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path / "walk"); }
  ~Folder() { fs::remove_all(path); }
  void add(const std::string& name, const Motion& motion) const {
    write_bvh(path / "walk" / (name + ".bvh"), motion);
  }
};

DatasetOptions windows() {
  DatasetOptions out;
  out.frames = 8;
  out.rate = 10;
  return out;
}

ActionDatasetOptions action_windows() {
  ActionDatasetOptions out;
  out.frames = 8;
  out.rate = 10;
  out.folders = true;
  return out;
}

/// The messages of both kinds of data set; empty where one can be made.
void check_both(const Folder& folder, const ClipOptions& clips, const std::string& expected) {
  DatasetOptions captioned = windows();
  captioned.clips = clips;
  ActionDatasetOptions labelled = action_windows();
  labelled.clips = clips;
  if (expected.empty()) {
    CHECK_NOTHROW(Dataset::from_bvh(folder.path, captioned));
    CHECK_NOTHROW(ActionDataset::from_folder(folder.path, labelled));
  } else {
    CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path, captioned), doctest::Contains(expected.c_str()),
                         Error);
    CHECK_THROWS_WITH_AS(ActionDataset::from_folder(folder.path, labelled),
                         doctest::Contains(expected.c_str()), Error);
  }
}

}  // namespace

TEST_CASE("channels in other orders are one skeleton") {
  const Folder folder;
  Motion other = standing_body(60);
  for (Joint& joint : other.skeleton.joints) std::reverse(joint.channels.begin(), joint.channels.end());
  other.skeleton.joints[3].channels.push_back(Channel::x_position);
  folder.add("a", standing_body(60));
  folder.add("b", other);
  const Dataset data = Dataset::from_bvh(folder.path, windows());
  CHECK(data.train.size() + data.test.size() == 2);
  // The same motion, so the same poses, whatever the order of the angles.
  const std::vector<float>&a = data.train[0].poses, &b = data.test[0].poses;
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == doctest::Approx(b[i]).epsilon(1e-3));
  CHECK(data.format.skeleton().joints[0].channels == body_skeleton().joints[0].channels);
  CHECK(data.format.skeleton().joints[3].channels.size() == 4);  // no channel of any clip is lost
  check_both(folder, {}, "");
}

TEST_CASE("clips of several skeletons are refused with their groups, or one group is kept") {
  const Folder folder;
  Motion prop = standing_body(60);
  prop.skeleton.joints.back().name = "Helmet";
  folder.add("a", standing_body(60));
  folder.add("b", prop);
  folder.add("c", standing_body(60));
  check_both(folder, {}, "the clips have 2 different skeletons:\n  2 clips of 15 joints: '");
  check_both(folder, {}, "1 clip of 15 joints: 'b'; compared with the first: 'Head' is called 'Helmet'");
  check_both(folder, {}, "--skeleton-of FILE");
  ClipOptions keep;
  keep.skeleton_of = folder.path / "walk" / "c.bvh";
  check_both(folder, keep, "");
  DatasetOptions options = windows();
  options.clips = keep;
  const Dataset data = Dataset::from_bvh(folder.path, options);
  CHECK(data.train.size() + data.test.size() == 2);
  REQUIRE(data.other_skeletons.size() == 1);
  CHECK(data.other_skeletons[0].id == "b");
}

TEST_CASE("bodies of very different height are refused by name, or made alike") {
  const Folder folder;
  folder.add("a", standing_body(60));
  folder.add("b", standing_body(60));
  folder.add("metres", scaled(standing_body(60), 0.01));
  check_both(folder, {},
             "the median is 170 units, but 'metres' 1.7. If their units differ, give --normalise-height");
  ClipOptions alike;
  alike.normalise_height = true;
  check_both(folder, alike, "");
  ActionDatasetOptions options = action_windows();
  options.clips = alike;
  const ActionDataset data = ActionDataset::from_folder(folder.path, options);
  for (const auto* part : {&data.train, &data.test})
    for (const ActionClip& clip : *part)
      CHECK(body_height(clip.skeleton) == doctest::Approx(170).epsilon(1e-5));
  CHECK(data.format.space.unit_metres == 0.01);
  REQUIRE(!data.notes.empty());
  CHECK(data.notes.back().find("1 clip scaled to the median body height of 170") != std::string::npos);
}

TEST_CASE("one up axis, told by the clips that are sure") {
  const Folder folder;
  folder.add("a", in_z_up(standing_body(60)));
  Motion lying = standing_body(60, 0);
  for (std::size_t f = 0; f < lying.frames; ++f) lying.rotation(f, 0) = axis_rotation(0, -pi / 2);
  folder.add("lying", in_z_up(lying));  // from feet to head along y: looks like a y-up body that stands
  for (std::size_t f = 0; f < lying.frames; ++f) lying.rotation(f, 0) = axis_rotation(2, pi / 2);
  folder.add("side", in_z_up(lying));
  ClipOptions z;
  z.up = UpAxis::z;
  check_both(folder, {},
             "the clips differ in their up axis: 1 clip with y up ('lying'), 1 clip with z up ('a')");
  check_both(folder, z, "");
  fs::remove(folder.path / "walk" / "lying.bvh");
  const Dataset data = Dataset::from_bvh(folder.path, windows());
  CHECK(data.format.space.clips_up == UpAxis::z);
  REQUIRE(!data.notes.empty());
  CHECK(data.notes.front().find("z is up in these clips, by their rest pose and travel (1 clip followed") !=
        std::string::npos);
  CHECK(rest_up_axis(data.format.skeleton()) == UpAxis::y);
}

TEST_CASE("all bad files are listed, or skipped") {
  const Folder folder;
  for (const char* name : {"a", "b", "c"}) folder.add(name, standing_body(60));
  write_text_atomically(folder.path / "walk" / "empty.bvh", "");
  write_text_atomically(folder.path / "walk" / "text.bvh", "hello");
  write_text_atomically(folder.path / "walk" / "._a.bvh", "Mac");  // ignored
  fs::create_symlink("nowhere.bvh", folder.path / "walk" / "dead.bvh");
  check_both(folder, {}, "3 of 6 files cannot be read:");
  check_both(folder, {}, "empty.bvh is empty");
  check_both(folder, {}, "text.bvh:1:1: found 'hello'");
  check_both(folder, {}, "dead.bvh is a dead link");
  check_both(folder, {}, "--skip-bad");
  ClipOptions skip;
  skip.skip_bad = true;
  check_both(folder, skip, "");
  DatasetOptions options = windows();
  options.clips = skip;
  const Dataset data = Dataset::from_bvh(folder.path, options);
  CHECK(data.bad.size() == 3);
  CHECK(data.train.size() + data.test.size() == 3);
  for (const char* name : {"a", "b", "c"}) fs::remove(folder.path / "walk" / (std::string(name) + ".bvh"));
  check_both(folder, skip, "3 of 3 files cannot be read:");
}

}  // namespace clip_agreement_test
