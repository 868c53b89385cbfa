// Action data sets from motions, positions and files.
#include "motiongan/data/action_dataset.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "motiongan/formats/bvh.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace action_dataset_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// Procedural clips of about 3 seconds named {subject}_{number}, labelled "walk" and "wave" alternately.
std::vector<LabelledMotion> labelled(std::size_t count) {
  std::vector<LabelledMotion> out;
  for (std::size_t i = 0; i < count; ++i) {
    LabelledMotion m = procedural_motion(i);
    m.motion = slice(m.motion, 0, std::min(m.motion.frames, static_cast<std::size_t>(3 * m.motion.rate)));
    m.id = concat("s", i / 4, "_", i);
    m.captions = {i % 2 == 0 ? "walk" : "wave", "something else"};
    out.push_back(std::move(m));
  }
  return out;
}

/// A temporary folder, removed when the test ends.
struct TemporaryFolder {
  fs::path path;
  explicit TemporaryFolder(const char* name) : path(fs::temp_directory_path() / name) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  write_text_atomically(path, text);
}

std::vector<std::string> ids(const std::vector<ActionClip>& clips) {
  std::vector<std::string> out;
  for (const ActionClip& clip : clips) out.push_back(clip.id);
  return out;
}

}  // namespace

TEST_CASE("from motions: classes, windows, statistics, and conversion back to positions") {
  const std::vector<LabelledMotion> motions = labelled(12);
  ActionDatasetOptions options;
  options.frames = 15;
  const ActionDataset data = ActionDataset::from_motions(motions, options);
  CHECK(data.format.classes == std::vector<std::string>{"walk", "wave"});
  CHECK(data.train.size() == 8);  // 4 of 6 in each class
  CHECK(data.test.size() == 4);
  CHECK(data.format.rate == 30);
  CHECK(data.format.frames == 15);
  const std::size_t dof = data.format.dof();
  std::vector<double> sum(dof), squares(dof);
  double rows = 0;
  for (const ActionClip& clip : data.train) {
    CHECK(clip.subject.empty());
    CHECK(clip.label == static_cast<std::size_t>(std::stoi(clip.id.substr(clip.id.find('_') + 1)) % 2));
    REQUIRE(clip.poses.size() == clip.frames * dof);
    REQUIRE(clip.places.size() == clip.frames);
    CHECK(data.starts(clip) == clip.frames - 29);
    rows += static_cast<double>(clip.frames);
    for (std::size_t i = 0; i < clip.poses.size(); ++i) {
      sum[i % dof] += static_cast<double>(clip.poses[i]);
      squares[i % dof] += static_cast<double>(clip.poses[i]) * static_cast<double>(clip.poses[i]);
    }
  }
  for (std::size_t d = 0; d < dof; ++d) {
    CHECK(std::abs(sum[d] / rows) < 1e-4);
    CHECK(squares[d] / rows == doctest::Approx(1).epsilon(1e-3));
  }
  for (const ActionClip& clip : data.test) {
    for (const LabelledMotion& m : motions) {
      if (m.id != clip.id) continue;
      const PositionClip original = positions_of(m.motion, m.id, 30);
      const std::vector<Vec3> restored = data.format.restore(clip.poses, clip.places);
      REQUIRE(restored.size() == original.positions.size());
      double worst = 0;
      for (std::size_t i = 0; i < restored.size(); ++i)
        worst = std::max(worst, length(subtract(restored[i], original.positions[i])));
      CHECK(worst < 0.01);  // centimetres, floats
      CHECK(clip.skeleton == original.skeleton);
    }
  }
}

