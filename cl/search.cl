// Distances of windows of a collection to hypotheses, at all shifts (SPEC 7, generative search). Motion is
// compared by its spectrum: a window [frames, plain] padded with zeros to a length at which no shift that is
// asked for wraps around; the products of two spectra are the sums over frames of products at every shift.

/// squares[r] = sum over the columns of x[r]^2: one work-item a row.
kernel void search_squares(global const real* x, uint x0, global real* squares, uint squares0, uint rows,
                           uint columns) {
  const uint r = get_global_id(0);
  if (r >= rows) return;
  global const real* p = x + x0 + (size_t)r * columns;
  realv sum = 0;
  for (uint j = 0; j < columns; j += VW) {
    const realv v = load_some(p + j, columns - j);
    sum = fma(v, v, sum);
  }
  squares[squares0 + r] = lane_sum(sum);
}

/// Spectra of windows: out[f, w, :columns] = sum over t of x[starts[w] + t] cos(f, t), out[f, w, columns:] =
/// the same with -sin. `table` [ceil(frequencies / 4), frames, 8] holds four cosines and four negative sines,
/// zeros past the last frequency. Work-items: windows times pieces of VW columns.
kernel void search_spectra(global const real* x, uint x0, global const int* starts, global const real* table,
                           uint table0, global real* out, uint out0, uint windows, uint frames, uint columns,
                           uint frequencies) {
  const uint pieces = (columns + VW - 1) / VW, item = get_global_id(0);
  const uint w = item / pieces, j = item % pieces * VW, left = columns - j;
  if (w >= windows) return;
  global const real* from = x + x0 + (size_t)starts[w] * columns + j;
  global const real* turn = table + table0;
  const size_t plane = (size_t)windows * 2 * columns;
  global real* to = out + out0 + (size_t)w * 2 * columns + j;
  for (uint f = 0; f < frequencies; f += 4, to += 4 * plane) {
    realv c0 = 0, c1 = 0, c2 = 0, c3 = 0, s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (uint t = 0; t < frames; ++t, turn += 8) {
      const realv v = load_some(from + (size_t)t * columns, left);
      c0 = fma(v, (realv)(turn[0]), c0), c1 = fma(v, (realv)(turn[1]), c1);
      c2 = fma(v, (realv)(turn[2]), c2), c3 = fma(v, (realv)(turn[3]), c3);
      s0 = fma(v, (realv)(turn[4]), s0), s1 = fma(v, (realv)(turn[5]), s1);
      s2 = fma(v, (realv)(turn[6]), s2), s3 = fma(v, (realv)(turn[7]), s3);
    }
#define KEEP(i)                                       \
  if (f + i < frequencies) {                          \
    store_some(c##i, to + i * plane, left);           \
    store_some(s##i, to + i * plane + columns, left); \
  }
    KEEP(0) KEEP(1) KEEP(2) KEEP(3)
  }
}

// Sum over n frames and the track's dimensions of the squared difference. The window's track is counted from
// its first frame here and, where `turned`, its first two dimensions are turned back by the third; `other`
// [n, dims, lanes] is the hypotheses' in the same form.
static inline realv track_distance(global const real* track, global const real* other, uint n, uint dims,
                                   uint lanes, uint turned, real yaw_scale) {
  realv sum = 0;
  global const real* origin = track;
  const real c = turned ? cos(origin[2] * yaw_scale) : (real)1;
  const real s = turned ? sin(origin[2] * yaw_scale) : (real)0;
  for (uint t = 0; t < n; ++t, track += dims, other += dims * lanes) {
    uint d = 0;
    if (turned) {
      const real dx = track[0] - origin[0], dz = track[1] - origin[1];
      const realv x = (realv)(c * dx - s * dz) - LOAD_VECTOR(other);
      const realv z = (realv)(s * dx + c * dz) - LOAD_VECTOR(other + lanes);
      sum = fma(x, x, sum), sum = fma(z, z, sum);
      d = 2;
    }
    for (; d < dims; ++d) {
      const realv e = (realv)(track[d] - origin[d]) - LOAD_VECTOR(other + d * lanes);
      sum = fma(e, e, sum);
    }
  }
  return sum;
}

/// For each window and hypothesis the smallest mean square difference over the shifts -reach .. reach, and
/// the shift: frame t of the hypothesis against frame t + shift of the window; of equals the smallest shift.
/// Shapes: products [windows, frequencies, 2, lanes]; squares [rows]; track [rows, dims]; turns [reach + 1,
/// frequencies, 2], cosine and sine; other_squares [reach + 1, 2, lanes], over the frames that overlap at
/// shift s and -s; other_track [reach + 1, frames, dims, lanes], from frame s on; nearest and shifts
/// [windows, lanes]. Work-items: windows times pieces of VW hypotheses.
kernel void search_nearest(global const real* products, uint products0, global const real* squares,
                           uint squares0, global const real* track, uint track0, global const int* starts,
                           global const real* turns, uint turns0, global const real* other_squares,
                           uint other_squares0, global const real* other_track, uint other_track0,
                           global real* nearest, uint nearest0, global real* shifts, uint shifts0,
                           uint windows, uint frames, uint frequencies, uint reach, uint lanes, uint plain,
                           uint dims, uint turned, real yaw_scale) {
  const uint blocks = lanes / VW, item = get_global_id(0);
  const uint w = item / blocks, lane = item % blocks * VW;
  if (w >= windows) return;
  const uint row = starts[w];
  global const real* p = products + products0 + (size_t)w * frequencies * 2 * lanes + lane;
  global const real* own = squares + squares0 + row;
  global const real* place = track + track0 + (size_t)row * dims;
  global const real* turn = turns + turns0;
  real later = 0;  // squares of the frames that overlap, without the first or the last s ones
  for (uint t = 0; t < frames; ++t) later += own[t];
  real earlier = later;
  realv best = INFINITY, where = 0;
  for (uint s = 0; s <= reach; ++s, turn += 2 * frequencies) {
    realv even = 0, odd = 0;
    for (uint f = 0; f < frequencies; ++f) {
      even = fma(LOAD_VECTOR(p + f * 2 * lanes), (realv)(turn[2 * f]), even);
      odd = fma(LOAD_VECTOR(p + (f * 2 + 1) * lanes), (realv)(turn[2 * f + 1]), odd);
    }
    if (s > 0) later -= own[s - 1], earlier -= own[frames - s];
    const uint n = frames - s;
    const real share = 1 / ((real)n * (plain + dims));
    global const real* theirs = other_squares + other_squares0 + s * 2 * lanes + lane;
    global const real* beginning = other_track + other_track0 + lane;
    realv sum = (realv)(later) + LOAD_VECTOR(theirs) - 2 * (even - odd);
    if (dims > 0)
      sum += track_distance(place + (size_t)s * dims, beginning, n, dims, lanes, turned, yaw_scale);
    sum = fmax(sum * share, (realv)(0));
    maskv closer = sum < best;
    best = closer ? sum : best;
    where = closer ? (realv)(s) : where;
    if (s == 0) continue;
    sum = (realv)(earlier) + LOAD_VECTOR(theirs + lanes) - 2 * (even + odd);
    if (dims > 0)
      sum += track_distance(place, beginning + (size_t)s * frames * dims * lanes, n, dims, lanes, turned,
                            yaw_scale);
    sum = fmax(sum * share, (realv)(0));
    closer = sum < best;
    best = closer ? sum : best;
    where = closer ? -(realv)(s) : where;
  }
  STORE_VECTOR(best, nearest + nearest0 + (size_t)w * lanes + lane);
  STORE_VECTOR(where, shifts + shifts0 + (size_t)w * lanes + lane);
}
