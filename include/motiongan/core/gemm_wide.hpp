// The native backend of gemm() in the wide form: the kernels of cl/gemm_wide.cl.
#pragma once
#include <bit>

#include "motiongan/core/gemm_native.hpp"

namespace motiongan::detail {

/// Rows and columns of C of a work-group.
struct WideTile {
  std::size_t rows, columns;
  std::size_t groups(const GemmCall& g) const { return row_groups(g) * column_groups(g) * g.batch; }
  std::size_t row_groups(const GemmCall& g) const { return (g.m + rows - 1) / rows; }
  std::size_t column_groups(const GemmCall& g) const { return (g.n + columns - 1) / columns; }
};

inline void gemm_wide(const Context& context, const GemmCall& g) {
  // ACROSS and DOWN in cl/gemm_wide.cl.
  const auto bits = static_cast<std::size_t>(std::countr_zero(context.group()));
  const std::size_t down = std::size_t{1} << bits / 2, across = context.group() / down;
  const WideTile tile{4 * down, 4 * across}, few{4, across};
  // With few tiles, smaller pieces keep more of the device busy; no bit depends on the choice.
  const bool in_tiles = g.m > 2 * few.rows && tile.groups(g) >= context.device().compute_units;
  const WideTile& used = in_tiles ? tile : few;
  GemmNumbers numbers = gemm_numbers(g);
  if (!g.rectified.empty()) numbers.flags |= gemm_rectify;
  launch_gemm(context, "gemm_wide", in_tiles ? "gemm_tile" : "gemm_few",
              context.groups(used.column_groups(g), used.row_groups(g), g.batch), g, g.b, numbers,
              operand(g, g.rectified), first_of(g.rectified, g.rectified_offset));
}

}  // namespace motiongan::detail
