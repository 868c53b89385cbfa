// BVH written in pieces.
#include "motiongan/formats/bvh_stream.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string>

#include "../support/walking_clips.hpp"
#include "motiongan/formats/bvh.hpp"

namespace bvh_stream_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// 500 frames in which the hips make whole turns, so that angles pass through possible jumps.
Motion turning() {
  Motion m = walk(500.0 / 60, 60, 1.3);
  for (std::size_t f = 0; f < m.frames; ++f)
    m.rotation(f, 0) = quat_from_expmap({0.1, 0.05 * static_cast<double>(f), 0.2 * std::sin(double(f))});
  return m;
}

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "motiongan_bvh_stream_test";
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path), std::filesystem::directory_iterator()));
  }
};

}  // namespace

TEST_CASE("pieces of any size give the file of the whole, byte for byte") {
  const Folder folder;
  const Motion m = turning();
  write_bvh(folder.path / "whole.bvh", m);
  const std::string whole = read_text(folder.path / "whole.bvh", "BVH file");
  for (const std::size_t size : {1, 7, 64, 500}) {
    const auto path = folder.path / "pieces.bvh";
    BvhStreamWriter out(path, m.skeleton, m.rate, m.frames);
    for (std::size_t f = 0; f < m.frames; f += size) out.append(slice(m, f, std::min(size, m.frames - f)));
    CHECK(out.written() == 500);
    out.finish();
    CHECK(read_text(path, "BVH file") == whole);
  }
  CHECK(folder.files() == 2);
  BvhStreamWriter empty(folder.path / "empty.bvh", m.skeleton, m.rate, 0);
  empty.finish();
  CHECK(read_bvh(folder.path / "empty.bvh").frames == 0);
}

TEST_CASE("without finish nothing is left behind, and the old file stays") {
  const Folder folder;
  const auto path = folder.path / "walk.bvh";
  write_text_atomically(path, "old");
  {
    BvhStreamWriter out(path, turning().skeleton, 60, 500);
    out.append(slice(turning(), 0, 100));
    CHECK(folder.files() == 2);
    CHECK_THROWS_WITH_AS(out.finish(), doctest::Contains("has 100 frames, expected the 500 announced"),
                         Error);
  }
  CHECK(folder.files() == 1);
  CHECK(read_text(path, "file") == "old");
}

TEST_CASE("a piece that does not fit is rejected, and writing continues as if it had not been appended") {
  const Folder folder;
  const Motion m = turning();
  write_bvh(folder.path / "whole.bvh", m);
  const auto path = folder.path / "walk.bvh";
  BvhStreamWriter out(path, m.skeleton, m.rate, m.frames);
  out.append(slice(m, 0, 300));
  CHECK_THROWS_WITH_AS(out.append(slice(m, 0, 201)),
                       doctest::Contains("201 frames were appended to BVH 'walk' after 300"), Error);
  Motion bad = slice(m, 0, 5);
  bad.position(3, 0)[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH_AS(out.append(bad), doctest::Contains("clip 'walk', frame 304, channel 2 is"), Error);
  bad = slice(m, 0, 5);
  bad.rate = 30;
  CHECK_THROWS_WITH_AS(out.append(bad), doctest::Contains("30 frames per second"), Error);
  bad = slice(m, 0, 1);
  bad.skeleton.joints.pop_back();
  bad.rotations.pop_back();
  bad.positions.pop_back();
  CHECK_THROWS_WITH_AS(out.append(bad), doctest::Contains("a motion of 1 joints"), Error);
  out.append(slice(m, 300, 200));
  out.finish();
  CHECK(read_text(path, "BVH file") == read_text(folder.path / "whole.bvh", "BVH file"));
  CHECK_THROWS_WITH_AS(out.append(slice(m, 0, 0)), doctest::Contains("is finished"), Error);
  CHECK_THROWS_WITH_AS(out.finish(), doctest::Contains("is finished already"), Error);

  CHECK_THROWS_WITH_AS(BvhStreamWriter(path, m.skeleton, 0, 5), doctest::Contains("rate of 0"), Error);
  CHECK_THROWS_WITH_AS(BvhStreamWriter(path, Skeleton{}, 10, 0), doctest::Contains("without joints"), Error);
  CHECK_THROWS_WITH_AS(BvhStreamWriter(folder.path / "no" / "walk.bvh", m.skeleton, 10, 5),
                       doctest::Contains("cannot open"), Error);
  CHECK(folder.files() == 2);
}

}  // namespace bvh_stream_test
