// The kernels of gemm_packed.cl for a B of bfloat16 values, packed in 16 bits each: half the bytes to read
// where a product has few rows.
#define WEIGHTS_ARE_BF16
#include "gemm_packed.cl"
