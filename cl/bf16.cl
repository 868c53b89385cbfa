// Rounding to bfloat16: the upper half of a float.

/// x[i] = the nearest bfloat16 of x[i], ties to even. Work-items: vectors of x.
kernel void round_to_bf16(global real* x, uint x0, uint n) {
  const uint i = get_global_id(0) * VW;
  if (i >= n) return;
  store_some(from_bf16(to_bf16(load_some(x + x0 + i, n - i))), x + x0 + i, n - i);
}
