// The native backend of gemm() in the narrow form: the kernels of cl/gemm.cl, cl/gemm_outer.cl and
// cl/gemm_packed.cl, written for CPU devices. They differ in speed only.
#pragma once
#include <algorithm>

#include "motiongan/core/gemm_call.hpp"

namespace motiongan::detail {

/// Number of column panels of B, each two vectors wide.
inline std::size_t gemm_panels(const Context& context, const GemmCall& g) {
  const std::size_t columns = 2 * context.vector_width();
  return (g.n + columns - 1) / columns;
}

/// Elements of a row of packed B in the kernels' units: columns or, in 16 bits, pairs of columns.
inline std::size_t packed_row(const Context& context, bool in_16_bits) {
  return (in_16_bits ? 1 : 2) * context.vector_width();
}
/// A tensor for `panels` packed panels of `rows` rows each.
inline Tensor packed_panels(const Context& context, std::size_t panels, std::size_t rows, bool in_16_bits) {
  const std::size_t row = packed_row(context, in_16_bits);
  return Tensor(context, {panels, rows, in_16_bits ? row * sizeof(cl_uint) / context.real_size() : row});
}
/// The file of kernels for packed products.
inline const char* packed_kernels(bool in_16_bits) { return in_16_bits ? "gemm_packed_bf16" : "gemm_packed"; }

/// How the native kernel divides its work: rows and panels per work-group, and panels packed at once. None of
/// these changes a bit of the result.
struct GemmSplit {
  std::size_t rows, panels, panels_at_once;
};

inline GemmSplit split_gemm(const Context& context, const GemmCall& g) {
  const std::size_t tile = context.vector_width() * context.real_size() == 64 ? 12 : 6;
  const std::size_t panels = gemm_panels(context, g);
  // Several groups per core balance the load even if one core starts late; groups of too few rows would not
  // amortise packing.
  const std::size_t wanted = 8 * context.device().compute_units;
  const std::size_t columns_of_groups = std::max<std::size_t>(1, panels * g.batch);
  const std::size_t rows_of_groups = (wanted + columns_of_groups - 1) / columns_of_groups;
  std::size_t rows =
      std::max((g.m + rows_of_groups - 1) / rows_of_groups, std::min<std::size_t>(g.m, 8 * tile));
  rows = (rows + tile - 1) / tile * tile;
  // With few rows, reading B dominates: read it in wide rows if there are enough columns for every core.
  const bool wide = !g.b_transposed && g.m <= 32 && panels * g.batch >= 4 * wanted / 2;
  const std::size_t at_once = wide ? 4 : 1;
  return {rows, at_once, at_once};
}

/// The same for a packed B, where fine splits are cheap: each group only reads its panels again.
inline GemmSplit split_packed(const Context& context, const GemmCall& g) {
  const std::size_t tile = context.vector_width() * context.real_size() == 64 ? 12 : 6;
  const std::size_t panels = gemm_panels(context, g), units = context.device().compute_units;
  const std::size_t wanted = 8 * units;
  if (g.m == 1 && panels >= wanted) return {1, 4, 1};
  if (g.m < 8 * tile) {
    // PoCL schedules half of the remaining groups at a time: a few groups must be of equal size, and their
    // number a multiple of the cores.
    std::size_t row_groups = 1;
    while (panels * row_groups < 3 * units || panels * row_groups % units != 0) ++row_groups;
    return {(g.m + row_groups - 1) / row_groups, 1, 1};
  }
  const std::size_t row_groups = (wanted + panels - 1) / panels;
  const std::size_t rows = (g.m + row_groups - 1) / row_groups;
  return {(rows + tile - 1) / tile * tile, 1, 1};
}

/// The same for a transposed A, of which each group packs its rows (cl/gemm_outer.cl): many rows and panels
/// in a group, so that packing is shared, but enough groups for all cores.
inline GemmSplit split_outer(const Context& context, const GemmCall& g) {
  const std::size_t tile = 12, panels = gemm_panels(context, g);
  const std::size_t most = context.for_cpu() ? 8 * tile : tile;  // at most OUTER_ROWS
  const std::size_t wanted = 4 * context.device().compute_units;
  std::size_t rows = most, at_once = std::min<std::size_t>(panels, 4);
  const auto groups = [&] { return (g.m + rows - 1) / rows * ((panels + at_once - 1) / at_once) * g.batch; };
  while (at_once > 1 && groups() < wanted) at_once /= 2;
  while (rows > 2 * tile && groups() < wanted) rows = (rows / 2 + tile - 1) / tile * tile;
  return {rows, at_once, 1};
}

/// Mirrors struct Numbers in cl/gemm_epilogue.cl, field by field.
struct GemmNumbers {
  cl_uint m, n, k, segments, flags;
  cl_uint a_first, b_first, c_first, bias_first, residual_first;
  cl_uint a_row, a_p, b_p, b_column, c_row, residual_row;
  cl_uint a_batch, b_batch, c_batch;
  cl_uint a_segment[4], b_segment[4];
  cl_uint rows_per_group, panels_per_group, panels_at_once;
  std::string describe() const {
    return concat("{m ", m, ", n ", n, ", k ", k, ", segments ", segments, ", flags ", flags, "}");
  }
};
inline void add_argument(KernelArguments& to, const GemmNumbers& numbers) { to.set(numbers); }

/// The number of a stride or offset. Only strides of dimensions of size 1, which are never used, can exceed
/// 32 bits; see check_gemm.
inline cl_uint narrow(std::size_t value) { return static_cast<cl_uint>(value); }
/// The buffer of an operand, any if it is empty.
inline cl_mem operand(const GemmCall& g, const Tensor& t) { return t.empty() ? g.c.buffer() : t.buffer(); }
/// The index in its buffer of element `offset` of an operand.
inline cl_uint first_of(const Tensor& t, std::size_t offset = 0) {
  return (t.empty() ? 0 : narrow(t.offset())) + narrow(offset);
}

/// The numbers of a product without packing, but for its division into work-groups.
inline GemmNumbers gemm_numbers(const GemmCall& g) {
  GemmNumbers to{};
  to.m = narrow(g.m), to.n = narrow(g.n), to.k = narrow(g.k);
  to.segments = narrow(g.segments), to.flags = gemm_flags(g);
  to.a_first = first_of(g.a), to.b_first = first_of(g.b), to.c_first = first_of(g.c, g.c_offset);
  to.bias_first = first_of(g.bias), to.residual_first = first_of(g.residual, g.residual_offset);
  to.a_row = g.a_transposed ? 1 : narrow(g.a_ld), to.a_p = g.a_transposed ? narrow(g.a_ld) : 1;
  to.b_p = g.b_transposed ? 1 : narrow(g.b_ld), to.b_column = g.b_transposed ? narrow(g.b_ld) : 1;
  to.c_row = narrow(g.c_ld), to.residual_row = narrow(g.residual_ld);
  to.a_batch = narrow(g.a_batch_stride), to.b_batch = narrow(g.b_batch_stride),
  to.c_batch = narrow(g.c_batch_stride);
  for (std::size_t s = 0; s < 4; ++s)
    to.a_segment[s] = narrow(g.a_offset[s]), to.b_segment[s] = narrow(g.b_offset[s]);
  return to;
}

/// Launches a kernel of products: the operands, with `b` for B, the numbers, then `more`.
template <class... More>
void launch_gemm(const Context& context, const char* file, const char* kernel, const LaunchGrid& grid,
                 const GemmCall& g, const Tensor& b, const GemmNumbers& numbers, const More&... more) {
  context.launch(file, kernel, grid, operand(g, g.a), operand(g, b), g.c.buffer(), operand(g, g.bias),
                 operand(g, g.residual), numbers, more...);
}

inline void gemm_native(const Context& context, const GemmCall& g) {
  const bool is_packed = !g.b_panels.empty();
  const bool outer = g.a_transposed && g.m > 1;
  const GemmSplit split = is_packed ? split_packed(context, g)
                          : outer   ? split_outer(context, g)
                                    : split_gemm(context, g);
  GemmNumbers to = gemm_numbers(g);
  to.rows_per_group = narrow(split.rows), to.panels_per_group = narrow(split.panels);
  to.panels_at_once = narrow(split.panels_at_once);
  const std::size_t columns = 2 * context.vector_width() * split.panels;
  const LaunchGrid grid =
      LaunchGrid::groups((g.n + columns - 1) / columns, (g.m + split.rows - 1) / split.rows, g.batch);
  if (!is_packed) {
    const char* kernel = outer ? "gemm_outer" : "gemm";  // each in a file of its own
    launch_gemm(context, kernel, kernel, grid, g, g.b, to);
    return;
  }
  to.b_first = first_of(g.b_panels);
  for (std::size_t s = 0; s < g.segments; ++s)
    to.b_segment[s] = narrow(s * gemm_panels(context, g) * g.k * packed_row(context, g.b_in_16_bits));
  if (!g.rectified.empty()) to.flags |= gemm_rectify;
  launch_gemm(context, packed_kernels(g.b_in_16_bits), "gemm_packed", grid, g, g.b_panels, to,
              operand(g, g.rectified), first_of(g.rectified, g.rectified_offset));
}

}  // namespace motiongan::detail
