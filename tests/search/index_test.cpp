// The search index: read, updated, rebuilt; and the ranking of clips.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "motiongan/data/dataset.hpp"
#include "motiongan/data/dataset_build.hpp"
#include "motiongan/formats/bvh.hpp"
#include "motiongan/procedural/procedural.hpp"
#include "motiongan/search/collection.hpp"
#include "motiongan/search/ranking.hpp"

namespace index_test {

using namespace motiongan;
namespace fs = std::filesystem;

namespace {

/// A folder of clips, removed at the end of the test.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "motiongan-search-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  void write(const std::string& name, const motion::Motion& motion) const {
    fs::create_directories((path / name).parent_path());
    motion::write_bvh(path / name, motion);
  }
  fs::path path;
};

const std::vector<motion::LabelledMotion>& motions() {
  static const auto all = motion::procedural_motions({.clips = 6, .seconds = 6});
  return all;
}

motion::MotionFormat format_of(std::size_t frames = 16) {
  motion::DatasetOptions options;
  options.frames = frames;
  options.rate = 6;
  return motion::Dataset::from_motions(motions(), options).format;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("files are read once; changed files are read again, removed files dropped") {
  const Folder folder;
  const motion::MotionFormat format = format_of();
  folder.write("a.bvh", motions()[0].motion);
  folder.write("sub/b.bvh", motions()[1].motion);
  folder.write("sub/short.bvh", motion::slice(motions()[2].motion, 0, 30));
  const SearchCollection first = open_search_collection(folder.path, format);
  CHECK(first.read == 3);
  CHECK(first.kept == 0);
  CHECK(first.written);
  CHECK(first.file.parent_path() == folder.path / ".motiongan-search");
  REQUIRE(first.index.clips().size() == 3);
  CHECK(first.index.clips()[1].path == "sub/b.bvh");
  CHECK(first.index.clips()[0].frames == 36);
  CHECK(first.index.clips()[1].first == 36);
  CHECK(first.index.clips()[2].frames == 0);
  CHECK(first.index.clips()[2].left_out.find("shorter than a window of 16 frames") != std::string::npos);
  REQUIRE(first.warnings.size() == 1);
  CHECK(first.warnings[0].find("1 of 3 files left out") != std::string::npos);

  const SearchCollection second = open_search_collection(folder.path, format);
  CHECK(second.read == 0);
  CHECK(second.kept == 3);
  CHECK_FALSE(second.written);
  CHECK(second.index.frames().plain == first.index.frames().plain);
  CHECK(second.index.frames().track == first.index.frames().track);
  CHECK(second.index.clips()[2].left_out == first.index.clips()[2].left_out);
  CHECK(second.warnings == first.warnings);

  folder.write("a.bvh", motions()[3].motion);  // another motion of the same length
  fs::last_write_time(folder.path / "a.bvh",
                      fs::last_write_time(folder.path / "a.bvh") + std::chrono::seconds(2));
  folder.write("c.bvh", motions()[4].motion);
  fs::remove(folder.path / "sub/short.bvh");
  const SearchCollection third = open_search_collection(folder.path, format);
  CHECK(third.read == 2);
  CHECK(third.kept == 1);
  CHECK(third.removed == 1);
  CHECK(third.written);
  CHECK(third.warnings.empty());
  // The same as an index built from scratch.
  fs::remove(third.file);
  const SearchCollection anew = open_search_collection(folder.path, format);
  CHECK(anew.read == 3);
  CHECK(anew.index.frames().plain == third.index.frames().plain);
  CHECK(anew.index.frames().track == third.index.frames().track);
}

TEST_CASE("windows: every hop frames and the last one; poses equal a data set's") {
  const Folder folder;
  motion::Motion clip = motions()[0].motion;
  folder.write("a.bvh", clip);
  motion::DatasetOptions options;
  options.frames = 16;
  options.rate = 6;
  options.train_share = 1;
  const motion::Dataset data = motion::Dataset::from_bvh(folder.path, options);
  const SearchCollection collection = open_search_collection(folder.path, data.format);
  const auto windows = collection.index.windows(8);
  REQUIRE(windows.size() == 4);  // 36 frames: 0, 8, 16, 20
  CHECK(windows[2].frame == 16);
  CHECK(windows[3].frame == 20);
  std::vector<float> expected(16 * data.format.dof());
  data.window(data.train[0], 8 * data.stride, expected);
  const std::vector<float> poses = collection.index.poses(windows[1]);
  REQUIRE(poses.size() == expected.size());
  float worst = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) worst = std::max(worst, std::abs(poses[i] - expected[i]));
  CHECK(worst < 1e-4f);
  CHECK_THROWS_WITH_AS(collection.index.windows(0), doctest::Contains("hop is 0"), Error);
}

