// Sums over an axis in a fixed order, and broadcasting, their adjoint. Sums of rows: rows.cl.

/// out[o, s, i] = scale * sum of x[o, j, i] over j in [s*chunk, (s+1)*chunk), in ascending order.
kernel void sum_axis(global const real* x, uint x0, global real* out, uint out0, uint outer, uint count,
                     uint inner, uint chunk, real scale) {
  const uint columns = (inner + VW - 1) / VW, pieces = (count + chunk - 1) / chunk, item = get_global_id(0);
  const uint row = item / columns, i = item % columns * VW;
  if (row >= outer * pieces) return;
  const uint o = row / pieces, first = row % pieces * chunk, last = min(first + chunk, count),
             left = inner - i;
  global const real* p = x + x0 + (o * count + first) * inner + i;
  realv sum = 0;
  if (left >= VW)
    for (uint j = first; j < last; ++j, p += inner) sum += LOAD_VECTOR(p);
  else
    for (uint j = first; j < last; ++j, p += inner) sum += load_part(p, left);
  store_some(sum * scale, out + out0 + row * inner + i, left);
}

/// out[o, j, i] = scale * x[o, i] for j < count.
kernel void broadcast_axis(global const real* x, uint x0, global real* out, uint out0, uint outer, uint count,
                           uint inner, real scale) {
  const uint columns = (inner + VW - 1) / VW, item = get_global_id(0);
  const uint row = item / columns, i = item % columns * VW;
  if (row >= outer * count) return;
  const uint left = inner - i;
  store_some(scale * load_some(x + x0 + row / count * inner + i, left), out + out0 + row * inner + i, left);
}

/// out[r, j] = scale * x[r] for j < count: broadcast_axis with inner = 1.
kernel void broadcast_rows(global const real* x, uint x0, global real* out, uint out0, uint rows, uint count,
                           real scale) {
  const uint columns = (count + VW - 1) / VW, item = get_global_id(0);
  const uint r = item / columns, j = item % columns * VW;
  if (r < rows) store_some((realv)(scale * x[x0 + r]), out + out0 + r * count + j, count - j);
}
