// Pointwise part of one GRU step (gates r, z, n as in PyTorch). Gates are [batch, 3k], states [batch, k].

/// In: x = W_i x + b_i, s = W_h h + b_h, and h of the previous step. Out: h of this step and, if `keep`, the
/// activated r, z, n and the part of s for n ([batch, 4k]).
kernel void gru_cell(global const real* x, uint x0, global const real* s, uint s0,
                     global const real* h_before, uint h_before0, global real* kept, uint kept0, uint keep,
                     global real* h, uint h0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  x += x0 + b * 3 * k + j;
  s += s0 + b * 3 * k + j;
  const realv r = sigmoid_v(load_some(x, left) + load_some(s, left));
  const realv z = sigmoid_v(load_some(x + k, left) + load_some(s + k, left));
  const realv state = load_some(s + 2 * k, left), n = tanh(load_some(x + 2 * k, left) + r * state);
  store_some(n + z * (load_some(h_before + h_before0 + at, left) - n), h + h0 + at, left);
  if (!keep) return;
  global real* row = kept + kept0 + b * 4 * k + j;
  store_some(r, row, left);
  store_some(z, row + k, left);
  store_some(n, row + 2 * k, left);
  store_some(state, row + 3 * k, left);
}

/// In: what gru_cell kept, h of the previous step, and the total gradient of h of this step (`dh`). Out:
/// gradients of x and s; in dh, the direct part of the gradient of the previous h (g * z), to which the
/// caller adds the product of ds with the recurrent weights.
kernel void gru_cell_backward(global const real* kept, uint kept0, global const real* h_before,
                              uint h_before0, global real* dh, uint dh0, global real* dx, uint dx0,
                              global real* ds, uint ds0, uint batch, uint k) {
  const uint columns = (k + VW - 1) / VW, item = get_global_id(0);
  const uint b = item / columns, j = item % columns * VW;
  if (b >= batch) return;
  const uint left = k - j, at = b * k + j;
  kept += kept0 + b * 4 * k + j;
  dh += dh0 + at;
  dx += dx0 + b * 3 * k + j;
  ds += ds0 + b * 3 * k + j;
  const realv r = load_some(kept, left), z = load_some(kept + k, left), n = load_some(kept + 2 * k, left);
  const realv g = load_some(dh, left), of_n = g * (1 - z) * (1 - n * n);
  const realv of_r = of_n * load_some(kept + 3 * k, left) * r * (1 - r);
  const realv of_z = g * (load_some(h_before + h_before0 + at, left) - n) * z * (1 - z);
  store_some(of_r, dx, left);
  store_some(of_z, dx + k, left);
  store_some(of_n, dx + 2 * k, left);
  store_some(of_r, ds, left);
  store_some(of_z, ds + k, left);
  store_some(of_n * r, ds + 2 * k, left);
  store_some(g * z, dh, left);
}
