// Only the epilogue, for products of another backend.
#include "gemm_epilogue.cl"

// Work-items: x over m * n, y over the batch.
kernel void gemm_finish(global real* c, uint c_first, global const real* bias, uint bias_first,
                        global const real* residual, uint residual_first, uint m, uint n, uint c_stride,
                        uint residual_stride, uint batch_stride, uint flags) {
  const size_t index = get_global_id(0), batch = get_global_id(1);
  if (index >= (size_t)m * n) return;
  const size_t i = index / n, j = index % n;
  global real* at = c + c_first + batch * batch_stride + i * c_stride + j;
  *at = finish_one(*at, flags, bias + bias_first + j, residual + residual_first + i * residual_stride + j);
}
