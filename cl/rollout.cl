// One step of a recurrent generator that feeds back what it made: the pointwise parts of its LSTM layers
// (PyTorch's: gates i, f, g, o). Hidden states stand in rows beside other numbers, so they have a stride;
// gates [batch, 4k] and cell states [batch, k] have none.

/// In: gates before activation, c of the step before. Out: gates after activation (in place), h and c of this
/// step.
kernel void rollout_cell(global real* gates, uint gates0, global const real* c_before, uint c_before0,
                         global real* h, uint h0, uint h_stride, global real* c, uint c0, uint batch,
                         uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  global real* row = gates + gates0 + b * 4 * k + j;
  const realv i = sigmoid_v(load_some(row, left)), f = sigmoid_v(load_some(row + k, left));
  const realv g = tanh(load_some(row + 2 * k, left)), o = sigmoid_v(load_some(row + 3 * k, left));
  const realv state = f * load_some(c_before + c_before0 + at, left) + i * g;
  store_some(i, row, left);
  store_some(f, row + k, left);
  store_some(g, row + 2 * k, left);
  store_some(o, row + 3 * k, left);
  store_some(state, c + c0 + at, left);
  store_some(o * tanh(state), h + h0 + b * h_stride + j, left);
}

/// In: activated gates, c of this step and the one before, gradient of h, gradient of c from the step after.
/// Out: gradient of the gates before activation; dc becomes the gradient of c of the step before.
kernel void rollout_cell_backward(global const real* gates, uint gates0, global const real* c, uint c0,
                                  global const real* c_before, uint c_before0, global const real* dh,
                                  uint dh0, uint dh_stride, global real* dc, uint dc0, global real* dgates,
                                  uint dgates0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  const realv gh = load_some(dh + dh0 + b * dh_stride + j, left);
  global const real* row = gates + gates0 + b * 4 * k + j;
  global real* out = dgates + dgates0 + b * 4 * k + j;
  const realv i = load_some(row, left), f = load_some(row + k, left), g = load_some(row + 2 * k, left);
  const realv o = load_some(row + 3 * k, left), state = tanh(load_some(c + c0 + at, left));
  const realv gc = load_some(dc + dc0 + at, left) + gh * o * (1 - state * state);
  store_some(gc * g * i * (1 - i), out, left);
  store_some(gc * load_some(c_before + c_before0 + at, left) * f * (1 - f), out + k, left);
  store_some(gc * i * (1 - g * g), out + 2 * k, left);
  store_some(gh * state * o * (1 - o), out + 3 * k, left);
  store_some(gc * f, dc + dc0 + at, left);
}

/// out[r, :] += x[r, :] for `rows` rows of `run` numbers.
kernel void add_rows(global const real* x, uint x0, uint x_stride, global real* out, uint out0,
                     uint out_stride, uint rows, uint run) {
  const uint columns = (run + VW - 1) / VW, item = get_global_id(0);
  const uint r = item / columns, j = item % columns * VW;
  if (r >= rows) return;
  const uint left = run - j;
  global real* to = out + out0 + r * out_stride + j;
  store_some(load_some(to, left) + load_some(x + x0 + r * x_stride + j, left), to, left);
}
