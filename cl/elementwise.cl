// Elementwise functions of one or two arrays of n elements, v and w; one vector per work-item. a and b are
// constants of the function. The functions themselves are beside their derivatives, see ElementwiseKernel in
// core/program.hpp: each becomes a line UNARY(name, expression) or BINARY(name, expression) after this file.

#define UNARY(name, expression)                                                                          \
  kernel void name(global const real* x, uint x0, global real* out, uint out0, uint n, real a, real b) { \
    const uint i = (uint)get_global_id(0) * VW;                                                          \
    if (i >= n) return;                                                                                  \
    const realv v = load_some(x + x0 + i, n - i);                                                        \
    store_some(expression, out + out0 + i, n - i);                                                       \
  }

#define BINARY(name, expression)                                                                   \
  kernel void name(global const real* x, uint x0, global const real* y, uint y0, global real* out, \
                   uint out0, uint n, real a, real b) {                                            \
    const uint i = (uint)get_global_id(0) * VW;                                                    \
    if (i >= n) return;                                                                            \
    const realv v = load_some(x + x0 + i, n - i), w = load_some(y + y0 + i, n - i);                \
    store_some(expression, out + out0 + i, n - i);                                                 \
  }

kernel void fill(global real* out, uint out0, uint n, real a) {
  const uint i = (uint)get_global_id(0) * VW;
  if (i < n) store_some((realv)(a), out + out0 + i, n - i);
}

/// out[o, j, i] = relu(big[o, j, i] + small[o, i]) for j < count.
kernel void add_broadcast_relu(global const real* big, uint big0, global const real* small, uint small0,
                               global real* out, uint out0, uint outer, uint count, uint inner) {
  const uint columns = (inner + VW - 1) / VW, item = get_global_id(0);
  const uint row = item / columns, i = item % columns * VW;
  if (row >= outer * count) return;
  const uint o = row / count, left = inner - i;
  const realv v =
      load_some(big + big0 + row * inner + i, left) + load_some(small + small0 + o * inner + i, left);
  store_some(v < 0 ? 0 : v, out + out0 + row * inner + i, left);
}
