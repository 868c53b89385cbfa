// Elementwise functions of one or two arrays of n elements; one vector per work-item. a and b are constants
// of the function.

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

UNARY(affine, a* v + b)
UNARY(leaky_relu, v < 0 ? a * v : v)  // NaN is preserved; slope a, 0 for ReLU
UNARY(tanh_of, tanh(v))
UNARY(sigmoid_of, 1 / (1 + exp(-v)))
UNARY(exp_of, exp(v))
UNARY(log_of, log(v))
UNARY(sqrt_of, sqrt(v))
UNARY(clamp_of, clamp(v, (realv)a, (realv)b))

BINARY(axpby, a* v + b * w)
BINARY(product, v* w)
BINARY(quotient, v / w)
// Gradients of functions in terms of their value w; v is the incoming gradient.
BINARY(leaky_relu_grad, w > 0 ? v : a * v)
BINARY(tanh_grad, v*(1 - w * w))
BINARY(sigmoid_grad, v* w*(1 - w))

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
