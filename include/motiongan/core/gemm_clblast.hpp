// The CLBlast backend of gemm(), tuned for GPUs.
#pragma once
#include <algorithm>

#include "motiongan/core/gemm_call.hpp"

// Must follow opencl.hpp, which sets the OpenCL target version to 1.2.
#include <clblast_c.h>

namespace motiongan::detail {

/// CLBlast requires a leading dimension of at least the row length, even for a single row.
inline std::size_t clblast_ld(std::size_t rows, std::size_t columns, std::size_t ld) {
  return rows <= 1 ? std::max(ld, columns) : ld;
}

/// CLBlast rejects empty products and matrices whose rows overlap; the native kernel handles these.
inline bool clblast_can(const GemmCall& g) {
  const auto rows_apart = [](bool transposed, std::size_t rows, std::size_t columns, std::size_t ld) {
    if (transposed) std::swap(rows, columns);
    return rows <= 1 || ld >= columns;
  };
  return g.k > 0 && rows_apart(g.a_transposed, g.m, g.k, g.a_ld) &&
         rows_apart(g.b_transposed, g.k, g.n, g.b_ld);
}

/// One CLBlast call per segment, accumulating into C, then the epilogue in the library's own kernel. A call
/// counts as one launch.
inline void gemm_clblast(const Context& context, const GemmCall& g) {
  context.count_launches(g.segments);
  if (context.only_counts()) return;
  const std::size_t a_ld = clblast_ld(g.a_transposed ? g.k : g.m, g.a_transposed ? g.m : g.k, g.a_ld);
  const std::size_t b_ld = clblast_ld(g.b_transposed ? g.n : g.k, g.b_transposed ? g.k : g.n, g.b_ld);
  const std::size_t c_ld = clblast_ld(g.m, g.n, g.c_ld);
  const CLBlastTranspose a_transpose = g.a_transposed ? CLBlastTransposeYes : CLBlastTransposeNo;
  const CLBlastTranspose b_transpose = g.b_transposed ? CLBlastTransposeYes : CLBlastTransposeNo;
  const std::size_t c_first = g.c.offset() + g.c_offset;
  cl_command_queue queue = context.queue();
  for (std::size_t s = 0; s < g.segments; ++s) {
    const std::size_t a_first = g.a.offset() + g.a_offset[s], b_first = g.b.offset() + g.b_offset[s];
    const auto run = [&]<class T>(T beta, auto single, auto batched) {
      if (g.batch == 1)
        return single(CLBlastLayoutRowMajor, a_transpose, b_transpose, g.m, g.n, g.k, T{1}, g.a.buffer(),
                      a_first, a_ld, g.b.buffer(), b_first, b_ld, beta, g.c.buffer(), c_first, c_ld, &queue,
                      nullptr);
      return batched(CLBlastLayoutRowMajor, a_transpose, b_transpose, g.m, g.n, g.k, T{1}, g.a.buffer(),
                     a_first, a_ld, g.a_batch_stride, g.b.buffer(), b_first, b_ld, g.b_batch_stride, beta,
                     g.c.buffer(), c_first, c_ld, g.c_batch_stride, g.batch, &queue, nullptr);
    };
    const bool add = s > 0 || g.accumulate;
    const CLBlastStatusCode code = context.precision() == Precision::f64
                                       ? run(add ? 1.0 : 0.0, CLBlastDgemm, CLBlastDgemmStridedBatched)
                                       : run(add ? 1.0f : 0.0f, CLBlastSgemm, CLBlastSgemmStridedBatched);
    context.check(code, "CLBlast", ": ", g);  // OpenCL's codes, and some of its own
  }
  const cl_uint flags = gemm_flags(g) & ~gemm_accumulate;
  if (flags == 0) return;
  LaunchGrid grid = LaunchGrid::items(g.m * g.n);
  grid.dimensions = 2;
  grid.global[1] = g.batch;
  const auto present = [&](const Tensor& t) -> const Tensor& { return t.empty() ? g.c : t; };
  context.launch("gemm_finish", "gemm_finish", grid, g.c.buffer(), c_first, present(g.bias).buffer(),
                 present(g.bias).offset(), present(g.residual).buffer(),
                 present(g.residual).offset() + g.residual_offset, g.m, g.n, g.c_ld, g.residual_ld,
                 g.c_batch_stride, flags);
}

}  // namespace motiongan::detail
