// Captions of parts of clips in a data set.
#include "motiongan/data/caption_parts.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "../support/walking_clips.hpp"
#include "motiongan/formats/bvh.hpp"

namespace caption_parts_test {

using namespace motiongan;
using namespace motiongan::motion;
namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

namespace {

/// A temporary folder, removed at the end.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_caption_parts_test_" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& text) const {
    write_text_atomically(path / name, text);
  }
};

std::map<std::string, const DatasetClip*> clips_of(const Dataset& data) {
  std::map<std::string, const DatasetClip*> out;
  for (const auto* part : {&data.train, &data.test})
    for (const DatasetClip& clip : *part) out[clip.id] = &clip;
  return out;
}

constexpr double infinity = std::numeric_limits<double>::infinity();
using Frames = std::pair<std::size_t, std::size_t>;

}  // namespace

TEST_CASE("the frames of a part: begin <= t < end") {
  CHECK(frames_of_part({2, 4.5}, 20, 0, 200) == Frames{40, 90});
  CHECK(frames_of_part({2.3, 2.6}, 20, 0, 200) == Frames{46, 52});  // 2.3 * 20 is not exact
  CHECK(frames_of_part({0.31, 0.32}, 10, 0, 200) == Frames{4, 4});
  CHECK(frames_of_part({2, infinity}, 20, 0, 200) == Frames{40, 200});
  CHECK(frames_of_part({0, 1}, 20, 3, 197) == Frames{0, 17});
  CHECK(frames_of_part({20, 30}, 20, 0, 200) == Frames{200, 200});
}

TEST_CASE("parts cover a clip if no stretch as long as a window is left") {
  CHECK(parts_cover({{0, 5}, {5, 10}}, 0, 10, 1));
  CHECK(parts_cover({{6, infinity}, {0.5, 5.5}}, 0, 10, 1));
  CHECK(!parts_cover({{0, 5}, {6, 10}}, 0, 10, 1));
  CHECK(!parts_cover({{0, 9}}, 0, 10, 1));
  CHECK(!parts_cover({{0, 5}, {20, 30}}, 0, 10, 1));
  CHECK(parts_cover({{1, 10}}, 0.5, 10, 1));
}

TEST_CASE("a captioned part becomes a clip of its own") {
  const Folder folder;
  const auto make = [&](const std::string& name, double seconds, double start) {
    write_bvh(folder.path / name, to_clip(walk(seconds, 20, 1, start), "x"));
  };
  make("both.bvh", 10, 0);
  make("covered.bvh", 10, 1);
  make("partly.bvh", 10, 2);
  make("plain.bvh", 10, 3);
  folder.write("both.txt", "a walk\nthe start#x#0.0#4.0\nalso the start#x#0.0#4.0\ntail#x#7.5#nan\n");
  folder.write("covered.txt", "first#x#0.0#5.0\nsecond#x#5.0#10.0\n");
  folder.write("partly.txt", "middle#x#3.0#6.0\nshort#x#3.0#3.5\nlate#x#12.0#15.0\n");
  const DatasetOptions options{.frames = 8, .rate = 4};  // a window is 2 s
  const Dataset data = Dataset::from_bvh(folder.path, options);
  const auto clips = clips_of(data);
  std::string ids;
  for (const auto& [id, clip] : clips) ids += id + " ";
  CHECK(ids ==
        "both both@0.0-4.0 both@7.5-end covered@0.0-5.0 covered@5.0-10.0 partly partly@3.0-6.0 plain ");
  CHECK(clips.at("both")->captions == Texts{"a walk"});
  CHECK(clips.at("both@0.0-4.0")->captions == Texts{"the start", "also the start"});
  CHECK(clips.at("both@0.0-4.0")->frames == 80);
  CHECK(clips.at("both@7.5-end")->frames == 50);
  CHECK(clips.at("partly")->captions == Texts{"partly"});  // 0 to 3 s are in no part
  CHECK(clips.at("partly@3.0-6.0")->captions == Texts{"middle"});
  CHECK(clips.at("plain")->captions == Texts{"plain"});
  CHECK(data.parts == 5);
  CHECK(data.described_in_parts == 1);
  CHECK(data.named == 2);
  CHECK(data.captions.without == Texts{"plain"});
  REQUIRE(data.skipped.size() == 2);
  CHECK(data.skipped[0].id == "partly@3.0-3.5");
  CHECK(data.skipped[1].id == "partly@12.0-15.0");
  CHECK(data.skipped[1].reason.starts_with("outside its clip, 0.00 s long"));
  // The poses are those of the whole clip's frames, but for the root's track, which is relative in windows.
  const DatasetClip &whole = *clips.at("both"), &tail = *clips.at("both@7.5-end");
  const std::size_t dof = data.format.dof();
  std::vector<float> a(8 * dof), b(8 * dof);
  data.window(whole, 150 + 3, a);
  data.window(tail, 3, b);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == doctest::Approx(b[i]).epsilon(1e-4));
  // A clip and its parts are on the same side of the split.
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    DatasetOptions other = options;
    other.split_seed = seed;
    std::map<std::string, bool> side;
    const Dataset split = Dataset::from_bvh(folder.path, other);
    for (const auto* part : {&split.train, &split.test})
      for (const DatasetClip& clip : *part) {
        const bool is_train = part == &split.train;
        CHECK(side.emplace(clip.id.substr(0, clip.id.find('@')), is_train).first->second == is_train);
      }
    CHECK(side.size() == 4);
  }
}

