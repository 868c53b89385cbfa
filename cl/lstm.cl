// Pointwise part of one LSTM step (gates i, f, g, o as in PyTorch). Gates are [batch, 4k], cell states
// [batch, k]; hidden states are [batch, k] with row stride h_row. A sample whose sequence has ended (step >=
// length[b]) keeps its state; a null length means that none ends.

/// In: pre-activation gates, c (and with length h) of the previous step. Out: activated gates (in place), h
/// and c of this step.
kernel void lstm_cell(global real* gates, uint gates0, global const real* c_before, uint c_before0,
                      global const real* h_before, uint h_before0, global const int* length, uint step,
                      global real* h, uint h0, uint h_row, global real* c, uint c0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  global real* row = gates + gates0 + b * 4 * k + j;
  if (length && step >= (uint)length[b]) {
    store_some(load_some(h_before + h_before0 + b * h_row + j, left), h + h0 + b * h_row + j, left);
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
  store_some(o * tanh(state), h + h0 + b * h_row + j, left);
}

/// In: activated gates; c of this step and the previous one; gradients of h and c of this step from outside
/// the layer (dh, with row stride dh_row; dc may be null) and, unless this is the `last` step, from the next
/// step (dh_carry, dc_carry; dh_carry is null if dh holds the total). Out: gradient of the pre-activation
/// gates; dc_carry for the previous step; if not null, the total gradients of h and c (h_total, c_total). The
/// caller computes dh_carry for the previous step as the product of the gate gradients with the recurrent
/// weights. With `length`, it adds the product to what this kernel leaves in dh_carry: the total gradient of
/// h for a sample that has ended, else zero.
kernel void lstm_cell_backward(global const real* gates, uint gates0, global const real* c, uint c0,
                               global const real* c_before, uint c_before0, global const real* dh, uint dh0,
                               uint dh_row, global const real* dc, uint dc0, global const int* length,
                               uint step, uint last, global real* dh_carry, uint dh_carry0,
                               global real* dc_carry, uint dc_carry0, global real* dgates, uint dgates0,
                               global real* h_total, uint h_total0, global real* c_total, uint c_total0,
                               uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  realv gh = load_some(dh + dh0 + b * dh_row + j, left), gc = 0;
  if (dc) gc = load_some(dc + dc0 + at, left);
  if (!last) {
    if (dh_carry) gh += load_some(dh_carry + dh_carry0 + at, left);
    gc += load_some(dc_carry + dc_carry0 + at, left);
  }
  global const real* row = gates + gates0 + b * 4 * k + j;
  global real* out = dgates + dgates0 + b * 4 * k + j;
  if (length) {
    const bool over = step >= (uint)length[b];
    store_some(over ? gh : (realv)(0), dh_carry + dh_carry0 + at, left);
    if (over) {
      for (uint q = 0; q < 4; ++q) store_some((realv)(0), out + q * k, left);
      store_some(gc, dc_carry + dc_carry0 + at, left);
      return;
    }
  }
  const realv i = load_some(row, left), f = load_some(row + k, left), g = load_some(row + 2 * k, left);
  const realv o = load_some(row + 3 * k, left), state = tanh(load_some(c + c0 + at, left));
  gc += gh * o * (1 - state * state);
  store_some(gc * g * i * (1 - i), out, left);
  store_some(gc * load_some(c_before + c_before0 + at, left) * f * (1 - f), out + k, left);
  store_some(gc * i * (1 - g * g), out + 2 * k, left);
  store_some(gh * state * o * (1 - o), out + 3 * k, left);
  store_some(gc * f, dc_carry + dc_carry0 + at, left);
  if (h_total) store_some(gh, h_total + h_total0 + at, left);
  if (c_total) store_some(gc, c_total + c_total0 + at, left);
}

// The derivative of lstm_cell_backward over all steps (without `length`), for the second derivative of the
// layer. It takes two sweeps: forward in time, because lstm_cell_backward runs backward, then backward
// through the activations that it used. The adjoint of a quantity is the derivative of the final scalar with
// respect to it.

/// First sweep. In: the adjoint of the gate gradients including the part from the previous step (`u`); inputs
/// and results of lstm_cell_backward (activated gates, c, h_total, c_total); from the previous step the
/// adjoint of c_total and the direct adjoint of c (both null in the first step). Out: the adjoints of h_total
/// and c_total, which are also those of dh and dc; the direct adjoints of the activations (`direct_gates`,
/// may be u) and of c; and an addition to the direct adjoint of the previous c.
kernel void lstm_grad_forward(global const real* u, uint u0, global const real* gates, uint gates0,
                              global const real* c, uint c0, global const real* c_before, uint c_before0,
                              global const real* h_total, uint h_total0, global const real* c_total,
                              uint c_total0, global const real* c_adjoint_before, uint c_adjoint_before0,
                              global real* direct_before, uint direct_before0, global real* h_adjoint,
                              uint h_adjoint0, global real* c_adjoint, uint c_adjoint0,
                              global real* direct_gates, uint direct_gates0, global real* direct,
                              uint direct0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j, row = b * 4 * k + j;
  u += u0 + row;
  gates += gates0 + row;
  direct_gates += direct_gates0 + row;
  const realv ui = load_some(u, left), uf = load_some(u + k, left), ug = load_some(u + 2 * k, left),
              uo = load_some(u + 3 * k, left);
  const realv i = load_some(gates, left), f = load_some(gates + k, left), g = load_some(gates + 2 * k, left),
              o = load_some(gates + 3 * k, left);
  const realv s = tanh(load_some(c + c0 + at, left)), before = load_some(c_before + c_before0 + at, left);
  const realv gh = load_some(h_total + h_total0 + at, left), gc = load_some(c_total + c_total0 + at, left);
  const realv i_grad = i * (1 - i), f_grad = f * (1 - f), g_grad = 1 - g * g, o_grad = o * (1 - o),
              s_grad = 1 - s * s;
  realv of_c = ui * g * i_grad + uf * before * f_grad + ug * i * g_grad,
        of_f = uf * gc * before * (1 - 2 * f);
  if (c_adjoint_before) {
    const realv carried = load_some(c_adjoint_before + c_adjoint_before0 + at, left);
    of_c += carried * f;
    of_f += carried * gc;
    global real* earlier = direct_before + direct_before0 + at;
    store_some(load_some(earlier, left) + uf * gc * f_grad, earlier, left);
  }
  const realv of_s = uo * gh * o_grad - 2 * of_c * gh * o * s;
  store_some(uo * s * o_grad + of_c * o * s_grad, h_adjoint + h_adjoint0 + at, left);
  store_some(of_c, c_adjoint + c_adjoint0 + at, left);
  store_some(gc * (ui * g * (1 - 2 * i) + ug * g_grad), direct_gates, left);
  store_some(of_f, direct_gates + k, left);
  store_some(gc * (ui * i_grad - 2 * ug * g * i), direct_gates + 2 * k, left);
  store_some(gh * (uo * s * (1 - 2 * o) + of_c * s_grad), direct_gates + 3 * k, left);
  store_some(of_s * s_grad, direct + direct0 + at, left);
}

/// Second sweep. In: the direct adjoints of the activations and of c from lstm_grad_forward; the adjoints of
/// h and c from the next step (h_carry is null in the last step). Out: the adjoint of the pre-activation
/// gates, in place of the direct one; c_carry for the previous step.
kernel void lstm_grad_backward(global const real* gates, uint gates0, global const real* c, uint c0,
                               global const real* c_before, uint c_before0, global const real* direct,
                               uint direct0, global const real* h_carry, uint h_carry0, global real* c_carry,
                               uint c_carry0, global real* adjoint, uint adjoint0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j, row = b * 4 * k + j;
  gates += gates0 + row;
  adjoint += adjoint0 + row;
  c_carry += c_carry0 + at;
  const realv i = load_some(gates, left), f = load_some(gates + k, left), g = load_some(gates + 2 * k, left),
              o = load_some(gates + 3 * k, left);
  realv of_c = load_some(direct + direct0 + at, left), of_o = load_some(adjoint + 3 * k, left);
  if (h_carry) {
    const realv s = tanh(load_some(c + c0 + at, left)), of_h = load_some(h_carry + h_carry0 + at, left);
    of_c += load_some(c_carry, left) + of_h * o * (1 - s * s);
    of_o += of_h * s;
  }
  const realv of_i = load_some(adjoint, left) + of_c * g, of_g = load_some(adjoint + 2 * k, left) + of_c * i;
  const realv of_f = load_some(adjoint + k, left) + of_c * load_some(c_before + c_before0 + at, left);
  store_some(of_i * i * (1 - i), adjoint, left);
  store_some(of_f * f * (1 - f), adjoint + k, left);
  store_some(of_g * (1 - g * g), adjoint + 2 * k, left);
  store_some(of_o * o * (1 - o), adjoint + 3 * k, left);
  store_some(of_c * f, c_carry, left);
}
