// C = epilogue((accumulate ? C : 0) + sum over segments of A * B), row-major. Written for CPU devices,
// correct on all.
//
// Each work-group has one work-item, which computes a range of rows and a few panels of COLUMNS columns. It
// packs a panel of B (copied or transposed) into private memory and holds tiles of up to 12 x COLUMNS
// elements of C in registers during the loop over p. Every element is fma(a, b, sum) with p ascending,
// segment after segment, starting from C or 0: neither the row, nor the tile size, nor the blocking of p
// changes a bit of the result.
#include "gemm_tiles.cl"

// sums[2 * DIRECT] += a row of A times DIRECT panels of B stored [p][j], without packing: with few rows,
// packing costs as much as the product.
static inline void multiply_direct(global const real* a, size_t a_stride, global const real* b,
                                   size_t b_stride, uint count, realv* sums) {
  realv s0 = sums[0], s1 = sums[1], s2 = sums[2], s3 = sums[3];
  realv s4 = sums[4], s5 = sums[5], s6 = sums[6], s7 = sums[7];
  for (uint p = 0; p < count; ++p, a += a_stride, b += b_stride) {
    const realv value = *a;
    s0 = fma(value, READ(b), s0), s1 = fma(value, READ(b + VW), s1);
    s2 = fma(value, READ(b + 2 * VW), s2), s3 = fma(value, READ(b + 3 * VW), s3);
    s4 = fma(value, READ(b + 4 * VW), s4), s5 = fma(value, READ(b + 5 * VW), s5);
    s6 = fma(value, READ(b + 6 * VW), s6), s7 = fma(value, READ(b + 7 * VW), s7);
  }
  sums[0] = s0, sums[1] = s1, sums[2] = s2, sums[3] = s3;
  sums[4] = s4, sums[5] = s5, sums[6] = s6, sums[7] = s7;
}

// One of a_row and a_p is 1, and one of b_p and b_column. Work-groups: x over panels, y over rows, z over the
// batch.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm(
    global const real* restrict a, global const real* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g) {
  realv packed[BLOCK * 2], tile[MOST_ROWS * 2];
  const size_t batch = get_group_id(2);
  a += g.a_first + batch * g.a_batch;
  b += g.b_first + batch * g.b_batch;
  c += g.c_first + batch * g.c_batch;
  bias += g.bias_first;
  residual += g.residual_first;
  const uint k = g.k, segments = g.segments, flags = g.flags;
  const uint row_begin = get_group_id(1) * g.rows_per_group, row_end = min(g.m, row_begin + g.rows_per_group);
  const uint column_begin = get_group_id(0) * g.panels_per_group * COLUMNS;
  const uint column_end = min(g.n, column_begin + g.panels_per_group * COLUMNS);
  const size_t a_row = g.a_row, a_p = g.a_p, b_p = g.b_p, b_column = g.b_column, c_row = g.c_row;
  const size_t residual_row = g.residual_row;
  const uint panels_at_once = min(g.panels_at_once, (uint)BLOCK);
  const uint block = BLOCK / panels_at_once;
  const bool together = k <= block / segments;

  for (uint first_column = column_begin; first_column < column_end;
       first_column += panels_at_once * COLUMNS) {
    const uint columns = min(panels_at_once * (uint)COLUMNS, column_end - first_column);
    if (b_column == 1 && row_end - row_begin <= 2 && columns == DIRECT * COLUMNS) {
      for (uint i = row_begin; i < row_end; ++i) {
        realv sums[2 * DIRECT];
        global real* at = c + i * c_row + first_column;
        for (uint w = 0; w < 2 * DIRECT; ++w) sums[w] = flags & ACCUMULATE ? READ(at + w * VW) : (realv)(0);
        for (uint s = 0; s < segments; ++s)
          multiply_direct(a + g.a_segment[s] + i * a_row, a_p, b + g.b_segment[s] + first_column, b_p, k,
                          sums);
        for (uint w = 0; w < 2 * DIRECT; w += 2)
          store_tile(at + w * VW, 0, 1, COLUMNS, bias + first_column + w * VW,
                     residual + i * residual_row + first_column + w * VW, 0, flags, sums + w);
      }
      continue;
    }
    uint segment = 0, p = 0;  // where the next block starts
    do {
      const uint count = together ? k : min(block, k - p);
      const uint segment_end = together ? segments : segment + 1;
      const bool first = segment == 0 && p == 0, last = segment_end == segments && p + count == k;
      const uint segment_size = count * 2, panel_size = (segment_end - segment) * segment_size;
      for (uint s = segment; s < segment_end; ++s) {
        global const real* from = b + g.b_segment[s] + p * b_p + first_column * b_column;
        realv* to = packed + (s - segment) * segment_size;
        if (b_column == 1) {
          const uint whole = columns / COLUMNS, width = columns % COLUMNS;
          pack_rows(from, b_p, count, whole, panel_size, to);
          if (width > 0) {
            // Reading COLUMNS elements from a row stays inside B if the rows after it hold enough elements.
            const size_t past = b_p == 0 ? k : (COLUMNS - width + b_p - 1) / b_p;
            pack_narrow_rows(from + whole * COLUMNS, b_p, count, width, k - p > past ? k - p - past : 0,
                             to + whole * panel_size);
          }
        } else {
          for (uint j = 0; j < columns; j += COLUMNS, to += panel_size)
            pack_transposed(from + j * b_column, b_column, count, min((uint)COLUMNS, columns - j), to);
        }
      }
      for (uint j = first_column; j < first_column + columns; j += COLUMNS) {
        const uint width = min((uint)COLUMNS, first_column + columns - j);
        const realv* panel = packed + (j - first_column) / COLUMNS * panel_size;
        for (uint i = row_begin, rows; i < row_end; i += rows) {
          rows = tile_rows(row_end - i, MOST_ROWS);
          global real* at = c + i * c_row + j;
          if (first && !(flags & ACCUMULATE)) {
            for (uint e = 0; e < 2 * rows; ++e) tile[e] = 0;
          } else {
            load_tile(at, c_row, rows, width, tile);
          }
          for (uint s = segment; s < segment_end; ++s) {
            global const real* rows_of_a = a + g.a_segment[s] + i * a_row + p * a_p;
            const realv* piece = panel + (s - segment) * segment_size;
#define MULTIPLY(R)                                                 \
  if (rows == R) {                                                  \
    if (width > VW)                                                 \
      multiply_##R(rows_of_a, a_row, a_p, count, piece, tile);      \
    else                                                            \
      multiply_half_##R(rows_of_a, a_row, a_p, count, piece, tile); \
  }
            FOR_TILE_ROWS(MULTIPLY)
          }
          store_tile(at, c_row, rows, width, bias + j, residual + i * residual_row + j, residual_row,
                     last ? flags : 0, tile);
        }
      }
      p += count;
      if (p >= k) {
        p = 0;
        segment = segment_end;
      }
    } while (segment < segments);
  }
}
