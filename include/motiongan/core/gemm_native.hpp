// Our own engine of gemm(): the kernel of cl/gemm.cl, made for CPU devices.
#pragma once
#include <algorithm>

#include "motiongan/core/gemm_call.hpp"

namespace motiongan::detail {

/// How the native kernel's work is cut: rows and panels (of two vectors' columns) of one work-group, and the
/// values of p it packs at a time. None of these changes a bit of the result.
struct GemmSplit {
  std::size_t rows, panels, block;
};

inline GemmSplit split_gemm(const Context& context, const GemmCall& g) {
  const std::size_t columns = 2 * context.vector_width();
  const std::size_t tile = context.vector_width() * context.real_size() == 64 ? 12 : 6;
  const std::size_t panels = (g.n + columns - 1) / columns;
  // Several groups per core end together even when one core comes late.
  const std::size_t wanted = 8 * context.device().compute_units;
  const std::size_t per_row_of_groups =
      std::max<std::size_t>(1, wanted / std::max<std::size_t>(1, panels * g.batch));
  std::size_t rows = (g.m + per_row_of_groups - 1) / per_row_of_groups;
  rows = std::max(rows, std::min<std::size_t>(g.m, 8 * tile));  // enough rows to pay for the packing
  rows = (rows + tile - 1) / tile * tile;
  return {rows, 1, 768};
}

/// Four kernel arguments in one (a uint4); those that do not fit 32 bits are never used, see check_gemm.
struct Four {
  cl_uint4 values;
  Four(std::size_t x, std::size_t y, std::size_t z, std::size_t w)
      : values{{static_cast<cl_uint>(x), static_cast<cl_uint>(y), static_cast<cl_uint>(z),
                static_cast<cl_uint>(w)}} {}
  std::string describe() const {
    return concat("(", values.s[0], ", ", values.s[1], ", ", values.s[2], ", ", values.s[3], ")");
  }
};
inline void add_argument(KernelArguments& to, const Four& four) { to.set(four.values); }

inline void gemm_native(const Context& context, const GemmCall& g) {
  const std::size_t columns = 2 * context.vector_width();
  const GemmSplit split = split_gemm(context, g);
  const Four strides(g.a_transposed ? 1 : g.a_ld, g.a_transposed ? g.a_ld : 1, g.b_transposed ? g.b_ld : 1,
                     g.b_transposed ? 1 : g.b_ld);
  const Four a_offsets(g.a_offset[0], g.a_offset[1], g.a_offset[2], g.a_offset[3]);
  const Four b_offsets(g.b_offset[0], g.b_offset[1], g.b_offset[2], g.b_offset[3]);
  const Four batch_strides(g.a_batch_stride, g.b_batch_stride, g.c_batch_stride, 0);
  const auto present = [&](const Tensor& t) -> const Tensor& { return t.empty() ? g.c : t; };
  const std::size_t rows_of_groups = (g.m + split.rows - 1) / split.rows;
  const std::size_t panels = (g.n + columns - 1) / columns;
  context.launch("gemm", "gemm",
                 Grid::groups((panels + split.panels - 1) / split.panels, rows_of_groups, g.batch),
                 present(g.a), present(g.b), g.c.buffer(), g.c.offset() + g.c_offset, present(g.bias),
                 present(g.residual).buffer(), present(g.residual).offset() + g.residual_offset, g.m, g.n,
                 g.k, strides, g.c_ld, g.residual_ld, g.segments, a_offsets, b_offsets, batch_strides,
                 gemm_flags(g), split.rows, split.panels, split.block);
}

}  // namespace motiongan::detail
