// Distances of generative search, against plain loops and for clips that contain a hypothesis.
#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "../support/precision.hpp"
#include "../support/thread_ranks.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/data/dataset_build.hpp"
#include "motiongan/procedural/procedural.hpp"
#include "motiongan/search/ranking.hpp"

namespace distance_test {

using namespace motiongan;
using motion::RootRotation;

namespace {

motion::MotionFormat format_of(std::size_t frames, RootRotation rotation, bool position) {
  motion::DatasetOptions options;
  options.frames = frames;
  options.rate = 10;
  options.root_rotation = rotation;
  options.root_position = position;
  return motion::Dataset::from_motions(motion::procedural_motions({.clips = 4, .seconds = 5}), options)
      .format;
}

std::vector<float> normals(std::size_t count, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal;
  std::vector<float> out(count);
  for (float& value : out) value = normal(generator);
  return out;
}

/// Random hypotheses, relative to their first frame like windows.
std::vector<std::vector<float>> random_hypotheses(const motion::MotionFormat& format, std::size_t count,
                                                  unsigned seed) {
  std::vector<std::vector<float>> out;
  for (std::size_t h = 0; h < count; ++h) {
    out.push_back(normals(format.frames * format.dof(), seed + static_cast<unsigned>(h)));
    format.make_relative(std::span<float>(out.back()));
  }
  return out;
}

/// The definition, evaluated shift by shift.
std::pair<double, int> best_of(const motion::MotionFormat& format, const std::vector<float>& window,
                               const std::vector<float>& hypothesis) {
  std::pair<double, int> best{std::numeric_limits<double>::infinity(), 0};
  const int reach = static_cast<int>(search_reach(format.frames));
  for (int shift = -reach; shift <= reach; ++shift)
    if (const double d = search_distance(format, window, hypothesis, shift); d < best.first)
      best = {d, shift};
  return best;
}

}  // namespace

TEST_CASE("the definition: two frames of one dimension, by hand") {
  motion::MotionFormat format;
  motion::Skeleton skeleton;
  skeleton.joints = {{"Hips", -1, {0, 0, 0}, {motion::Channel::x_rotation}, {}}};
  format.layout = motion::PoseLayout(skeleton, false);
  format.normalizer = motion::Normalizer({0, 0, 0}, {1, 0, 0});
  format.rate = 1;
  format.frames = 2;
  const std::vector<float> window{1, 2}, hypothesis{4, 1};
  CHECK(search_distance(format, window, hypothesis, 0) == doctest::Approx(std::sqrt((9.0 + 1.0) / 2)));
  CHECK(search_distance(format, window, hypothesis, 1) == doctest::Approx(2));   // 2 against 4
  CHECK(search_distance(format, window, hypothesis, -1) == doctest::Approx(0));  // 1 against 1
  CHECK_THROWS_WITH_AS(search_distance(format, window, hypothesis, 2), doctest::Contains("leaves no overlap"),
                       Error);
  CHECK_THROWS_WITH_AS(search_distance(format, window, {}, 0), doctest::Contains("cannot be compared"),
                       Error);
}

TEST_CASE("the device agrees with plain loops over frames, dimensions and shifts") {
  struct Case {
    std::size_t frames, windows, hypotheses, chunk;
    RootRotation rotation;
    bool position;
  };
  const std::vector<Case> cases{
      {8, 7, 3, 0, RootRotation::heading, true},  {9, 5, 17, 2, RootRotation::heading, true},
      {7, 1, 1, 0, RootRotation::velocity, true}, {5, 6, 33, 4, RootRotation::expmap, true},
      {6, 3, 2, 3, RootRotation::expmap, false},  {2, 4, 5, 0, RootRotation::heading, true},
      {1, 3, 2, 0, RootRotation::heading, true}};
  for (const Precision precision : testing::precisions()) {
    ContextOptions options;
    options.precision = precision;
    const Context context(options);
    for (const Case& c : cases) {
      CAPTURE(c.frames);
      CAPTURE(c.windows);
      // A data set cannot make windows of one frame, so the format of two is used.
      motion::MotionFormat format = format_of(std::max<std::size_t>(2, c.frames), c.rotation, c.position);
      format.frames = c.frames;
      const std::size_t hop = std::max<std::size_t>(1, c.frames / 2), rows = c.windows * hop + c.frames;
      SearchFrames frames;
      frames.add(SearchLayout(format), normals(rows * format.dof(), 7));
      std::vector<std::size_t> starts;
      for (std::size_t w = 0; w < c.windows; ++w) starts.push_back(w * hop);
      const auto hypotheses = random_hypotheses(format, c.hypotheses, 100);
      const SearchWindows search(context, format, frames, starts, {.chunk = c.chunk});
      const WindowDistances found = search(hypotheses);
      REQUIRE(found.distance.size() == c.windows * c.hypotheses);
      const double tolerance = precision == Precision::f64 ? 1e-6 : 1e-3;
      for (std::size_t w = 0; w < c.windows; ++w)
        for (std::size_t h = 0; h < c.hypotheses; ++h) {
          const std::vector<float> window =
              frames.window(format, SearchLayout(format), starts[w], format.frames);
          const auto [distance, shift] = best_of(format, window, hypotheses[h]);
          const std::size_t at = w * c.hypotheses + h;
          CHECK(std::abs(found.distance[at] - distance) < tolerance);
          CHECK(std::abs(search_distance(format, window, hypotheses[h], found.shift[at]) - distance) <
                tolerance);
          if (precision == Precision::f64) CHECK(found.shift[at] == shift);
        }
    }
  }
}

TEST_CASE("a clip that contains a hypothesis is found at its shift, whatever its position and heading") {
  const Context context;
  for (const RootRotation rotation : {RootRotation::heading, RootRotation::expmap, RootRotation::velocity}) {
    const motion::MotionFormat format = format_of(16, rotation, true);
    const SearchLayout layout(format);
    const std::size_t dof = format.dof(), n = format.frames;
    const auto hypotheses = random_hypotheses(format, 4, 5);
    for (const int shift : {-8, -3, 0, 1, 8}) {
      CAPTURE(shift);
      // Frame t of hypothesis 2 on frame t + shift of the second window.
      std::vector<float> clip = normals(3 * n * dof, 9);
      const auto first = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + shift);
      std::copy(hypotheses[2].begin(), hypotheses[2].end(),
                clip.begin() + static_cast<std::ptrdiff_t>(first * dof));
      if (const auto turning = format.turning()) {  // another position and heading
        const double yaw = 2.5;
        for (std::size_t t = 0; t < n; ++t) {
          float* const pose = &clip[(first + t) * dof];
          double x = static_cast<double>(pose[turning->x]), z = static_cast<double>(pose[turning->z]);
          motion::turn_ground(x, z, yaw);
          pose[turning->x] = static_cast<float>(x + 3), pose[turning->z] = static_cast<float>(z - 4);
          pose[turning->yaw] += static_cast<float>(yaw / turning->yaw_scale);
        }
      } else {
        for (std::size_t t = 0; t < n; ++t)
          for (const std::size_t k : format.relative_dims) clip[(first + t) * dof + k] += 5;
      }
      SearchFrames frames;
      frames.add(layout, clip);
      const SearchWindows search(context, format, frames, {0, n, 2 * n});
      const WindowDistances found = search(hypotheses);
      const std::size_t at = 1 * 4 + 2;
      CHECK(found.shift[at] == shift);
      CHECK(found.distance[at] < 3e-3);
      CHECK(search_distance(format, frames.window(format, layout, n, n), hypotheses[2], shift) < 1e-5);
      for (std::size_t h = 0; h < 4; ++h)
        if (h != 2) CHECK(found.distance[4 + h] > 0.3);
    }
  }
}

