// Data sets from folders, and their written splits.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "../support/walking_clips.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/formats/bvh.hpp"

namespace dataset_files_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_dataset_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

std::set<std::string> ids(const std::vector<DatasetClip>& clips) {
  std::set<std::string> out;
  for (const DatasetClip& c : clips) out.insert(c.id);
  return out;
}

}  // namespace

TEST_CASE("the split is seeded, complete, and written to a file") {
  DatasetOptions options = eight_at(4);
  const Dataset a = Dataset::from_motions(several(12), options),
                b = Dataset::from_motions(several(12), options);
  CHECK(ids(a.train) == ids(b.train));
  CHECK(a.train.size() == 8);
  CHECK(a.test.size() == 4);
  options.split_seed = 2;
  CHECK(ids(Dataset::from_motions(several(12), options).train) != ids(a.train));
  for (const std::string& id : ids(a.test)) CHECK(!ids(a.train).contains(id));
  // Fixed values: the same on every machine and with every standard library.
  CHECK(split_clips(8, 0.5, 1) == std::vector<bool>{false, false, true, true, true, false, false, true});
  std::uint64_t state = 0;
  CHECK(splitmix64(state) == 0xE220A8397B1DCDAFu);  // the published first value for seed 0
  CHECK(split_clips(1, 0.67, 1) == std::vector<bool>{true});
  for (const double share : {0.01, 0.5, 1.0}) {
    const std::vector<bool> two = split_clips(2, share, 3);
    CHECK(two[0] != two[1]);
  }
  CHECK_THROWS_AS(split_clips(2, 0, 1), Error);
  CHECK_THROWS_AS(split_clips(2, 1.5, 1), Error);

  const Folder folder;
  a.write_split(folder.path / "split.tsv");
  const std::string text = read_text(folder.path / "split.tsv", "split");
  CHECK(text.starts_with("# split of 12 clips, seed 1, training share 0.67\n"));
  for (const DatasetClip& clip : a.test) CHECK(text.find("\ntest\t" + clip.id + "\n") != text.npos);
  for (const DatasetClip& clip : a.train) CHECK(text.find("\ntrain\t" + clip.id + "\n") != text.npos);
}

TEST_CASE("folders of BVH files") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path), doctest::Contains("no .bvh, .amc"), Error);
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path / "none"), doctest::Contains("does not exist"), Error);
  for (const char* name : {"a/walk.bvh", "b/walk.BVH", "jump_01.bvh", "b/run/07.bvh"}) {
    const fs::path path = folder.path / name;
    fs::create_directories(path.parent_path());
    Clip clip = to_clip(walk(3, 60, 1), "x");
    clip.channels.insert(clip.channels.begin(), clip.skeleton.channel_count(), 0.0);  // a T-pose
    ++clip.frames;
    for (std::size_t f = 1; f < clip.frames; ++f) clip.channels[f * 9 + 3] += 40.5;
    write_bvh(path, clip);
  }
  DatasetOptions options = eight_at(4);
  const Dataset named = Dataset::from_bvh(folder.path, options);
  std::set<std::string> all = ids(named.train);
  all.merge(ids(named.test));
  CHECK(all == std::set<std::string>{"a/walk", "b/walk", "jump_01", "07"});
  CHECK(named.named == 4);
  CHECK(named.dropped_frames == 4);
  for (const auto* part : {&named.train, &named.test})
    for (const DatasetClip& clip : *part) {
      CHECK(clip.frames == 180);
      CHECK(clip.captions[0] == (clip.id == "07" ? "run" : clip.id == "jump_01" ? "jump" : "walk"));
    }
  write_text_atomically(folder.path / "captions.tsv",
                        "walk\tgo ahead\nb/walk\tgo back\nb/walk\treturn\njump_01\tleap\n");
  options.captions = folder.path / "captions.tsv";
  options.clips.first_frame = FirstFrame::keep;
  const Dataset told = Dataset::from_bvh(folder.path, options);
  CHECK(told.named == 1);
  CHECK(told.dropped_frames == 0);
  for (const auto* part : {&told.train, &told.test})
    for (const DatasetClip& clip : *part) {
      CHECK(clip.frames == 181);
      if (clip.id == "b/walk") CHECK(clip.captions == std::vector<std::string>{"go back", "return"});
      if (clip.id == "a/walk") CHECK(clip.captions == std::vector<std::string>{"go ahead"});
    }
  CHECK(Dataset::from_bvh(folder.path / "jump_01.bvh", options).train.size() == 1);
  options.captions = folder.path / "missing.tsv";
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path, options),
                       doctest::Contains("missing.tsv does not exist"), Error);
  write_text_atomically(folder.path / "bad.bvh", "HIERARCHY\nNOISE");
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path, eight_at(4)),
                       doctest::Contains("bad.bvh:2:1: found 'NOISE'"), Error);
}

}  // namespace dataset_files_test
