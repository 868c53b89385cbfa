// Eigenvalues of symmetric matrices, on the host in double precision.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"

namespace motiongan {

namespace eigenvalues_detail {

/// Householder reduction: the diagonal and subdiagonal, [n] each (off[0] is unused), of a tridiagonal matrix
/// with the eigenvalues of `a` [n, n]. Both triangles of `a` are updated, so that all loops run along rows.
inline std::pair<std::vector<double>, std::vector<double>> tridiagonal(std::vector<double> a, std::size_t n) {
  std::vector<double> diagonal(n), off(n, 0), v(n), p(n);
  for (std::size_t last = n; last-- > 1;) {
    // Row `last` is reduced to its diagonal and one off-diagonal entry; [last, last] remains.
    double* const row = &a[last * n];
    diagonal[last] = row[last];
    double largest = 0, squares = 0;
    for (std::size_t i = 0; i < last; ++i) largest = std::max(largest, std::abs(row[i]));
    if (largest == 0) continue;  // already reduced
    for (std::size_t i = 0; i < last; ++i) {
      v[i] = row[i] / largest;
      squares += v[i] * v[i];
    }
    const double before = v[last - 1];
    const double mirrored = before >= 0 ? -std::sqrt(squares) : std::sqrt(squares);
    off[last] = largest * mirrored;
    v[last - 1] = before - mirrored;
    const double half = squares - before * mirrored;  // |v|^2 / 2
    double along = 0;
    for (std::size_t i = 0; i < last; ++i) {
      const double* const at = &a[i * n];
      double sum[4] = {0, 0, 0, 0};
      std::size_t j = 0;
      for (; j + 4 <= last; j += 4)
        for (std::size_t s = 0; s < 4; ++s) sum[s] += at[j + s] * v[j + s];
      for (; j < last; ++j) sum[0] += at[j] * v[j];
      p[i] = (sum[0] + sum[1] + sum[2] + sum[3]) / half;
      along += p[i] * v[i];
    }
    for (std::size_t i = 0; i < last; ++i) p[i] -= along / (2 * half) * v[i];
    for (std::size_t i = 0; i < last; ++i) {
      double* const at = &a[i * n];
      const double vi = v[i], pi = p[i];
      for (std::size_t j = 0; j < last; ++j) at[j] -= vi * p[j] + pi * v[j];
    }
  }
  diagonal[0] = a[0];
  return {std::move(diagonal), std::move(off)};
}

}  // namespace eigenvalues_detail

/// Eigenvalues, ascending, of a symmetric matrix [n, n], given in full: Householder reduction to a
/// tridiagonal matrix, then the implicit QL method with Wilkinson's shift (Golub & Van Loan, Matrix
/// Computations, 8.3). Errors are about 1e-15 of the largest eigenvalue. O(n^3): about a second for n = 1024.
/// Throws Error if the size does not fit, a value is not finite, or the iteration does not converge.
inline std::vector<double> symmetric_eigenvalues(const std::vector<double>& matrix, std::size_t n) {
  require(n > 0 && matrix.size() == n * n, "found ", matrix.size(),
          " values of a symmetric matrix, expected ", n, " x ", n, ", and at least one");
  for (const double x : matrix)
    require(std::isfinite(x), "a symmetric matrix holds ", x, ", expected finite values");
  auto [d, e] = eigenvalues_detail::tridiagonal(matrix, n);
  e.erase(e.begin());  // e[i] is now between d[i] and d[i + 1]
  e.push_back(0);
  double size = 0;
  for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::abs(d[i]) + std::abs(e[i]));
  for (std::size_t first = 0; first < n; ++first) {
    for (int sweeps = 0;; ++sweeps) {
      std::size_t end = first;  // last index of the unreduced block that starts at `first`
      while (end + 1 < n &&
             std::abs(e[end]) > std::numeric_limits<double>::epsilon() *
                                    std::max(std::abs(d[end]) + std::abs(d[end + 1]), 1e-3 * size))
        ++end;
      if (end == first) break;
      require(sweeps < 100, "the eigenvalues of a symmetric matrix of size ", n, " did not converge in ",
              sweeps, " sweeps");
      const double g0 = (d[first + 1] - d[first]) / (2 * e[first]);
      const double root = std::hypot(g0, 1.0);
      double g = d[end] - d[first] + e[first] / (g0 + std::copysign(root, g0));
      double sine = 1, cosine = 1, p = 0;
      bool split = false;
      for (std::size_t i = end; i-- > first;) {
        const double f = sine * e[i], b = cosine * e[i];
        const double r = std::hypot(f, g);
        e[i + 1] = r;
        if (r == 0) {  // the block splits here
          d[i + 1] -= p;
          e[end] = 0;
          split = true;
          break;
        }
        sine = f / r;
        cosine = g / r;
        g = d[i + 1] - p;
        const double t = (d[i] - g) * sine + 2 * cosine * b;
        p = sine * t;
        d[i + 1] = g + p;
        g = cosine * t - b;
      }
      if (split) continue;
      d[first] -= p;
      e[first] = g;
      e[end] = 0;
    }
  }
  std::sort(d.begin(), d.end());
  return std::move(d);
}

}  // namespace motiongan
