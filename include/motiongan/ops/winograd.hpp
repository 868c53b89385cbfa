// Convolutions of 2 or 3 neighbouring taps in Winograd's form (S. Winograd, "Arithmetic Complexity of
// Computations", 1980; A. Lavin and S. Gray, "Fast Algorithms for Convolutional Neural Networks", 2016).
//
// F(m, r) computes m frames of a convolution with r taps by n = m + r - 1 products instead of m * r:
//
//   y = A^T ((G w) * (B^T x)),   x: n neighbouring frames, w: r taps, y: m frames
//
// where * multiplies the n pairs, here of matrices [rows, in] and [in, out]. The gradient with respect to the
// weights needs as many: w' = G^T ((A y') * (B^T x)). The matrices are those of Toom and Cook: polynomials
// of x and w are evaluated at n - 1 points and at infinity, multiplied there and interpolated.
#pragma once
#include <algorithm>
#include <array>
#include <span>

#include "motiongan/core/gemm.hpp"

namespace motiongan::detail {

/// A matrix of at most 8 x 8 numbers, row after row; mirrors struct Matrix in cl/winograd.cl.
struct MixMatrix {
  static constexpr std::size_t most = 8;
  std::array<double, most * most> at{};

  double& operator()(std::size_t row, std::size_t column) { return at[row * most + column]; }
  double operator()(std::size_t row, std::size_t column) const { return at[row * most + column]; }
  MixMatrix transposed() const {
    MixMatrix t;
    for (std::size_t i = 0; i < most; ++i)
      for (std::size_t j = 0; j < most; ++j) t(j, i) = (*this)(i, j);
    return t;
  }
  std::string describe() const { return "a matrix"; }
};
inline void add_argument(KernelArguments& to, const MixMatrix& matrix) {
  if (to.precision == Precision::f64) return to.set(matrix.at);
  std::array<cl_float, MixMatrix::most * MixMatrix::most> narrow{};
  std::transform(matrix.at.begin(), matrix.at.end(), narrow.begin(),
                 [](double v) { return static_cast<cl_float>(v); });
  to.set(narrow);
}

/// F(frames, taps).
struct WinogradForm {
  std::size_t frames, taps, points;
  MixMatrix input, weights, output;  ///< B^T [points, points], G [points, taps], A^T [frames, points]

  /// `at` are the points but the one at infinity.
  WinogradForm(std::size_t frames_count, std::size_t taps_count, std::span<const double> at)
      : frames(frames_count), taps(taps_count), points(at.size() + 1) {
    // The coefficients of the product of (x - at_j) over all j but one.
    const auto product_without = [&](std::size_t without) {
      std::vector<double> coefficients{1};
      for (std::size_t j = 0; j < at.size(); ++j) {
        if (j == without) continue;
        coefficients.push_back(0);
        for (std::size_t i = coefficients.size() - 1; i > 0; --i)
          coefficients[i] = coefficients[i - 1] - at[j] * coefficients[i];
        coefficients[0] *= -at[j];
      }
      return coefficients;
    };
    const std::size_t infinity = points - 1;
    for (std::size_t i = 0; i < at.size(); ++i) {
      double divisor = 1, power = 1;
      for (std::size_t j = 0; j < at.size(); ++j) divisor *= j == i ? 1 : at[i] - at[j];
      for (std::size_t e = 0; e < std::max(frames, taps); ++e, power *= at[i]) {
        if (e < frames) output(e, i) = power;
        if (e < taps) weights(i, e) = power / divisor;
      }
      const std::vector<double> row = product_without(i);
      for (std::size_t e = 0; e < row.size(); ++e) input(i, e) = row[e];
    }
    output(frames - 1, infinity) = weights(infinity, taps - 1) = 1;
    const std::vector<double> row = product_without(at.size());
    for (std::size_t e = 0; e < row.size(); ++e) input(infinity, e) = row[e];
  }

