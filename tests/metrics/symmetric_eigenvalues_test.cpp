// Eigenvalues of symmetric matrices, against numpy and known values.
#include "motiongan/metrics/symmetric_eigenvalues.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace symmetric_eigenvalues_test {

using namespace motiongan;

TEST_CASE("eigenvalues equal numpy's (numpy.linalg.eigvalsh 1.24)") {
  constexpr std::size_t n = 12;
  std::vector<double> a(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) a[i * n + j] = std::sin(static_cast<double>((i + 1) * (j + 1)));
  const double expected[] = {-3.268720568353, -3.266539642945, -2.444236835895, -2.349201190734,
                             -2.333591798575, -1.710246131716, 1.587098187506,  1.718342995211,
                             2.348608465715,  2.427703633239,  2.444680549363,  3.2686687726};
  const std::vector<double> found = symmetric_eigenvalues(a, n);
  REQUIRE(found.size() == n);
  for (std::size_t i = 0; i < n; ++i) CHECK(found[i] == doctest::Approx(expected[i]).epsilon(1e-10));
}

TEST_CASE("matrices with known eigenvalues") {
  SUBCASE("the second-difference matrix: 2 - 2 cos(pi i / (n + 1))") {
    constexpr std::size_t n = 101;
    std::vector<double> a(n * n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      a[i * n + i] = 2;
      if (i > 0) a[i * n + i - 1] = a[(i - 1) * n + i] = -1;
    }
    const std::vector<double> found = symmetric_eigenvalues(a, n);
    for (std::size_t i = 0; i < n; ++i)
      CHECK(std::abs(found[i] - (2 - 2 * std::cos(std::numbers::pi * static_cast<double>(i + 1) / (n + 1)))) <
            1e-12);
  }
  SUBCASE("repeated eigenvalues, zeros, and size one") {
    CHECK(symmetric_eigenvalues({-7}, 1) == std::vector<double>{-7});
    CHECK(symmetric_eigenvalues(std::vector<double>(25, 0), 5) == std::vector<double>(5, 0));
    const std::vector<double> ones = symmetric_eigenvalues(std::vector<double>(36, 1), 6);  // rank one
    for (std::size_t i = 0; i < 5; ++i) CHECK(std::abs(ones[i]) < 1e-14);
    CHECK(ones[5] == doctest::Approx(6));
  }
}

TEST_CASE("invalid matrices are rejected") {
  CHECK_THROWS_WITH_AS(symmetric_eigenvalues({1, 2, 3}, 2), doctest::Contains("found 3 values"), Error);
  CHECK_THROWS_WITH_AS(symmetric_eigenvalues({1, NAN, NAN, 3}, 2), doctest::Contains("finite"), Error);
}

}  // namespace symmetric_eigenvalues_test
