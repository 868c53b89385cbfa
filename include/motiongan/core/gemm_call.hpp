// The description of a matrix product and its bounds checks.
#pragma once
#include <array>
#include <limits>
#include <ostream>

#include "motiongan/core/tensor.hpp"

namespace motiongan {

/// A batch of matrix products, all row-major:
/// C[m,n] = epilogue((accumulate ? C : 0) + sum over segments s of A_s[m,k] * B_s[k,n]).
/// The elements of C must not overlap those of A, B or the residual.
struct GemmCall {
  std::size_t m = 0, n = 0, k = 0;  ///< C is m x n; k is the length of the sums
  /// Element (i, p) of A is at a_offset[s] + i * a_ld + p or, when a_transposed, at a_offset[s] + p * a_ld +
  /// i. Element (p, j) of B is at b_offset[s] + p * b_ld + j or, when b_transposed, at b_offset[s] + j * b_ld
  /// + p. Element (i, j) of C is at c_offset + i * c_ld + j.
  Tensor a = {}, b = {}, c = {};
  std::size_t a_ld = 0, b_ld = 0, c_ld = 0;  ///< distance between stored rows, in elements
  bool a_transposed = false, b_transposed = false;
  std::size_t segments = 1;                           ///< products summed, 1 to 4 (taps of a convolution)
  std::array<std::size_t, 4> a_offset{}, b_offset{};  ///< where each segment of A and B begins, in elements
  std::size_t c_offset = 0;                           ///< where C begins
  /// Problems of equal size, and the elements from one to the next.
  std::size_t batch = 1, a_batch_stride = 0, b_batch_stride = 0, c_batch_stride = 0;
  bool accumulate = false;  ///< add to the present content of C
  /// pack_b() stores B in 16 bits, rounded to bfloat16. If B holds such values, as after round_to_bf16(),
  /// that loses nothing.
  bool b_in_16_bits = false;
  /// B packed by pack_b() for the same b, b_offset, b_ld, b_transposed, b_in_16_bits, n, k and segments; or
  /// empty. Saves packing B for every product and gives bit-identical results. Not for batches or a
  /// transposed A.
  Tensor b_panels = {};
  /// The epilogue, in this order: + bias[j], + residual[residual_offset + i * residual_ld + j], ReLU.
  Tensor bias = {}, residual = {};  ///< optional; shared by all problems of the batch
  std::size_t residual_offset = 0, residual_ld = 0;
  bool relu = false;  ///< set negative elements to 0 at last
  /// Optional second output, ReLU(C): m * n elements from rectified_offset. Needs batch 1 and c_ld = n.
  Tensor rectified = {};
  std::size_t rectified_offset = 0;
};

/// Prints the sizes of a product, the start of every error message about it.
inline std::ostream& operator<<(std::ostream& out, const GemmCall& g) {
  return out << "gemm m=" << g.m << " n=" << g.n << " k=" << g.k << " a_ld=" << g.a_ld
             << (g.a_transposed ? " (transposed)" : "") << " b_ld=" << g.b_ld
             << (g.b_transposed ? " (transposed)" : "") << " c_ld=" << g.c_ld << " segments=" << g.segments
             << " batch=" << g.batch;
}

namespace detail {

// Flags of the kernels, cl/gemm_epilogue.cl.
constexpr cl_uint gemm_accumulate = 1, gemm_bias = 2, gemm_residual = 4, gemm_relu = 8, gemm_rectify = 16;

inline cl_uint gemm_flags(const GemmCall& g) {
  return (g.accumulate ? gemm_accumulate : 0) | (g.bias.empty() ? 0 : gemm_bias) |
         (g.residual.empty() ? 0 : gemm_residual) | (g.relu ? gemm_relu : 0);
}

/// Bytes of all operands, those of every segment and problem of the batch.
inline double gemm_bytes(const Context& context, const GemmCall& g) {
  const auto product = [](auto... sizes) { return (static_cast<double>(sizes) * ...); };
  const double c = product(g.m, g.n, g.batch), problems_of_b = g.b_batch_stride > 0 ? double(g.batch) : 1;
  const double real = static_cast<double>(context.real_size());
  const double b = g.b_in_16_bits && !g.b_panels.empty() ? 2 : real;
  return real * (product(g.m, g.k, g.segments, g.batch) + c * (g.accumulate ? 2 : 1) +
                 (g.bias.empty() ? 0 : product(g.n)) + (g.residual.empty() ? 0 : c) +
                 (g.rectified.empty() ? 0 : c)) +
         b * product(g.k, g.n, g.segments) * problems_of_b;
}

/// A tensor's shape, formatted only if a message is.
struct ShapeOf {
  const Tensor& tensor;
  friend std::ostream& operator<<(std::ostream& out, const ShapeOf& shape) {
    return out << to_string(shape.tensor.shape());
  }
};

/// a + b * c, or the largest number if that does not fit.
inline std::size_t sum_with_product(std::size_t a, std::size_t b, std::size_t c) {
  std::size_t result = 0;
  const bool over = __builtin_mul_overflow(b, c, &result) || __builtin_add_overflow(a, result, &result);
  return over ? std::numeric_limits<std::size_t>::max() : result;
}

/// Throws Error unless the matrix lies inside its tensor.
inline void check_matrix(const GemmCall& g, const char* name, const Tensor& tensor, std::size_t offset,
                         std::size_t rows, std::size_t columns, std::size_t ld, std::size_t batch_stride) {
  if (rows == 0 || columns == 0 || g.batch == 0) return;
  require(!tensor.empty(), g, ": ", name, " is empty");
  const std::size_t problem = sum_with_product(columns, rows - 1, ld),
                    all = sum_with_product(problem, g.batch - 1, batch_stride),
                    end = sum_with_product(all, offset, 1);
  require(end <= tensor.size(), g, ": ", name, " (", rows, " rows of ", columns, ", leading dimension ", ld,
          ", offset ", offset, ", batch stride ", batch_stride, ") needs ", end, " elements, its tensor ",
          ShapeOf{tensor}, " has ", tensor.size());
}

inline void check_gemm(const Context& context, const GemmCall& g) {
  require(g.segments >= 1 && g.segments <= 4, g, ": segments must be 1 to 4");
  for (std::size_t s = 0; s < g.segments; ++s) {
    check_matrix(g, "A", g.a, g.a_offset[s], g.a_transposed ? g.k : g.m, g.a_transposed ? g.m : g.k, g.a_ld,
                 g.a_batch_stride);
    check_matrix(g, "B", g.b, g.b_offset[s], g.b_transposed ? g.n : g.k, g.b_transposed ? g.k : g.n, g.b_ld,
                 g.b_batch_stride);
  }
  check_matrix(g, "C", g.c, g.c_offset, g.m, g.n, g.c_ld, g.c_batch_stride);
  require(g.m <= 1 || g.batch == 0 || g.c_ld >= g.n, g, ": the rows of C overlap: c_ld must be at least n");
  const std::size_t c_size = (g.m - 1) * g.c_ld + g.n;
  require(g.batch <= 1 || g.c_batch_stride >= c_size || (g.m > 1 && g.c_batch_stride >= g.n) || g.m == 0, g,
          ": the problems of the batch overlap in C: c_batch_stride is ", g.c_batch_stride);
  if (!g.bias.empty())
    require(g.bias.size() == g.n, g, ": bias has shape ", ShapeOf{g.bias}, ", expected n elements");
  if (!g.residual.empty() && g.m > 0) {
    const std::size_t end =
        sum_with_product(sum_with_product(g.n, g.m - 1, g.residual_ld), g.residual_offset, 1);
    require(end <= g.residual.size(), g, ": the residual (leading dimension ", g.residual_ld, ", offset ",
            g.residual_offset, ") needs ", end, " elements, its tensor ", ShapeOf{g.residual}, " has ",
            g.residual.size());
  }
  if (!g.b_panels.empty())
    require(g.batch == 1 && !g.a_transposed, g, ": a packed B needs batch 1 and an A that is not transposed");
  if (!g.rectified.empty())
    require(
        g.batch == 1 && g.c_ld == g.n && sum_with_product(g.rectified_offset, g.m, g.n) <= g.rectified.size(),
        g, ": rectified needs batch 1, c_ld = n and ", g.m * g.n, " elements from ", g.rectified_offset,
        "; its tensor has shape ", ShapeOf{g.rectified});
  for (const Tensor* tensor : {&g.a, &g.b, &g.c, &g.bias, &g.residual, &g.rectified})
    require(tensor->empty() || tensor->context() == context, g, ": a tensor belongs to another context");
}

}  // namespace detail
}  // namespace motiongan
