// Differentiable matrix products, single or batched.
#pragma once
#include "motiongan/core/gemm.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// a * b for matrices [m, k] and [k, n], or for batches [batch, m, k] and [batch, k, n]. With `a_transposed`,
/// a is stored as [k, m]; with `b_transposed`, b as [n, k]. Throws Error if the shapes do not fit.
inline Var matmul(const Var& a, const Var& b, bool a_transposed = false, bool b_transposed = false) {
  const std::size_t rank = a.value().rank();
  require((rank == 2 || rank == 3) && b.value().rank() == rank && (rank == 2 || a.dim(0) == b.dim(0)),
          "matmul: shapes ", a.shape(), " and ", b.shape());
  const std::size_t a_rows = a.dim(rank - 2), a_columns = a.dim(rank - 1), b_rows = b.dim(rank - 2),
                    b_columns = b.dim(rank - 1);
  GemmCall call;
  call.m = a_transposed ? a_columns : a_rows;
  call.k = a_transposed ? a_rows : a_columns;
  call.n = b_transposed ? b_rows : b_columns;
  require(call.k == (b_transposed ? b_columns : b_rows), "matmul: inner sizes differ in ", a.shape(),
          a_transposed ? "^T" : "", " and ", b.shape(), b_transposed ? "^T" : "");
  call.batch = rank == 3 ? a.dim(0) : 1;
  call.a = a.value();
  call.b = b.value();
  call.c = Tensor(a.context(), rank == 3 ? Shape{call.batch, call.m, call.n} : Shape{call.m, call.n});
  call.a_ld = a_columns;
  call.b_ld = b_columns;
  call.c_ld = call.n;
  call.a_batch_stride = a_rows * a_columns;
  call.b_batch_stride = b_rows * b_columns;
  call.c_batch_stride = call.m * call.n;
  call.a_transposed = a_transposed;
  call.b_transposed = b_transposed;
  gemm(a.context(), call);
  return record(
      "matmul", {a, b}, call.c, [=](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
        const Var &ai = self.inputs[0], &bi = self.inputs[1];
        Var by_a, by_b;  // stored like a and b, transposed if they are
        if (needs[0])
          by_a = a_transposed ? matmul(bi, g, b_transposed, true) : matmul(g, bi, false, !b_transposed);
        if (needs[1])
          by_b = b_transposed ? matmul(g, ai, true, a_transposed) : matmul(ai, g, !a_transposed, false);
        return {by_a, by_b};
      });
}

}  // namespace motiongan