TEST_CASE("another format has its own index, another vocabulary has not") {
  const Folder folder;
  folder.write("a.bvh", motions()[0].motion);
  const motion::MotionFormat one = format_of(16), two = format_of(12);
  motion::MotionFormat words = one;
  words.vocabulary = motion::Vocabulary::from_captions(std::vector<std::string>{"another word"});
  CHECK(search_index_file(folder.path, one) != search_index_file(folder.path, two));
  CHECK(search_index_file(folder.path, one) == search_index_file(folder.path, words));
  CHECK(open_search_collection(folder.path, one).read == 1);
  CHECK(open_search_collection(folder.path, two).read == 1);
  CHECK(open_search_collection(folder.path, one).read == 0);
  CHECK(open_search_collection(folder.path, words).read == 0);
  // In one file, a format replaces the other with a warning.
  const fs::path file = folder.path / "mine.safetensors";
  open_search_collection(folder.path, one, file);
  const SearchCollection other = open_search_collection(folder.path, two, file);
  CHECK(other.read == 1);
  REQUIRE(other.warnings.size() == 1);
  CHECK(other.warnings[0].find("made for another model's format") != std::string::npos);
}

TEST_CASE("a damaged index is rebuilt with a warning; other files are not overwritten") {
  const Folder folder;
  folder.write("a.bvh", motions()[0].motion);
  const motion::MotionFormat format = format_of();
  const SearchCollection good = open_search_collection(folder.path, format);
  const std::string whole = bytes_of(good.file);
  const auto damaged = [&](const std::string& bytes) {
    std::ofstream(good.file, std::ios::binary) << bytes;
    const SearchCollection made = open_search_collection(folder.path, format);
    CHECK(made.read == 1);
    REQUIRE(made.warnings.size() == 1);
    CHECK(made.warnings[0].find("cannot be used") != std::string::npos);
    CHECK(bytes_of(good.file) == whole);
  };
  damaged(whole.substr(0, whole.size() / 2));
  damaged("");
  damaged("something else");
  std::string flipped = whole;
  flipped[flipped.size() - 9] = static_cast<char>(flipped[flipped.size() - 9] ^ 1);
  damaged(flipped);

  const fs::path mine = folder.path / "notes.txt";
  std::ofstream(mine) << "not to be lost";
  CHECK_THROWS_WITH_AS(open_search_collection(folder.path, format, mine),
                       doctest::Contains("is not a search index and will not be replaced"), Error);
  CHECK(bytes_of(mine) == "not to be lost");
  // A truncated index under a user-chosen name still counts as an index.
  std::ofstream(mine, std::ios::binary) << whole.substr(0, whole.size() / 2);
  CHECK(open_search_collection(folder.path, format, mine).written);
}

