// One step of an LSTM layer (PyTorch's: gates i, f, g, o), pointwise part. Gates are [batch, 4k], states
// [batch, k]. A sample whose sentence is over (step >= length) keeps its state; length may be absent (all
// samples are as long).

inline realv sigmoid_v(realv v) { return 1 / (1 + exp(-v)); }

/// In: gates before activation, c of the step before. Out: gates after activation (in place), h and c of this
/// step.
kernel void lstm_cell(global real* gates, uint gates0, global const real* c_before, uint c_before0,
                      global const real* h_before, uint h_before0, global const int* length, uint step,
                      global real* h, uint h0, global real* c, uint c0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  global real* row = gates + gates0 + b * 4 * k + j;
  if (length && step >= (uint)length[b]) {
    store_some(load_some(h_before + h_before0 + at, left), h + h0 + at, left);
    store_some(load_some(c_before + c_before0 + at, left), c + c0 + at, left);
    return;
  }
  const realv i = sigmoid_v(load_some(row, left)), f = sigmoid_v(load_some(row + k, left));
  const realv g = tanh(load_some(row + 2 * k, left)), o = sigmoid_v(load_some(row + 3 * k, left));
  const realv state = f * load_some(c_before + c_before0 + at, left) + i * g;
  store_some(i, row, left);
  store_some(f, row + k, left);
  store_some(g, row + 2 * k, left);
  store_some(o, row + 3 * k, left);
  store_some(state, c + c0 + at, left);
  store_some(o * tanh(state), h + h0 + at, left);
}

/// In: activated gates, c of this step and the one before, gradients of h and c of this step from outside
/// (dh, dc) and from the step after (dh_carry, dc_carry). Out: gradient of the gates before activation;
/// dc_carry for the step before; dh_carry becomes what passes beside the gates (zero, or all of it for a
/// sample that is over), to which the product of the gate gradients with the recurrent weights is added
/// afterwards.
kernel void lstm_cell_backward(global const real* gates, uint gates0, global const real* c, uint c0,
                               global const real* c_before, uint c_before0, global const real* dh, uint dh0,
                               global const real* dc, uint dc0, global const int* length, uint step,
                               global real* dh_carry, uint dh_carry0, global real* dc_carry, uint dc_carry0,
                               global real* dgates, uint dgates0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  const realv gh = load_some(dh + dh0 + at, left) + load_some(dh_carry + dh_carry0 + at, left);
  realv gc = load_some(dc + dc0 + at, left) + load_some(dc_carry + dc_carry0 + at, left);
  global const real* row = gates + gates0 + b * 4 * k + j;
  global real* out = dgates + dgates0 + b * 4 * k + j;
  if (length && step >= (uint)length[b]) {
    for (uint q = 0; q < 4; ++q) store_some((realv)(0), out + q * k, left);
    store_some(gh, dh_carry + dh_carry0 + at, left);
    store_some(gc, dc_carry + dc_carry0 + at, left);
    return;
  }
  const realv i = load_some(row, left), f = load_some(row + k, left), g = load_some(row + 2 * k, left);
  const realv o = load_some(row + 3 * k, left), state = tanh(load_some(c + c0 + at, left));
  gc += gh * o * (1 - state * state);
  store_some(gc * g * i * (1 - i), out, left);
  store_some(gc * load_some(c_before + c_before0 + at, left) * f * (1 - f), out + k, left);
  store_some(gc * i * (1 - g * g), out + 2 * k, left);
  store_some(gh * state * o * (1 - o), out + 3 * k, left);
  store_some((realv)(0), dh_carry + dh_carry0 + at, left);
  store_some(gc * f, dc_carry + dc_carry0 + at, left);
}
