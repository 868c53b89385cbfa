// Conversion of clips to windows.
#include "motiongan/data/dataset.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../support/walking_clips.hpp"

namespace dataset_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("windows: stride, starts, relative dimensions, and conversion back to motion") {
  const std::vector<LabelledMotion> motions = several(6);
  const Dataset data = Dataset::from_motions(motions, eight_at(4));
  CHECK(data.stride == 15);
  REQUIRE(data.train.size() == 4);
  REQUIRE(data.test.size() == 2);
  const auto& kept = data.format.normalizer.kept();
  CHECK(kept == std::vector<std::size_t>{1, 3, 6, 7});  // Hips.y, Arm.x, position x and y; z never changes
  CHECK(data.format.relative_dims == std::vector<std::size_t>{2});
  CHECK(data.format.normalizer.mean()[6] == 0);
  CHECK(data.format.normalizer.mean()[8] == 0);

  const DatasetClip& clip = data.train[1];
  CHECK(data.starts(clip) == clip.frames - 7 * 15);
  const Motion& source = motions[static_cast<std::size_t>(clip.id.back() - '0')].motion;
  std::vector<float> window(8 * 4);
  for (const std::size_t start : {std::size_t{0}, std::size_t{17}, data.starts(clip) - 1}) {
    data.window(clip, start, window);
    CHECK(window[2] == 0.0f);
    const Motion motion = data.to_motion(window);
    CHECK(motion.frames == 8);
    CHECK(motion.rate == 4);
    CHECK(motion.skeleton == source.skeleton);
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t at = start + 15 * i;
      for (std::size_t j = 0; j < 2; ++j)
        CHECK(angle_between(motion.rotation(i, j), source.rotation(at, j)) < 1e-6);
      CHECK(std::abs(motion.position(i, 0)[0] - (source.position(at, 0)[0] - source.position(start, 0)[0])) <
            1e-5);
      CHECK(std::abs(motion.position(i, 0)[1] - source.position(at, 0)[1]) < 1e-5);
      CHECK(motion.position(i, 0)[2] == 0);
    }
  }
  CHECK_THROWS_WITH_AS(data.window(clip, data.starts(clip), window), doctest::Contains("window start"),
                       Error);
  CHECK_THROWS_WITH_AS(data.window(clip, 0, std::span(window).first(31)), doctest::Contains("room for 31"),
                       Error);
}

TEST_CASE("statistics are those of the training clips") {
  const Dataset data = Dataset::from_motions(several(6), eight_at(4));
  std::vector<double> sum(4), squares(4);
  double rows = 0;
  for (const DatasetClip& clip : data.train) {
    for (std::size_t f = 0; f < clip.frames; ++f, ++rows)
      for (std::size_t k = 0; k < 4; ++k) {
        sum[k] += clip.poses[f * 4 + k];
        squares[k] += double(clip.poses[f * 4 + k]) * clip.poses[f * 4 + k];
      }
  }
  for (const std::size_t k : {0, 1, 3}) {
    CHECK(std::abs(sum[k] / rows) < 1e-5);
    CHECK(std::abs(squares[k] / rows - 1) < 1e-4);
  }
  // The relative dimension has mean square 1 over all windows.
  double total = 0, count = 0;
  std::vector<float> window(8 * 4);
  for (const DatasetClip& clip : data.train)
    for (std::size_t s = 0; s < data.starts(clip); ++s) {
      data.window(clip, s, window);
      for (std::size_t i = 0; i < 8; ++i, ++count) total += double(window[i * 4 + 2]) * window[i * 4 + 2];
    }
  CHECK(std::abs(total / count - 1) < 1e-4);
}

TEST_CASE("rates that are multiples, that are not, that are too low, and that differ") {
  const auto stride_of = [](std::vector<double> rates, double rate) {
    std::vector<LabelledMotion> motions;
    for (const double r : rates)
      motions.push_back({"at " + std::to_string(motions.size()), walk(10, r, 1), {"walk"}});
    return Dataset::from_motions(motions, eight_at(rate));
  };
  CHECK(stride_of({120}, 4).stride == 30);
  const Dataset odd = stride_of({120}, 12.5);
  CHECK(odd.stride == 9);
  CHECK(odd.train[0].frames == 1125);  // 1199 frames of 1/120 s at 112.5 per second, from 0
  CHECK(stride_of({30}, 30).stride == 1);
  const Dataset slow = stride_of({10}, 25);
  CHECK(slow.stride == 1);
  CHECK(slow.train[0].frames == 248);  // 9.9 s
  const Dataset mixed = stride_of({120, 60, 30}, 4);
  CHECK(mixed.stride == 7);  // 30 per second gives 28 = 7 x 4; the others follow
  CHECK(mixed.train.size() + mixed.test.size() == 3);
  for (const auto* part : {&mixed.train, &mixed.test})
    for (const DatasetClip& clip : *part) CHECK(std::abs(double(clip.frames) - 280) < 2);
  const Dataset pair = stride_of({120, 60}, 4);
  CHECK(pair.stride == 15);
  CHECK(natural_stride(120.00001, 4) == 30);
  CHECK(natural_stride(119.9, 4) == 29);
  CHECK(natural_stride(3, 4) == 1);
}

TEST_CASE("short clips are skipped and listed; if all are too short, the error suggests what would fit") {
  auto motions = several(3);
  motions.push_back({"short", walk(1.9, 60, 1), {"walk"}});
  motions.push_back({"just", walk(2, 60, 1), {"walk"}});
  const Dataset data = Dataset::from_motions(motions, eight_at(4));
  REQUIRE(data.skipped.size() == 1);
  CHECK(data.skipped[0].id == "short");
  CHECK(data.skipped[0].reason == "1.90 s long, a window of 8 frames at 4 per second is 2.00 s");
  CHECK(data.train.size() + data.test.size() == 4);
  DatasetOptions long_windows = eight_at(1);
  CHECK_THROWS_WITH_AS(
      Dataset::from_motions(motions, long_windows),
      doctest::Contains("the longest, 'clip2', has 4.20 s: use at most 4 frames, or 1.91 frames"), Error);
}