  std::size_t tiles(std::size_t frames_count) const { return (frames_count + frames - 1) / frames; }
};

/// The forms in use. The points were chosen for the smallest error in single precision among multiples of
/// 1/8: of a layer with 128 channels 4.0e-7, 8.2e-7 and 3.6e-7, beside 2.2e-7 of the sum of shifted products.
inline const std::array<WinogradForm, 3>& winograd_forms() {
  constexpr std::array of_4x3{0.0, 0.75, -0.75, 1.5, -1.5};
  constexpr std::array of_6x3{0.0, 1.0, -1.0, 2.0, -2.0, 0.5, -0.5};
  constexpr std::array of_4x2{0.0, 0.75, -0.75, 2.0};
  static const std::array<WinogradForm, 3> forms{WinogradForm(4, 3, of_4x3), WinogradForm(6, 3, of_6x3),
                                                 WinogradForm(4, 2, of_4x2)};
  return forms;
}

/// out[a, i, :] = sum over j < width of matrix(a, j) * x[i * stride + first + j, :] for a < points and i <
/// tiles, at out + out_first + (a * step * tiles + i) * slab; frames outside x are zero. x is [frames, slab].
struct FrameMix {
  const MixMatrix& matrix;
  std::size_t points, width, tiles, stride = 0;
  long first = 0;
  std::size_t step = 1;
};
inline void mix_frames(const Tensor& x, std::size_t frames, std::size_t slab, const FrameMix& mix,
                       const At& out) {
  const Context& context = x.context();
  const std::size_t vectors = (slab + context.vector_width() - 1) / context.vector_width();
  context.launch("winograd", "mix_frames", LaunchGrid::items(mix.tiles * vectors), x, out, mix.matrix,
                 mix.points, mix.width, mix.tiles, mix.stride, static_cast<cl_int>(mix.first), frames, slab,
                 mix.step);
}

/// Mirrors struct Tiles in cl/winograd.cl, field by field.
struct WinogradNumbers {
  cl_uint rows, batch, n, k, points, frames, tile_frames, flags;
  cl_uint rows_per_group;
  std::string describe() const {
    return concat("{rows ", rows, ", n ", n, ", k ", k, ", points ", points, ", frames ", frames, "}");
  }
};
inline void add_argument(KernelArguments& to, const WinogradNumbers& numbers) { to.set(numbers); }

/// A product in Winograd's form, y = A^T (v * u), then as in GemmCall: + bias, + residual, ReLU, and ReLU(y)
/// to `rectified`. It has `frames` of `batch` rows and `out` channels; residual and rectified are stored like
/// y.
struct WinogradProduct {
  const WinogradForm& form;
  std::size_t frames, batch, out;
  bool accumulate = false;  ///< add to the present content of y
  Tensor bias = {}, residual = {};
  std::size_t residual_offset = 0;
  bool relu = false;
  Tensor rectified = {};
  std::size_t rectified_offset = 0;
};

/// Computes y from the mixed frames v [points, tiles * batch, in] and the weights u at the points, packed by
/// winograd_weights().
inline void winograd_multiply(const Tensor& v, const Tensor& u, const WinogradProduct& product, const At& y) {
  const Context& context = v.context();
  const std::size_t rows = v.dim(1), columns = 2 * context.vector_width(),
                    panels = (product.out + columns - 1) / columns;
  // Rows in multiples of a register tile; with few of them, enough groups for all cores.
  constexpr std::size_t tile = 12;
  const std::size_t most = context.for_cpu() ? 4 * tile : tile;  // ROWS_AT_ONCE in cl/winograd.cl
  const std::size_t wanted = 8 * context.device().compute_units;
  const std::size_t shared = (rows * panels / wanted + tile - 1) / tile * tile;
  const std::size_t rows_per_group = std::clamp(shared, tile, most);
  const auto narrow = [](std::size_t value) { return static_cast<cl_uint>(value); };
  const auto flag = [](bool on, cl_uint value) { return on ? value : 0; };
  const WinogradNumbers numbers{
      .rows = narrow(rows),
      .batch = narrow(product.batch),
      .n = narrow(product.out),
      .k = narrow(v.dim(2)),
      .points = narrow(product.form.points),
      .frames = narrow(product.frames),
      .tile_frames = narrow(product.form.frames),
      .flags = flag(product.accumulate, gemm_accumulate) | flag(!product.bias.empty(), gemm_bias) |
               flag(!product.residual.empty(), gemm_residual) | flag(product.relu, gemm_relu) |
               flag(!product.rectified.empty(), gemm_rectify),
      .rows_per_group = narrow(rows_per_group)};
  const auto at = [&](const Tensor& t, std::size_t first) {  // what is empty is not read
    return t.empty() ? At{y.tensor, 0, 0} : At{t, first};
  };
  context.count_gemm_flops(2.0 * static_cast<double>(v.size()) * static_cast<double>(product.out));
  context.launch("winograd", "winograd_multiply",
                 LaunchGrid::groups(panels, (rows + rows_per_group - 1) / rows_per_group), v, u, y,
                 at(product.bias, 0), at(product.residual, product.residual_offset),
                 at(product.rectified, product.rectified_offset), numbers, product.form.output);
}

}  // namespace motiongan::detail
