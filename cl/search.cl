// Distances between windows of a motion collection and generated hypotheses, at all shifts (Lin & Amer,
// generative search). They are computed from spectra: windows [frames, plain] are zero-padded so that no
// requested shift wraps around, and products of spectra give the cross-correlation over frames at every
// shift.

#ifdef WIDE
#define TEAM_IS_GROUP
#endif
#include "team.cl"

/// Spectra of windows: out[f, w, :columns] = sum over t of x[starts[w] + t] cos(f, t); out[f, w, columns:] is
/// the same with -sin. `table` [ceil(frequencies / 4), frames, 8] holds four cosines and four negative sines,
/// zero past the last frequency. Work-items: windows times blocks of VW columns.
kernel void search_spectra(global const real* x, uint x0, global const int* starts, global const real* table,
                           uint table0, global real* out, uint out0, uint windows, uint frames, uint columns,
                           uint frequencies) {
  const uint pieces = (columns + VW - 1) / VW, item = get_global_id(0), w = item / pieces;
  if (w >= windows) return;
  // The last block ends with the row and overlaps the previous one: the same values are written twice.
  const uint j = min(item % pieces * VW, columns - min(columns, (uint)VW)), left = columns - j;
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

// The track of a window is the dimensions that are taken relative to the first overlapping frame. If
// `turned`, the first three are x, z and yaw, and (x, z) is rotated by minus the yaw of that frame.

/// own[w, s, 0] = sum of squares over the frames of window w that overlap a hypothesis shifted by s (the last
/// frames - s); own[w, s, 1] the same for a shift by -s (the first frames - s); own[w, s, 2:4] = cosine and
/// sine of the yaw of frame s. `squares` [rows] is that of the plain dimensions, `track` is [rows, dims].
/// Rotation does not change squares.
#ifdef WIDE
/// Work-items: windows times shifts.
kernel void search_overlaps(global const real* squares, uint squares0, global const real* track, uint track0,
                            global const int* starts, global real* own, uint own0, uint windows, uint frames,
                            uint reach, uint dims, uint turned, real yaw_scale) {
  const uint w = get_global_id(0) / (reach + 1), s = get_global_id(0) % (reach + 1), n = frames - s;
  if (w >= windows) return;
  global const real* square = squares + squares0 + starts[w];
  global const real* place = track + track0 + (size_t)starts[w] * dims;
  global real* out = own + own0 + ((size_t)w * (reach + 1) + s) * 4;
  real late = 0, early = 0;
  for (uint t = 0; t < n; ++t) {
    late += square[t + s], early += square[t];
    for (uint d = 0; d < dims; ++d) {
      const real after = place[(t + s) * dims + d] - place[s * dims + d];
      const real before = place[t * dims + d] - place[d];
      late = fma(after, after, late), early = fma(before, before, early);
    }
  }
  const real angle = turned ? place[s * dims + 2] * yaw_scale : (real)0;
  out[0] = late, out[1] = early, out[2] = cos(angle), out[3] = sin(angle);
}
#else
/// Sums for larger s are updated from those for s - 1. Work-groups of one item: windows. A driver that makes
/// vectors of the items of a group, as Intel's does, would give the last ones another sine.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void search_overlaps(
    global const real* squares, uint squares0, global const real* track, uint track0,
    global const int* starts, global real* own, uint own0, uint windows, uint frames, uint reach, uint dims,
    uint turned, real yaw_scale) {
  const uint w = get_group_id(0);
  global const real* square = squares + squares0 + starts[w];
  global const real* place = track + track0 + (size_t)starts[w] * dims;
  global real* out = own + own0 + (size_t)w * (reach + 1) * 4;
  real late = 0;
  for (uint t = 0; t < frames; ++t) late += square[t];
  real early = late;
  for (uint s = 0; s <= reach; ++s) {
    if (s > 0) late -= square[s - 1], early -= square[frames - s];
    const real angle = turned ? place[s * dims + 2] * yaw_scale : (real)0;
    out[s * 4] = late, out[s * 4 + 1] = early, out[s * 4 + 2] = cos(angle), out[s * 4 + 3] = sin(angle);
  }
  for (uint d = 0; d < dims; ++d) {
    const real origin = place[d];
    real sum = 0, all = 0;
    for (uint t = 0; t < frames; ++t) {
      const real x = place[t * dims + d] - origin;
      sum += x, all = fma(x, x, all);
    }
    early = late = all;
    for (uint s = 0; s <= reach; ++s) {
      if (s > 0) {
        const real gone = place[(s - 1) * dims + d] - origin, last = place[(frames - s) * dims + d] - origin;
        sum -= gone, late -= gone * gone, early -= last * last;
      }
      const real base = place[s * dims + d] - origin;  // relative to frame s
      out[s * 4] += late - 2 * base * sum + (frames - s) * base * base;
      out[s * 4 + 1] += early;
    }
  }
}
#endif

