/// out[r, :] = softmax of x[r, :], one row per work-item; the maximum is subtracted first to avoid overflow.
kernel void softmax_rows(global const real* x, uint x0, global real* out, uint out0, uint rows, uint count) {
  const uint r = get_global_id(0);
  if (r >= rows) return;
  global const real* p = x + x0 + r * count;
  global real* q = out + out0 + r * count;
  real top = p[0];
  for (uint j = 1; j < count; ++j) top = fmax(top, p[j]);
  real sum = 0;
  for (uint j = 0; j < count; ++j) {
    q[j] = exp(p[j] - top);
    sum += q[j];
  }
  for (uint j = 0; j < count; ++j) q[j] /= sum;
}

/// out[r, :] = log softmax of x[r, :], one row per work-item.
kernel void log_softmax_rows(global const real* x, uint x0, global real* out, uint out0, uint rows,
                             uint count) {
  const uint r = get_global_id(0);
  if (r >= rows) return;
  global const real* p = x + x0 + r * count;
  global real* q = out + out0 + r * count;
  real top = p[0];
  for (uint j = 1; j < count; ++j) top = fmax(top, p[j]);
  real sum = 0;
  for (uint j = 0; j < count; ++j) sum += exp(p[j] - top);
  const real shift = top + log(sum);
  for (uint j = 0; j < count; ++j) q[j] = p[j] - shift;
}
