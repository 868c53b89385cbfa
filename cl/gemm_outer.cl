// C = epilogue((accumulate ? C : 0) + sum over segments of A^T * B) for an A stored [p][i]: the gradient of
// weights, a sum of outer products. Written for CPU devices, correct on all; bit-equal to gemm.cl.
//
// A column of A would be read at a stride that maps to few sets of the L1 cache, so a block of A is packed
// too: it is copied once for all panels of the work-group.
#include "gemm_tiles.cl"

// Values of p and rows of C packed at once: 48 KB of A, of which a tile reads a quarter, and 16 KB of B.
#ifdef FOR_CPU
#define OUTER_BLOCK 128
#define OUTER_ROWS 96
#else
#define OUTER_BLOCK 32
#define OUTER_ROWS 16
#endif

#define FMA_PACKED(i)            \
  {                              \
    const realv value = a[i];    \
    x##i = fma(value, b0, x##i); \
    y##i = fma(value, b1, y##i); \
  }
// tile[R][COLUMNS] += a block of A, stored [p][OUTER_ROWS], times a panel of B.
#define DEFINE_MULTIPLY_PACKED(R)                                                                  \
  static inline void multiply_packed_##R(const real* a, uint count, const realv* b, realv* tile) { \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, a += OUTER_ROWS, b += 2) {                     \
      const realv b0 = b[0], b1 = b[1];                                                            \
      ROWS_##R(FMA_PACKED)                                                                         \
    }                                                                                              \
    ROWS_##R(STORE)                                                                                \
  }
FOR_TILE_ROWS(DEFINE_MULTIPLY_PACKED)

// to[count][OUTER_ROWS] from A stored [p][i]. The last rows of A are not read past `rows`.
static inline void pack_rows_of_a(global const real* a, size_t a_p, uint count, uint rows, uint readable,
                                  realv* to) {
  for (uint p = 0; p < count; ++p, a += a_p, to += OUTER_ROWS / VW)
    for (uint e = 0; e < rows; e += VW) {
      PREFETCH(a + ROWS_AHEAD * a_p + e);
      if (e + VW <= rows || p < readable)
        to[e / VW] = READ(a + e);
      else
        for (uint i = e; i < rows; ++i) ((real*)to)[i] = a[i];
    }
}

// Element (i, p) of A is a[i + p * a_p]; one of b_p and b_column is 1. Work-groups: x over panels, y over at
// most OUTER_ROWS rows, z over the batch.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_outer(
    global const real* restrict a, global const real* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g) {
  realv packed_a[OUTER_BLOCK * OUTER_ROWS / VW], packed_b[OUTER_BLOCK * 2], tile[MOST_ROWS * 2];
  const size_t batch = get_group_id(2);
  a += g.a_first + batch * g.a_batch;
  b += g.b_first + batch * g.b_batch;
  c += g.c_first + batch * g.c_batch;
  bias += g.bias_first;
  residual += g.residual_first;
  const uint k = g.k, segments = g.segments, flags = g.flags;
  const uint row_begin = get_group_id(1) * g.rows_per_group, rows = min(g.m - row_begin, g.rows_per_group);
  const uint column_begin = get_group_id(0) * g.panels_per_group * COLUMNS;
  const uint column_end = min(g.n, column_begin + g.panels_per_group * COLUMNS);
  const size_t b_p = g.b_p, b_column = g.b_column, c_row = g.c_row, residual_row = g.residual_row;
  uint s = 0, p = 0;
  do {
    const uint count = min((uint)OUTER_BLOCK, k - p);
    const bool first = s == 0 && p == 0, last = s + 1 == segments && p + count == k;
    // Reading VW elements from a row stays inside A if another row of at least as many follows.
    const uint readable = g.a_p >= VW ? k - 1 - p : 0;
    pack_rows_of_a(a + g.a_segment[s] + (size_t)p * g.a_p + row_begin, g.a_p, count, rows, readable,
                   packed_a);
    for (uint j = column_begin; j < column_end; j += COLUMNS) {
      const uint width = min((uint)COLUMNS, column_end - j);
      global const real* from = b + g.b_segment[s] + p * b_p + j * b_column;
      if (b_column == 1) {
        // Reading COLUMNS elements from a row stays inside B if the rows after it hold enough elements.
        const size_t past = width == COLUMNS ? 0 : b_p == 0 ? k : (COLUMNS - width + b_p - 1) / b_p;
        pack_narrow_rows(from, b_p, count, width, k - p > past ? k - p - past : 0, packed_b);
      } else {
        pack_transposed(from, b_column, count, width, packed_b);
      }
      for (uint i = 0, size; i < rows; i += size) {
        size = tile_rows(rows - i, MOST_ROWS);
        global real* at = c + (size_t)(row_begin + i) * c_row + j;
        if (first && !(flags & ACCUMULATE))
          for (uint e = 0; e < 2 * size; ++e) tile[e] = 0;
        else
          load_tile(at, c_row, size, width, tile);
        const real* block = (const real*)packed_a + i;
#define MULTIPLY(R) \
  if (size == R) multiply_packed_##R(block, count, packed_b, tile);
        FOR_TILE_ROWS(MULTIPLY)
        store_tile(at, c_row, size, width, bias + j, residual + (row_begin + i) * residual_row + j,
                   residual_row, last ? flags : 0, tile);
      }
    }
    p += count;
    if (p >= k) p = 0, ++s;
  } while (s < segments);
}