TEST_CASE("times of a caption are finite, or nan for the clip's own") {
  CHECK(caption_detail::caption_of_line("a#x#nan#nan", "f:1").text == "a");
  for (const char* line : {"a#x#inf#nan", "a#x#0#inf", "a#x#1#infinity", "a#x#-inf#2"})
    CHECK_THROWS_WITH_AS(caption_detail::caption_of_line(line, "f:1"),
                         doctest::Contains("f:1: found the times"), Error);
}

TEST_CASE("a caption file takes precedence over text files; times count from the start of the file") {
  const Folder folder;
  Clip clip = to_clip(walk(6, 60, 1), "x");
  clip.channels.insert(clip.channels.begin(), clip.skeleton.channel_count(), 0.0);  // a T-pose
  ++clip.frames;
  for (std::size_t f = 1; f < clip.frames; ++f) clip.channels[f * 9 + 3] += 40.5;
  write_bvh(folder.path / "walk.bvh", clip);
  folder.write("walk.txt", "first half#x#0.0#3.0\nsecond half#x#3.0#nan\n");
  DatasetOptions options{.frames = 8, .rate = 4};
  const Dataset halves = Dataset::from_bvh(folder.path, options);
  const auto clips = clips_of(halves);
  REQUIRE(clips.size() == 2);
  CHECK(halves.dropped_frames == 1);
  CHECK(clips.at("walk@0.0-3.0")->frames == 179);
  CHECK(clips.at("walk@3.0-end")->frames == 181);
  options.captions = folder.path / "captions.json";
  folder.write("captions.json", R"({"Walk.bvh": ["go"], "fly": "up"})");
  const Dataset told = Dataset::from_bvh(folder.path, options);
  CHECK(told.train.front().captions == Texts{"go"});
  CHECK(told.captions.unmatched == Texts{"'fly'"});
  folder.write("captions.json", R"({"fly": "up"})");
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path, options),
                       doctest::Contains("no caption matches a clip"), Error);
  options = {.frames = 24, .rate = 4};
  folder.write("walk.txt", "a#x#0.0#3.0\nb#x#3.0#nan\n");
  CHECK_THROWS_WITH_AS(Dataset::from_bvh(folder.path, options),
                       doctest::Contains("captions describe parts of the clips, and none of these holds"),
                       Error);
}

TEST_CASE("a caption file for motions in memory") {
  const Folder folder;
  std::vector<LabelledMotion> motions = several(3);
  motions[0].captions = {"own"};
  motions[1].captions = {"own"};
  folder.write("c.csv", "id,caption\n" + motions[1].id + ".bvh,\"from, the file\"\nother,x\n");
  DatasetOptions options = eight_at(4);
  options.captions = folder.path / "c.csv";
  const Dataset data = Dataset::from_motions(motions, options);
  const auto clips = clips_of(data);
  CHECK(clips.at(motions[0].id)->captions == Texts{"own"});
  CHECK(clips.at(motions[1].id)->captions == Texts{"from, the file"});
  CHECK(data.captions.unmatched == Texts{"'other' (line 3)"});
  CHECK(data.captions.without.size() == 2);
}

}  // namespace caption_parts_test
