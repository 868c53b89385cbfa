// Frechet distance between two sets of features (FID).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/metrics/symmetric_eigenvalues.hpp"

namespace motiongan {

/// A Frechet distance and the sizes it was computed from.
struct FrechetDistance {
  double distance = 0;  ///< in squared units of the features; 0 for equal means and covariances
  double means = 0;     ///< its term ||mu1 - mu2||^2; the rest comes from the covariances
  std::size_t samples1 = 0, samples2 = 0, dimensions = 0;

  /// Whether a set has no more samples than dimensions. Its covariance is then rank-deficient and the
  /// distance too large, by an amount that depends on the number of samples (Chong & Forsyth 2020): compare
  /// such distances only between sets of equal sizes.
  bool biased() const { return std::min(samples1, samples2) <= dimensions; }
};

namespace frechet_detail {

/// a b^T, [rows of a, rows of b], of row-major `a` and `b` with `width` columns. `same` states that a and b
/// are one matrix; then only half of the product is computed.
inline std::vector<double> times_transposed(std::span<const double> a, std::span<const double> b,
                                            std::size_t width, bool same = false) {
  constexpr std::size_t tile = 4, depth = 256;  // 4 x 4 sums at a time, over blocks that fit the cache
  const std::size_t n = a.size() / width, m = b.size() / width;
  std::vector<double> out(n * m, 0), pa(tile * depth), pb((m + tile) * depth);
  for (std::size_t k0 = 0; k0 < width; k0 += depth) {
    const std::size_t part = std::min(depth, width - k0);
    const auto pack = [&](std::span<const double> from, std::size_t rows, std::size_t first, double* to) {
      for (std::size_t k = 0; k < part; ++k)
        for (std::size_t r = 0; r < tile; ++r)
          to[k * tile + r] = first + r < rows ? from[(first + r) * width + k0 + k] : 0;
    };
    for (std::size_t j = 0; j < m; j += tile) pack(b, m, j, &pb[j * depth]);
    for (std::size_t i = 0; i < n; i += tile) {
      pack(a, n, i, pa.data());
      for (std::size_t j = 0; j < (same ? std::min(m, i + tile) : m); j += tile) {
        const double* const packed_b = &pb[j * depth];
        double sum[tile][tile] = {};
        for (std::size_t k = 0; k < part; ++k) {
          const double* const x = &pa[k * tile];
          const double* const y = packed_b + k * tile;
          for (std::size_t r = 0; r < tile; ++r)
            for (std::size_t c = 0; c < tile; ++c) sum[r][c] += x[r] * y[c];
        }
        for (std::size_t r = 0; r < std::min(tile, n - i); ++r)
          for (std::size_t c = 0; c < std::min(tile, m - j); ++c) out[(i + r) * m + j + c] += sum[r][c];
      }
    }
  }
  if (same)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) out[i * n + j] = out[j * n + i];
  return out;
}

inline std::vector<double> transposed(std::span<const double> a, std::size_t width) {
  const std::size_t rows = a.size() / width;
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t k = 0; k < width; ++k) out[k * rows + i] = a[i * width + k];
  return out;
}

/// F [rank, k] with F^T F = `covariance` [k, k]: pivoted Cholesky decomposition, stopped when the remainder
/// is rounding error.
inline std::vector<double> factor_of(std::vector<double> covariance, std::size_t k) {
  std::vector<double> out;
  std::vector<double> left(k);
  double largest = 0;
  for (std::size_t i = 0; i < k; ++i) largest = std::max(largest, left[i] = covariance[i * k + i]);
  const double least = 1e-14 * static_cast<double>(k) * largest;
  for (std::size_t rank = 0; rank < k; ++rank) {
    const auto at = static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    if (!(left[at] > least)) break;
    const double pivot = std::sqrt(left[at]);
    out.resize((rank + 1) * k);
    double* const row = &out[rank * k];
    std::copy_n(&covariance[at * k], k, row);
    for (std::size_t before = 0; before < rank; ++before) {
      const double* const earlier = &out[before * k];
      const double weight = earlier[at];
      for (std::size_t i = 0; i < k; ++i) row[i] -= weight * earlier[i];
    }
    for (std::size_t i = 0; i < k; ++i) {
      row[i] /= pivot;
      left[i] -= row[i] * row[i];
    }
    left[at] = 0;
  }
  return out;
}