TEST_CASE("equal queries give equal bits, whatever the chunk and whether spectra are kept") {
  const Context context;
  const motion::MotionFormat format = format_of(12, RootRotation::heading, true);
  SearchFrames frames;
  frames.add(SearchLayout(format), normals(200 * format.dof(), 3));
  std::vector<std::size_t> starts;
  for (std::size_t s = 0; s + 12 <= 200; s += 5) starts.push_back(s);
  const auto hypotheses = random_hypotheses(format, 16, 1);
  const SearchWindows one(context, format, frames, starts);
  const WindowDistances a = one(hypotheses), b = one(hypotheses);
  const WindowDistances c =
      SearchWindows(context, format, frames, starts, {.chunk = 7, .keep_bytes = 0})(hypotheses);
  CHECK(a.distance == b.distance);
  CHECK(a.distance == c.distance);
  CHECK(a.shift == c.shift);
  CHECK(one.kept_bytes() > 0);
  // A query in between has no effect.
  const auto others = random_hypotheses(format, 3, 50);
  CHECK(one(others).distance.size() == 3 * starts.size());
  CHECK(one(hypotheses).distance == a.distance);
}

TEST_CASE("ranks that compare a share of the windows each find what one finds") {
  const motion::MotionFormat format = format_of(12, RootRotation::heading, true);
  SearchIndex index(format);
  for (std::size_t i = 0; i < 3; ++i) {
    SearchClip clip;
    clip.path = concat("clip", i, ".bvh");
    clip.frames = 40 + 13 * i;
    index.add(clip, normals(clip.frames * format.dof(), 3 + static_cast<unsigned>(i)));
  }
  const auto hypotheses = random_hypotheses(format, 5, 1);
  const SearchOptions every{.top = 1000, .hop = 5, .every_window = true};
  const SearchRanking alone = rank_clips(Context(), index, hypotheses, every);
  REQUIRE(alone.hits.size() == alone.windows);
  REQUIRE(alone.windows > 10);
  for (const std::size_t ranks : {2, 3, 64})  // 64: more than windows
    testing::on_ranks(ranks, [&](const std::shared_ptr<Communicator>& own) {
      const SearchRanking shared = rank_clips(Context(), index, hypotheses, every, own.get());
      bool same = shared.median == alone.median && shared.hits.size() == alone.hits.size();
      for (std::size_t i = 0; same && i < alone.hits.size(); ++i)
        same = shared.hits[i].window.clip == alone.hits[i].window.clip &&
               shared.hits[i].window.frame == alone.hits[i].window.frame &&
               shared.hits[i].nearest[1].shift == alone.hits[i].nearest[1].shift &&
               shared.hits[i].nearest[1].distance == alone.hits[i].nearest[1].distance;
      require(same, "rank ", own->rank(), " of ", ranks, " found something else");
    });
}

TEST_CASE("invalid searches are rejected") {
  const Context context;
  const motion::MotionFormat format = format_of(8, RootRotation::heading, true);
  SearchFrames frames;
  frames.add(SearchLayout(format), normals(20 * format.dof(), 3));
  CHECK_THROWS_WITH_AS(SearchWindows(context, format, frames, {0, 13}),
                       doctest::Contains("starts at frame 13 of 20"), Error);
  const SearchWindows search(context, format, frames, {0, 12});
  CHECK_THROWS_WITH_AS(search({}), doctest::Contains("at least one hypothesis"), Error);
  CHECK_THROWS_WITH_AS(search({{1, 2}}), doctest::Contains("hypothesis 0 has 2 values"), Error);
  const SearchWindows none(context, format, frames, {});
  CHECK(none(random_hypotheses(format, 1, 1)).distance.empty());
}

}  // namespace distance_test