TEST_CASE("an index that cannot be written is a warning; unusable files are named") {
  const Folder folder;
  folder.write("a.bvh", motions()[0].motion);
  const motion::MotionFormat format = format_of();
  std::ofstream(folder.path / ".motiongan-search") << "in the way";
  const SearchCollection found = open_search_collection(folder.path, format);
  CHECK_FALSE(found.written);
  CHECK(found.read == 1);
  CHECK(found.index.clips().size() == 1);
  REQUIRE(found.warnings.size() == 1);
  CHECK(found.warnings[0].find("give --index a writable FILE") != std::string::npos);

  const Folder bad;
  CHECK_THROWS_WITH_AS(open_search_collection(bad.path, format), doctest::Contains("have no .bvh, .amc"),
                       Error);
  std::ofstream(bad.path / "broken.bvh") << "HIERARCHY\nROOT";
  CHECK_THROWS_WITH_AS(open_search_collection(bad.path, format), doctest::Contains("broken.bvh"), Error);
  motion::Motion other = motions()[0].motion;
  other.skeleton.joints[3].name = "Trunk";
  bad.write("a.bvh", other);
  fs::remove(bad.path / "broken.bvh");
  CHECK_THROWS_WITH_AS(open_search_collection(bad.path, format), doctest::Contains("'Trunk'"), Error);
  bad.write("z.bvh", motions()[0].motion);
  const SearchCollection mixed = open_search_collection(bad.path, format);
  REQUIRE(mixed.warnings.size() == 1);
  CHECK(mixed.warnings[0].find("1 of 2 files left out; the first: the clip a.bvh") != std::string::npos);
}

TEST_CASE("a clip that contains a hypothesis ranks first, once, with its two nearest hypotheses") {
  const Folder folder;
  for (std::size_t i = 0; i < 5; ++i) folder.write("clip" + std::to_string(i) + ".bvh", motions()[i].motion);
  const motion::MotionFormat format = format_of();
  const SearchCollection collection = open_search_collection(folder.path, format);
  const SearchIndex& index = collection.index;
  const auto windows = index.windows(8);
  // Clip 3 from its frame 11, and the same with noise.
  std::vector<std::vector<float>> hypotheses(4, index.poses({0, 0}));
  for (std::size_t i = 0; i < hypotheses[0].size(); ++i) hypotheses[0][i] += i % 2 == 0 ? 3.0f : -3.0f;
  hypotheses[1] = hypotheses[0];
  hypotheses[2] = index.poses({3, 11});
  hypotheses[3] = hypotheses[2];
  for (std::size_t i = 0; i < hypotheses[3].size(); ++i) hypotheses[3][i] += i % 3 == 0 ? 0.2f : 0.0f;
  const Context context;
  const WindowDistances found =
      SearchWindows(context, format, index.frames(), index.starts(windows))(hypotheses);
  const SearchRanking clips = rank(index, windows, found, hypotheses, 3);
  REQUIRE(clips.hits.size() == 3);
  const SearchHit& hit = clips.hits[0];
  CHECK(hit.window.clip == 3);
  REQUIRE(hit.nearest.size() == 2);
  CHECK(hit.nearest[0].hypothesis == 2);
  CHECK(static_cast<int>(hit.window.frame) + hit.nearest[0].shift == 11);
  CHECK(hit.distance() < 1e-5);
  CHECK(hit.nearest[1].hypothesis == 3);
  CHECK(hit.nearest[1].distance > 0.05);
  CHECK(clips.hits[1].window.clip != 3);
  CHECK(clips.hits[1].distance() >= hit.distance());
  CHECK(clips.median > hit.distance());
  const SearchRanking all = rank(index, windows, found, hypotheses, 1000, true);
  CHECK(all.hits.size() == windows.size());
  CHECK(all.hits[0].window.clip == 3);
  for (std::size_t i = 1; i < all.hits.size(); ++i)
    CHECK(all.hits[i].distance() >= all.hits[i - 1].distance());
  // With one hypothesis there is no second neighbour.
  const std::vector<std::vector<float>> one{hypotheses[2]};
  const SearchRanking single = rank(
      index, windows, SearchWindows(context, format, index.frames(), index.starts(windows))(one), one, 1);
  REQUIRE(single.hits.size() == 1);
  CHECK(single.hits[0].nearest.size() == 1);
  CHECK_THROWS_WITH_AS(rank(index, windows, found, one, 1), doctest::Contains("do not fit"), Error);
}

}  // namespace index_test