TEST_CASE("short clips are skipped; it is an error if none is left") {
  std::vector<LabelledMotion> motions = labelled(6);
  motions[2].motion = slice(motions[2].motion, 0, static_cast<std::size_t>(1.4 * motions[2].motion.rate));
  motions.push_back(motions[0]);
  motions.back().id = "unlabelled";
  motions.back().captions.clear();
  const ActionDataset data = ActionDataset::from_motions(motions);
  REQUIRE(data.skipped.size() == 1);
  CHECK(data.skipped[0].id == motions[2].id);
  CHECK(data.skipped[0].reason == "clip 's0_2' lasts 1.40 s, a window of 2 x 30 frames needs 2.00 s");
  CHECK(data.unlabelled == 1);

  ActionDatasetOptions options;
  options.frames = 50;  // 3.33 s
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(motions, options),
                       doctest::Contains("none of 6 labelled clips holds a window"), Error);
  // One class has only short clips.
  for (const std::size_t i : {1u, 3u, 5u}) motions[i].motion = motions[2].motion;
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(motions),
                       doctest::Contains("no clip of the class 'wave' holds a window of 2.00 s; the longest "
                                         "lasts 1.40 s: use windows of 2 x 21 frames"),
                       Error);
  options.frames = 30;
  options.classes = {"walk"};
  CHECK(ActionDataset::from_motions(motions, options).other_classes == 3);
  options.classes = {"walk", "swim"};
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(motions, options),
                       doctest::Contains("no clip has the class 'swim'; the classes are: 'walk', 'wave'"),
                       Error);
}

TEST_CASE("subjects stay together") {
  const std::vector<LabelledMotion> motions = labelled(12);  // s0, s1, s2: four clips each
  ActionDatasetOptions options;
  options.by_subject = true;
  const ActionDataset data = ActionDataset::from_motions(motions, options);
  CHECK(data.train.size() == 8);
  CHECK(data.test.size() == 4);
  for (const ActionClip& clip : data.test) CHECK(clip.subject == data.test[0].subject);
  for (const ActionClip& clip : data.train) CHECK(clip.subject != data.test[0].subject);

  options.test_subjects = {"s1"};
  CHECK(ids(ActionDataset::from_motions(motions, options).test) ==
        std::vector<std::string>{"s1_4", "s1_5", "s1_6", "s1_7"});
  options.test_subjects = {"s9"};
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(motions, options), doctest::Contains("'s9'"), Error);

  std::vector<LabelledMotion> own = motions;
  for (std::size_t i = 0; i < 4; ++i) own[i].captions = {"bow"};
  options.test_subjects = {"s0"};
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(own, options),
                       doctest::Contains("the class 'bow' has no training clip"), Error);
  options.pattern = "{subject}_*";
  CHECK_THROWS_AS((void)ActionDataset::from_motions(own, options), Error);
  options.test_subjects = {"s1"};
  CHECK(ActionDataset::from_motions(own, options).test.size() == 4);
}

TEST_CASE("different joints are an error, different bone lengths are not") {
  std::vector<LabelledMotion> motions = labelled(4);
  for (std::size_t f = 0; f < motions[3].motion.frames; ++f)
    for (std::size_t j = 1; j < motions[3].motion.skeleton.size(); ++j)
      motions[3].motion.position(f, j) = scale(motions[3].motion.position(f, j), 1.1);
  for (Joint& joint : motions[3].motion.skeleton.joints) joint.offset = scale(joint.offset, 1.1);
  const ActionDataset data = ActionDataset::from_motions(motions);
  for (const auto* part : {&data.train, &data.test})
    for (const ActionClip& clip : *part)
      CHECK(length(clip.skeleton.joints[2].offset) ==
            doctest::Approx((clip.id == "s0_3" ? 1.1 : 1.0) *
                            length(motions[0].motion.skeleton.joints[2].offset)));
  motions[3].motion.skeleton.joints[5].name = "Tail";
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_motions(motions), doctest::Contains("Tail"), Error);
}