/// A set's mean [k], the trace of its covariance S, and F [r, k] with F^T F = S and r <= min(n, k).
struct Moments {
  std::vector<double> mean, factor;
  double trace = 0;
};

inline Moments moments_of(std::span<const float> features, std::size_t k, const char* which) {
  require(k > 0 && features.size() % k == 0, "the ", which, " set has ", features.size(),
          " values, expected rows of ", k, " features");
  const std::size_t n = features.size() / k;
  require(n >= 2, "the ", which, " set has ", n,
          " samples; a Frechet distance needs at least 2 of each (and more than ", k, " to be unbiased)");
  Moments out;
  out.mean.assign(k, 0);
  std::vector<double> centred(features.begin(), features.end());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < k; ++d) out.mean[d] += centred[i * k + d];
  for (double& m : out.mean) m /= static_cast<double>(n);
  const double scale = 1 / std::sqrt(static_cast<double>(n - 1));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < k; ++d) {
      double& x = centred[i * k + d];
      require(std::isfinite(x), "sample ", i, " of the ", which, " set has the feature ", x,
              ", expected finite values");
      x = (x - out.mean[d]) * scale;
      out.trace += x * x;
    }
  if (n <= k) {
    out.factor = std::move(centred);
  } else {
    const std::vector<double> columns = transposed(centred, k);
    out.factor = factor_of(times_transposed(columns, columns, n, true), k);
  }
  return out;
}

}  // namespace frechet_detail

/// The Frechet distance between normal distributions fitted to two sets of features, [n, dimensions] and
/// [m, dimensions]:
///
///     ||mu1 - mu2||^2 + tr(S1 + S2 - 2 (S1 S2)^(1/2))
///
/// (Dowson & Landau 1982; as FID in Heusel et al. 2017, eq. 6), where S is the covariance normalised by n -
/// 1. It depends on the feature extractor: distances from different extractors are not comparable.
///
/// With S = F^T F, the trace of the square root is the sum of the singular values of F1 F2^T, for covariances
/// of any rank, so no term is added to the diagonal. Computed in double precision on the host in O((n + m)
/// k^2 + k^3): with 1,024 features about 1 s for 1,000 and 8 s for 10,000 samples per set. Never negative.
/// Throws Error if the sizes do not fit, for a set of fewer than 2 samples and for values that are not
/// finite.
inline FrechetDistance frechet_distance(std::span<const float> features1, std::span<const float> features2,
                                        std::size_t dimensions) {
  using frechet_detail::moments_of, frechet_detail::times_transposed;
  const frechet_detail::Moments one = moments_of(features1, dimensions, "first"),
                                two = moments_of(features2, dimensions, "second");
  FrechetDistance out;
  out.dimensions = dimensions;
  out.samples1 = features1.size() / dimensions;
  out.samples2 = features2.size() / dimensions;
  for (std::size_t d = 0; d < dimensions; ++d)
    out.means += (one.mean[d] - two.mean[d]) * (one.mean[d] - two.mean[d]);
  double root = 0;
  if (!one.factor.empty() && !two.factor.empty()) {
    // The factor with fewer rows gives the smaller eigenvalue problem.
    const bool in_order = one.factor.size() <= two.factor.size();
    const std::vector<double>&small = in_order ? one.factor : two.factor,
          &large = in_order ? two.factor : one.factor;
    const std::size_t rank = small.size() / dimensions;
    const std::vector<double> product = times_transposed(small, large, dimensions);
    const std::vector<double> gram = times_transposed(product, product, product.size() / rank, true);
    for (const double value : symmetric_eigenvalues(gram, rank)) root += std::sqrt(std::max(value, 0.0));
  }
  out.distance = std::max(0.0, out.means + one.trace + two.trace - 2 * root);
  return out;
}

}  // namespace motiongan