TEST_CASE("captions become sentences of the training vocabulary") {
  const Dataset data = Dataset::from_motions(several(6), eight_at(4));
  const Vocabulary& v = data.format.vocabulary;
  for (const DatasetClip& clip : data.train) {
    REQUIRE(clip.sentences.size() == 2);
    for (const int word : clip.sentences[0]) CHECK(word > 0);
    CHECK(clip.sentences[1] == std::vector<int>{v.find("go")});
  }
  for (const DatasetClip& clip : data.test) CHECK(clip.sentences[0].back() == 0);  // its number is unknown
  auto motions = several(2);
  motions[1].captions = {"..."};
  CHECK_THROWS_WITH_AS(Dataset::from_motions(motions, eight_at(4)),
                       doctest::Contains("'clip1' has the caption '...'"), Error);
  motions[1].captions = {"walk"};
  CHECK(Dataset::from_motions(motions, eight_at(4)).notes.empty());
  for (int i = 0; i < 300; ++i) motions[1].captions[0] += " on";
  const Dataset cut = Dataset::from_motions(motions, eight_at(4));
  CHECK(cut.notes ==
        std::vector<std::string>{"clip 'clip1': its caption has 301 words, of which the first 256 are used"});
  motions[1].captions = {};
  CHECK(Dataset::from_motions(motions, eight_at(4)).named == 1);
}

TEST_CASE("clips must share one skeleton, but not bone lengths") {
  auto motions = several(3);
  motions[1].motion.skeleton.joints[1].offset = {1.4, 0, 0};
  CHECK(Dataset::from_motions(motions, eight_at(4)).format.skeleton().joints[1].offset == Vec3{1, 0, 0});
  motions[2].motion.skeleton.joints[1].name = "Leg";
  CHECK_THROWS_WITH_AS(
      Dataset::from_motions(motions, eight_at(4)),
      doctest::Contains("the clips have 2 different skeletons:\n  2 clips of 2 joints: 'clip0', 'clip1'\n  1 "
                        "clip of 2 joints: 'clip2'; compared with the first: 'Arm' is called 'Leg'"),
      Error);
  motions = several(2);
  motions[1].motion.skeleton.joints[1].channels.pop_back();
  CHECK(Dataset::from_motions(motions, eight_at(4)).format.skeleton() == motions[0].motion.skeleton);
  motions = several(2);
  Motion& more = motions[1].motion;
  more.skeleton.joints.push_back({"Tail", 0, {0, 0, 1}, {}, {}});
  more.rotations.assign(more.frames * 3, Quat{});
  more.positions.assign(more.frames * 3, Vec3{});
  CHECK_THROWS_WITH_AS(Dataset::from_motions(motions, eight_at(4)), doctest::Contains("'Tail' is extra"),
                       Error);
  motions = several(2);
  motions[1].id = "clip0";
  CHECK_THROWS_WITH_AS(Dataset::from_motions(motions, eight_at(4)),
                       doctest::Contains("two clips are called 'clip0'"), Error);
  CHECK_THROWS_AS(Dataset::from_motions({}, eight_at(4)), Error);
  CHECK_THROWS_AS(Dataset::from_motions(several(2), eight_at(0)), Error);
  DatasetOptions none = eight_at(4);
  none.frames = 0;
  CHECK_THROWS_AS(Dataset::from_motions(several(2), none), Error);
}

TEST_CASE("without root position, and with clips in which nothing moves") {
  DatasetOptions options = eight_at(4);
  options.root_position = false;
  const Dataset data = Dataset::from_motions(several(3), options);
  CHECK(data.format.layout.dof() == 6);
  CHECK(data.format.relative_dims.empty());
  Motion still = walk(4, 60, 0);
  still.rotations.assign(still.rotations.size(), Quat{});
  still.positions.assign(still.positions.size(), Vec3{});
  CHECK_THROWS_WITH_AS(Dataset::from_motions({{"still", still, {"stand"}}}, eight_at(4)),
                       doctest::Contains("nothing moves"), Error);
}

TEST_CASE("the position of the travelling joint is kept, whichever clip shows it") {
  std::vector<LabelledMotion> motions;
  for (int i = 0; i < 3; ++i) {
    Motion m = walk(4, 60, i == 0 ? 0 : 1);
    if (i == 0) m.positions.assign(m.positions.size(), Vec3{0, 1, 5});
    Motion under;  // below a world joint at rest
    under.rate = m.rate;
    under.frames = m.frames;
    under.skeleton.joints = {{"World", -1, {0, 0, 0}, {}, {}}, m.skeleton.joints[0], m.skeleton.joints[1]};
    under.skeleton.joints[1].parent = 0;
    under.skeleton.joints[2].parent = 1;
    for (std::size_t f = 0; f < m.frames; ++f) {
      under.rotations.insert(under.rotations.end(), {Quat{}, m.rotation(f, 0), m.rotation(f, 1)});
      under.positions.insert(under.positions.end(), {Vec3{}, m.position(f, 0), m.position(f, 1)});
    }
    motions.push_back({"clip" + std::to_string(i), under, {"walk"}});
  }
  const Dataset data = Dataset::from_motions(motions, eight_at(4));
  CHECK(data.format.layout.root() == 1);
  CHECK(data.format.layout.name(data.format.layout.position_dim()) == "Hips.position.x");
}

}  // namespace dataset_test