TEST_CASE("from positions, at another rate") {
  std::vector<PositionClip> clips;
  ActionLabels labels{{"missing", "walk"}};
  for (const LabelledMotion& m : labelled(6)) {
    clips.push_back(positions_of(m.motion, m.id, 60));
    labels[m.id] = m.captions[0];
  }
  const ActionDataset data = ActionDataset::from_positions(clips, labels);
  CHECK(data.train.size() + data.test.size() == 6);
  const ActionClip& clip = data.train[0];
  CHECK(clip.frames == (clips[0].frames + 1) / 2);
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_positions(clips, {}), doctest::Contains("has a label"),
                       Error);
  clips[1].positions.pop_back();
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_positions(clips, labels),
                       doctest::Contains(clips[1].id.c_str()), Error);
  clips[1] = clips[0];
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_positions(clips, labels), doctest::Contains("two clips"),
                       Error);
}

TEST_CASE("from a folder: BVH, CSV and NPY with labels from a file, folders or names") {
  const TemporaryFolder folder("motiongan_action_dataset_test");
  const std::vector<LabelledMotion> motions = labelled(8);
  std::string lines;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const fs::path in = folder.path / motions[i].captions[0];
    fs::create_directories(in);
    // Files round positions to single precision; labels and subjects come from the file name.
    if (i < 6)
      write_bvh(in / (motions[i].id + ".bvh"), motions[i].motion);
    else if (i == 6)
      write_position_csv(in / (motions[i].id + ".csv"), positions_of(motions[i].motion, motions[i].id, 30));
    else
      write_position_npy(in / (motions[i].id + ".npy"), positions_of(motions[i].motion, motions[i].id, 30));
    lines += motions[i].id + "\t" + motions[i].captions[0] + "\n";
  }
  write_bone_list(folder.path / "list.tsv", motions[0].motion.skeleton);
  ActionDatasetOptions options;
  options.clips.bones = folder.path / "list.tsv";
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_folder(folder.path, options),
                       doctest::Contains("there are no labels"), Error);

  options.folders = true;
  const ActionDataset by_folder = ActionDataset::from_folder(folder.path, options);
  CHECK(by_folder.train.size() + by_folder.test.size() == 8);
  CHECK(by_folder.format.classes == std::vector<std::string>{"walk", "wave"});
  options.folders = false;
  write(folder.path / "labels.csv", "# labels\n" + lines + "not here\twalk\n");
  options.labels = folder.path / "labels.csv";
  const ActionDataset by_file = ActionDataset::from_folder(folder.path, options);
  CHECK(ids(by_file.train) == ids(by_folder.train));
  CHECK(by_file.format.normalizer.mean() == by_folder.format.normalizer.mean());
  const ActionDataset in_memory = ActionDataset::from_motions(motions);
  for (std::size_t d = 0; d < in_memory.format.layout.dof(); ++d)
    CHECK(std::abs(by_file.format.normalizer.mean()[d] - in_memory.format.normalizer.mean()[d]) < 1e-3);

  by_file.write_split(folder.path / "split.txt");
  const std::string split = read_text(folder.path / "split.txt", "split");
  CHECK(split.starts_with("# split of 8 clips, seed 1"));
  CHECK(split.find(concat("test\t", by_file.test[0].id, "\t", by_file.format.classes[by_file.test[0].label],
                          "\n")) != split.npos);

  options.folders = true;
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_folder(folder.path, options),
                       doctest::Contains("several sources"), Error);
  options.folders = false;
  fs::remove(folder.path / "labels.csv");
  options.labels.clear();
  options.pattern = "{label}_*";
  CHECK(ActionDataset::from_folder(folder.path, options).format.classes ==
        std::vector<std::string>{"s0", "s1"});
  options.pattern = "{label}-*";
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_folder(folder.path, options), doctest::Contains("{label}-*"),
                       Error);
  options.pattern = "*";
  CHECK_THROWS_WITH_AS((void)ActionDataset::from_folder(folder.path, options), doctest::Contains("neither"),
                       Error);
  CHECK_THROWS_AS((void)ActionDataset::from_folder(folder.path / "none", options), Error);
}

}  // namespace action_dataset_test
