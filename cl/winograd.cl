// Convolutions along time in Winograd's form (ops/winograd.hpp): tiles of frames are mixed by a small matrix,
// multiplied point by point, and mixed back.
#include "gemm_panels.cl"

#define MOST_POINTS 8
// Rows of a work-group: 49 KB of products for 8 points and 32 columns.
#ifdef FOR_CPU
#define ROWS_AT_ONCE 48
#else
#define ROWS_AT_ONCE 12
#endif

// Up to MOST_POINTS rows of as many numbers; unused ones are zero.
typedef struct {
  real at[MOST_POINTS * MOST_POINTS];
} Matrix;

/// out[a, i, e] = sum over j < width of matrix[a, j] * x[i * stride + first + j, e] for a < points and
/// i < tiles; frames outside x are zero. `slab` is the size of one frame of the batch. Work-items: tiles
/// times the vectors of a slab.
kernel void mix_frames(global const real* x, uint x0, global real* out, uint out0, const Matrix matrix,
                       uint points, uint width, uint tiles, uint stride, int first, uint frames, uint slab,
                       uint step) {
  const uint columns = (slab + VW - 1) / VW, item = get_global_id(0);
  const uint tile = item / columns, e = item % columns * VW;
  if (tile >= tiles) return;
  const uint left = slab - e;
  const int from = (int)(tile * stride) + first;
  realv v[MOST_POINTS];
#pragma unroll
  for (int j = 0; j < MOST_POINTS; ++j) {
    const int t = from + j;
    v[j] = 0;
    if (j < (int)width && t >= 0 && t < (int)frames) v[j] = load_some(x + x0 + (uint)t * slab + e, left);
  }
#pragma unroll
  for (int a = 0; a < MOST_POINTS; ++a) {
    realv sum = matrix.at[a * MOST_POINTS] * v[0];
#pragma unroll
    for (int j = 1; j < MOST_POINTS; ++j) sum = fma((realv)(matrix.at[a * MOST_POINTS + j]), v[j], sum);
    if (a < (int)points) store_some(sum, out + out0 + ((size_t)a * step * tiles + tile) * slab + e, left);
  }
}

// Values of p that winograd_pack keeps at once.
#define PACK_BLOCK 64
#define MOST_TAPS 3

// U[a] = sum over taps s of matrix[a, s] * W_s, packed as in gemm_pack: out[a][panel][p][COLUMNS]. Element
// (p, j) of W_s is at w[tap s + p * w_p + j * w_column]; one of w_p and w_column is 1. Columns past n are
// undefined. Work-groups: x over panels, y over blocks of PACK_BLOCK values of p.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void winograd_pack(
    global const real* w, uint tap0, uint tap1, uint tap2, uint taps, uint w_p, uint w_column, uint n, uint k,
    const Matrix matrix, uint points, global real* out, uint out0) {
  realv packed[MOST_TAPS * PACK_BLOCK * 2];
  const uint first[MOST_TAPS] = {tap0, tap1, tap2};
  const uint column = get_group_id(0) * COLUMNS, p = get_group_id(1) * PACK_BLOCK;
  const uint width = min((uint)COLUMNS, n - column), count = min((uint)PACK_BLOCK, k - p);
  for (uint s = 0; s < taps; ++s) {
    global const real* from = w + first[s] + p * w_p + column * w_column;
    realv* to = packed + s * PACK_BLOCK * 2;
    if (w_column != 1)
      pack_transposed(from, w_column, count, width, to);
    else
      pack_narrow_rows(from, w_p, count, width, width == COLUMNS ? count : 0, to);
  }
  const size_t panel = (size_t)k * COLUMNS;
  global real* to = out + out0 + get_group_id(0) * panel + p * COLUMNS;
  for (uint a = 0; a < points; ++a, to += get_num_groups(0) * panel) {
    const realv m0 = matrix.at[a * MOST_POINTS], m1 = matrix.at[a * MOST_POINTS + 1],
                m2 = matrix.at[a * MOST_POINTS + 2];
    for (uint i = 0; i < 2 * count; ++i) {
      realv sum = fma(m1, packed[PACK_BLOCK * 2 + i], m0 * packed[i]);
      if (taps == MOST_TAPS) sum = fma(m2, packed[2 * PACK_BLOCK * 2 + i], sum);
      WRITE(to + i * VW, sum);
    }
  }
}