// Sum over n frames of the products of a window's track, from its first overlapping frame, and that of the
// hypotheses, `other` [n, dims, lanes], which is already relative and rotated; `sums` [dims, lanes] is its
// sum over frames. With (x, z) relative to the frame `origin`, (bx, bz) that of the first overlapping frame
// and (h, k) the hypothesis', the product after rotation is cos (x h + z k) + sin (x k - z h), minus the same
// expression with (bx, bz) and the sums of (h, k).
static inline realv track_products(global const real* track, global const real* origin,
                                   global const real* other, global const real* sums, uint n, uint dims,
                                   uint lanes, uint turned, real cosine, real sine) {
  const size_t next = (size_t)dims * lanes;
  realv result = 0;
  if (turned) {
    const real x = origin[0], z = origin[1], yaw = origin[2];
    const real bx = track[0] - x, bz = track[1] - z, by = track[2] - yaw;
    realv xh = 0, zk = 0, xk = 0, zh = 0, y = 0;
    for (uint t = 0; t < n; ++t) {
      global const real* at = other + t * next;
      const realv h = LOAD_VECTOR(at), k = LOAD_VECTOR(at + lanes), turn = LOAD_VECTOR(at + 2 * lanes);
      const realv dx = track[t * dims] - x, dz = track[t * dims + 1] - z;
      xh = fma(dx, h, xh), zk = fma(dz, k, zk), xk = fma(dx, k, xk), zh = fma(dz, h, zh);
      y = fma((realv)(track[t * dims + 2] - yaw), turn, y);
    }
    const realv h = LOAD_VECTOR(sums), k = LOAD_VECTOR(sums + lanes);
    const realv along = xh + zk - (bx * h + bz * k), across = xk - zh - (bx * k - bz * h);
    result = cosine * along + sine * across + y - by * LOAD_VECTOR(sums + 2 * lanes);
  }
  for (uint d = turned ? 3 : 0; d < dims; ++d) {
    realv sum = 0;
    for (uint t = 0; t < n; ++t)
      sum = fma((realv)(track[t * dims + d] - track[d]), LOAD_VECTOR(other + t * next + d * lanes), sum);
    result += sum;
  }
  return result;
}

/// For each window and hypothesis, the smallest mean squared difference over the shifts -reach .. reach and
/// its shift (the smallest in magnitude among equals). Shapes: products [windows, frequencies, 2, lanes]; own
/// [windows, reach + 1, 4] from search_overlaps; track [rows, dims]; turns [reach + 1, frequencies, 2],
/// cosine and sine; other_squares [reach + 1, 2, lanes], like own; other_track
/// [reach + 1, frames, dims, lanes], starting at frame s; other_sums [reach + 1, 2, dims, lanes], over the
/// overlapping frames: for shift s from frame 0, for -s from frame s; nearest and shifts [windows, lanes].
/// Teams: windows times blocks of VW hypotheses; the items of a team share the shifts.
TEAM_SIZE kernel void search_nearest(global const real* products, uint products0, global const real* own,
                                     uint own0, global const real* track, uint track0,
                                     global const int* starts, global const real* turns, uint turns0,
                                     global const real* other_squares, uint other_squares0,
                                     global const real* other_track, uint other_track0,
                                     global const real* other_sums, uint other_sums0, global real* nearest,
                                     uint nearest0, global real* shifts, uint shifts0, uint windows,
                                     uint frames, uint frequencies, uint reach, uint lanes, uint dof,
                                     uint dims, uint turned) {
#ifdef TEAM_IS_GROUP
  local realv bests[GROUP], places[GROUP];
#endif
  const uint blocks = lanes / VW, at = TEAM;
  const uint w = at / blocks, lane = at % blocks * VW;
  if (w >= windows) return;
  global const real* p = products + products0 + (size_t)w * frequencies * 2 * lanes + lane;
  global const real* place = track + track0 + (size_t)starts[w] * dims;
  global const real* mine = own + own0 + (size_t)w * (reach + 1) * 4;
  global const real* turn = turns + turns0 + ITEM * 2 * frequencies;
  realv best = INFINITY, where = 0;
  for (uint s = ITEM; s <= reach; s += ITEMS, turn += ITEMS * 2 * frequencies) {
    realv even = 0, odd = 0;
    for (uint f = 0; f < frequencies; ++f) {
      even = fma(LOAD_VECTOR(p + f * 2 * lanes), (realv)(turn[2 * f]), even);
      odd = fma(LOAD_VECTOR(p + (f * 2 + 1) * lanes), (realv)(turn[2 * f + 1]), odd);
    }
    const uint n = frames - s;
    const real share = 1 / ((real)n * dof);
    for (uint early = 0; early < (s > 0 ? 2u : 1u); ++early) {
      realv product = early ? even + odd : even - odd;
      const uint from = early ? 0 : s, pair = s * 2 + early;  // from: the window's first overlapping frame
      if (dims > 0)
        product +=
            track_products(place + from * dims, place,
                           other_track + other_track0 + (size_t)(s - from) * frames * dims * lanes + lane,
                           other_sums + other_sums0 + (size_t)pair * dims * lanes + lane, n, dims, lanes,
                           turned, mine[from * 4 + 2], mine[from * 4 + 3]);
      const realv theirs = LOAD_VECTOR(other_squares + other_squares0 + pair * lanes + lane);
      const realv mean = fmax((mine[s * 4 + early] + theirs - 2 * product) * share, (realv)(0));
      const maskv closer = mean < best;
      best = closer ? mean : best;
      where = closer ? (realv)(early ? -(real)s : (real)s) : where;
    }
  }
#ifdef TEAM_IS_GROUP
  bests[ITEM] = best, places[ITEM] = where;
  for (uint step = GROUP / 2; step > 0; step /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (ITEM < step) {
      const realv other = bests[ITEM + step], there = places[ITEM + step];
      // Among equals the first in the order 0, 1, -1, 2, -2 ...
      const maskv sooner = fabs(there) < fabs(where) || (fabs(there) == fabs(where) && there > where);
      const maskv closer = other < best || (other == best && sooner);
      bests[ITEM] = best = closer ? other : best;
      places[ITEM] = where = closer ? there : where;
    }
  }
  if (ITEM > 0) return;
#endif
  STORE_VECTOR(best, nearest + nearest0 + (size_t)w * lanes + lane);
  STORE_VECTOR(where, shifts + shifts0 + (size_t)w * lanes + lane);
}
