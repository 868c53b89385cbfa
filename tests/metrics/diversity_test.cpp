// Diversity and multimodality, compared with numpy over all pairs.
#include "motiongan/metrics/diversity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace diversity_test {

using namespace motiongan;

namespace {

/// [8, 5]: sin(i j + 0.3 i i) + 0.03 j, counted from 1.
std::vector<float> features() {
  std::vector<float> out;
  for (int i = 1; i <= 8; ++i)
    for (int j = 1; j <= 5; ++j) out.push_back(static_cast<float>(std::sin(i * j + 0.3 * i * i) + 0.03 * j));
  return out;
}

}  // namespace

TEST_CASE("all pairs, if there are no more than requested: numpy's means") {
  CHECK(diversity(features(), 5, 28) == doctest::Approx(2.1071553342242493).epsilon(1e-6));
  CHECK(diversity(features(), 5) == doctest::Approx(2.1071553342242493).epsilon(1e-6));
  CHECK(multimodality(features(), 5, std::vector<std::size_t>{0, 0, 0, 0, 1, 1, 1, 1}) ==
        doctest::Approx(1.9826365104944854).epsilon(1e-6));
}

TEST_CASE("random pairs are close to that, seeded, and never pair a motion with itself") {
  double mean = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) mean += diversity(features(), 5, 20, seed) / 400;
  CHECK(std::abs(mean - 2.107155) < 0.02);
  CHECK(diversity(features(), 5, 20, 3) == diversity(features(), 5, 20, 3));
  CHECK(diversity(features(), 5, 20, 3) != diversity(features(), 5, 20, 4));
  // Three points at distances 3, 4 and 5: the mean is at least 3.
  const std::vector<float> triangle{0, 0, 3, 0, 0, 4};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) CHECK(diversity(triangle, 2, 1, seed) >= 3);
  CHECK(diversity(triangle, 2) == doctest::Approx(4));
}

TEST_CASE("multimodality compares motions within a description only") {
  const std::vector<float> two{0, 9, 0, 0, 9, 9};  // one feature each
  const std::vector<std::size_t> same{4, 7, 4, 4, 7, 7}, pairs{1, 5, 9, 1, 5, 2};
  CHECK(multimodality(two, 1, same) == 0);
  CHECK(multimodality(two, 1, pairs) == 0);
  CHECK(diversity(two, 1) == doctest::Approx(9 * 9 / 15.0));
  const std::vector<float> spread{0, 2, 9, 13};
  const std::vector<std::size_t> halves{0, 0, 1, 1}, most{3, 3, 3, 8};
  CHECK(multimodality(spread, 1, halves) == doctest::Approx(3));
  CHECK(multimodality(spread, 1, most) == doctest::Approx(6));  // 2, 9 and 7; a single motion is left out
}

TEST_CASE("sets without pairs and wrong sizes are rejected") {
  const std::vector<float> set{1, 2, 3, 4};
  CHECK_THROWS_WITH_AS(diversity(set, 4), doctest::Contains("at least 2"), Error);
  CHECK_THROWS_WITH_AS(diversity(set, 3), doctest::Contains("rows of 3"), Error);
  CHECK_THROWS_WITH_AS(diversity(set, 2, 0), doctest::Contains("pairs is 0"), Error);
  const std::vector<std::size_t> apart{0, 1}, three{0, 0, 0};
  CHECK_THROWS_WITH_AS(multimodality(set, 2, apart), doctest::Contains("none of 2 descriptions"), Error);
  CHECK_THROWS_WITH_AS(multimodality(set, 2, three), doctest::Contains("the descriptions of 3"), Error);
}

}  // namespace diversity_test