typedef struct {
  uint rows, batch, n, k, points, frames, tile_frames, flags;
  uint rows_per_group;
} Tiles;

// y[frame of row and o] = epilogue(sum over points a of inverse[o, a] * (V[a] * U[a])), V [points, rows, k],
// U [points, panels, k, COLUMNS]; row r is sample r % batch of tile r / batch, whose frames start at r /
// batch * tile_frames. Work-groups: x over panels, y over rows_per_group <= ROWS_AT_ONCE rows.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void winograd_multiply(
    global const real* restrict v, uint v0, global const real* restrict u, uint u0, global real* restrict y,
    uint y0, global const real* restrict bias, uint bias0, global const real* restrict residual,
    uint residual0, global real* restrict rectified, uint rectified0, const Tiles g, const Matrix inverse) {
  realv products[MOST_POINTS * ROWS_AT_ONCE * 2], tile[2];
  const uint k = g.k, n = g.n, points = g.points, flags = g.flags;
  const uint j = get_group_id(0) * COLUMNS, width = min((uint)COLUMNS, n - j);
  const uint first = get_group_id(1) * g.rows_per_group, rows = min(g.rows - first, g.rows_per_group);
  const size_t panel = (size_t)k * COLUMNS;
  v += v0 + (size_t)first * k;
  u += u0 + get_group_id(0) * panel;
  // Rows a multiple of 4 KB apart map to one set of the 8-way L1 cache: take at most 8 rows at a time.
  const uint most = MOST_ROWS > 8 && k * REAL_BYTES % 4096 == 0 ? 8 : MOST_ROWS;
  for (uint a = 0; a < points; ++a) {
    for (uint r = 0, count; r < rows; r += count) {
      count = tile_rows(rows - r, most);
      realv* to = products + (a * ROWS_AT_ONCE + r) * 2;
      global const real* from = v + (size_t)r * k;
      for (uint e = 0; e < 2 * count; ++e) to[e] = 0;
#define MULTIPLY(R) \
  if (count == R) multiply_panel_##R(from, k, k, u, to);
      FOR_TILE_ROWS(MULTIPLY)
    }
    v += (size_t)g.rows * k;
    u += get_num_groups(0) * panel;
  }
  for (uint r = 0; r < rows; ++r) {
    const uint t = (first + r) / g.batch * g.tile_frames, b = (first + r) % g.batch;
    const uint frames = min(g.tile_frames, g.frames - t);
    size_t at = ((size_t)t * g.batch + b) * n + j;
    for (uint o = 0; o < frames; ++o, at += (size_t)g.batch * n) {
      realv x = 0, z = 0;
      for (uint a = 0; a < points; ++a) {
        const realv weight = inverse.at[o * MOST_POINTS + a];
        x = fma(weight, products[(a * ROWS_AT_ONCE + r) * 2], x);
        z = fma(weight, products[(a * ROWS_AT_ONCE + r) * 2 + 1], z);
      }
      if (flags == 0 && width == COLUMNS) {
        WRITE(y + y0 + at, x);
        WRITE(y + y0 + at + VW, z);
        continue;
      }
      if (flags & ACCUMULATE) {
        load_tile(y + y0 + at, 0, 1, width, tile);
        x += tile[0], z += tile[1];
      }
      tile[0] = x, tile[1] = z;
      store_tile(y + y0 + at, 0, 1, width, bias + bias0 + j, residual + residual0 + at, 0, flags, tile);
      if (flags & RECTIFY) rectify(y + y0 + at, 0, 1, width, rectified + rectified0 + at);
    }
  }
}
