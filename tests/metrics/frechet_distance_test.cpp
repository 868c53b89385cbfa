// The Frechet distance, against numpy and by hand.
#include "motiongan/metrics/frechet_distance.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace frechet_distance_test {

using namespace motiongan;

namespace {

/// [n, k]: sin(a i j + b i i) + 0.1 b j, counted from 1, as in the numpy reference.
std::vector<float> features(std::size_t n, std::size_t k, double a, double b) {
  std::vector<float> out;
  for (std::size_t i = 1; i <= n; ++i)
    for (std::size_t j = 1; j <= k; ++j) {
      const double x = static_cast<double>(i), y = static_cast<double>(j);
      out.push_back(static_cast<float>(std::sin(a * x * y + b * x * x) + 0.1 * y * b));
    }
  return out;
}

}  // namespace

// Reference values from numpy 1.24: trace of the square root by eigh(S1)^(1/2) and eigvalsh of S1^(1/2) S2
// S1^(1/2); scipy's sqrtm of S1 S2 gives the same, to 1e-12 for full rank and 1e-7 where a covariance is
// singular.
TEST_CASE("distances equal numpy's, with enough samples and with too few") {
  SUBCASE("more samples than dimensions") {
    const FrechetDistance d = frechet_distance(features(60, 6, 1, 0.3), features(50, 6, 0.7, 0.5), 6);
    CHECK(d.distance == doctest::Approx(0.14845276939860064).epsilon(1e-6));
    CHECK(d.means == doctest::Approx(0.07448956525685124).epsilon(1e-6));
    CHECK_FALSE(d.biased());
    CHECK(d.samples1 == 60);
    CHECK(d.samples2 == 50);
  }
  SUBCASE("fewer in both sets, and in one of them, in either order") {
    const auto few = features(9, 20, 1, 0.3), some = features(12, 20, 0.7, 0.5),
               many = features(70, 20, 0.7, 0.5);
    const FrechetDistance d = frechet_distance(few, some, 20);
    CHECK(d.distance == doctest::Approx(13.438782305934074).epsilon(1e-7));
    CHECK(d.biased());
    CHECK(frechet_distance(few, many, 20).distance == doctest::Approx(11.93774825352665).epsilon(1e-7));
    CHECK(frechet_distance(many, few, 20).distance == doctest::Approx(11.93774825352665).epsilon(1e-7));
    CHECK(frechet_distance(many, few, 20).biased());
  }
}

TEST_CASE("known distances") {
  SUBCASE("a set and itself, at any rank") {
    for (const std::size_t n : {5u, 40u}) {
      const auto set = features(n, 12, 1, 0.3);
      CHECK(frechet_distance(set, set, 12).distance < 1e-6);
    }
  }
  SUBCASE("one dimension: (mu1 - mu2)^2 + (s1 - s2)^2") {
    // Means 2 and 7, deviations 1 and 3.
    const std::vector<float> one{1, 2, 3}, two{4, 7, 10};
    CHECK(frechet_distance(one, two, 1).distance == doctest::Approx(25 + 4));
  }
  SUBCASE("translated sets and constant sets differ by their means") {
    auto set = features(40, 3, 1, 0.3);
    const auto before = set;
    for (std::size_t i = 0; i < set.size(); i += 3) set[i] += 2;
    CHECK(frechet_distance(before, set, 3).distance == doctest::Approx(4).epsilon(1e-5));
    const std::vector<float> still{1, 5, 1, 5}, there{1, 8, 1, 8};
    CHECK(frechet_distance(still, there, 2).distance == doctest::Approx(9));
  }
  SUBCASE("orthogonal directions: the traces add up") {
    const std::vector<float> along_x{-1, 0, 1, 0}, along_y{0, -2, 0, 2};  // variances 2 and 8
    CHECK(frechet_distance(along_x, along_y, 2).distance == doctest::Approx(10));
  }
}

TEST_CASE("sets that cannot be compared are rejected") {
  const std::vector<float> set{1, 2, 3, 4}, one{1, 2}, odd{1, 2, 3}, wrong{1, NAN, 2, 3};
  CHECK_THROWS_WITH_AS(frechet_distance(set, one, 2), doctest::Contains("the second set has 1 samples"),
                       Error);
  CHECK_THROWS_WITH_AS(frechet_distance(odd, set, 2), doctest::Contains("the first set has 3 values"), Error);
  CHECK_THROWS_WITH_AS(frechet_distance(wrong, set, 2), doctest::Contains("finite"), Error);
}

}  // namespace frechet_distance_test
