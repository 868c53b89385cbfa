// C = epilogue((accumulate ? C : 0) + sum over segments of A * B), row-major, made for CPU devices (correct on all).
//
// One work-group is one work-item: it takes a range of rows and a few panels of COLUMNS columns. A panel of B is copied
// (or transposed) into private memory, then tiles of up to 12 x COLUMNS of C are held in registers while p runs.
// Every element is fma(a, b, sum) over p ascending, segment after segment, starting from what C holds or 0: neither
// the row, nor the size of its tile, nor the blocking of p changes a bit of the result.

#define COLUMNS (2 * VW)

// Values of p that are packed at once: 96 KB for 16 floats a vector, which stays in the second cache.
#ifdef DEVICE_IS_CPU
#define BLOCK 768
#else
#define BLOCK 32
#endif

#define ACCUMULATE 1
#define BIAS 2
#define RESIDUAL 4
#define RELU 8

#define ROWS_1(F) F(0)
#define ROWS_2(F) ROWS_1(F) F(1)
#define ROWS_4(F) ROWS_2(F) F(2) F(3)
#define ROWS_6(F) ROWS_4(F) F(4) F(5)
#define ROWS_8(F) ROWS_6(F) F(6) F(7)
#define ROWS_12(F) ROWS_8(F) F(8) F(9) F(10) F(11)

#define LOAD(i) realv x##i = vload(2 * i, tile), y##i = vload(2 * i + 1, tile);
#define STORE(i) vstore(x##i, 2 * i, tile), vstore(y##i, 2 * i + 1, tile);
#define FMA(i)                             \
  {                                        \
    const realv value = a[i * row_stride]; \
    x##i = fma(value, b0, x##i);           \
    y##i = fma(value, b1, y##i);           \
  }

// tile[R][COLUMNS] += A * packed for `count` values of p.
#define DEFINE_MULTIPLY(R)                                                                                            \
  inline void multiply_##R(global const real* a, size_t row_stride, size_t p_stride, uint count, const real* b,      \
                           real* tile) {                                                                              \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, a += p_stride, b += COLUMNS) {                                    \
      const realv b0 = vload(0, b), b1 = vload(1, b);                                                                 \
      ROWS_##R(FMA)                                                                                                   \
    }                                                                                                                 \
    ROWS_##R(STORE)                                                                                                   \
  }

// 12 rows take 24 of the 32 registers of a machine with 64-byte vectors, 6 rows 12 of the 16 of smaller ones.
#if VW == 16 || (VW == 8 && defined(REAL_IS_DOUBLE))
#define MOST_ROWS 12
DEFINE_MULTIPLY(12)
DEFINE_MULTIPLY(8)
#else
#define MOST_ROWS 6
DEFINE_MULTIPLY(6)
#endif
DEFINE_MULTIPLY(4)
DEFINE_MULTIPLY(2)
DEFINE_MULTIPLY(1)

// packed[count][COLUMNS] from B stored [p][j]; columns from `width` on become 0.
inline void pack_rows(global const real* b, size_t stride, uint count, uint width, real* packed) {
  if (width == COLUMNS) {
    for (uint p = 0; p < count; ++p, b += stride, packed += COLUMNS) {
      vstore(vload(0, b), 0, packed);
      vstore(vload(1, b), 1, packed);
    }
  } else {
    for (uint p = 0; p < count; ++p, b += stride, packed += COLUMNS)
      for (uint j = 0; j < COLUMNS; ++j) packed[j] = j < width ? b[j] : 0;
  }
}

// packed[count][COLUMNS] from B stored [j][p]: blocks of VW x VW are transposed in registers, by interleaving the first
// half of the rows with the second log2(VW) times. Columns from `width` on repeat the last one.
inline void pack_transposed(global const real* b, size_t stride, uint count, uint width, real* packed) {
  const uint whole = count / VW * VW;
  for (uint half_panel = 0; half_panel < COLUMNS; half_panel += VW) {
    for (uint p = 0; p < whole; p += VW) {
      realv r[VW];
#pragma unroll
      for (uint j = 0; j < VW; ++j) r[j] = vload(0, b + min(half_panel + j, width - 1) * stride + p);
#pragma unroll
      for (uint round = 1; round < VW; round *= 2) {
        realv t[VW];
#pragma unroll
        for (uint j = 0; j < VW / 2; ++j) {
          t[2 * j].even = r[j].lo;
          t[2 * j].odd = r[j + VW / 2].lo;
          t[2 * j + 1].even = r[j].hi;
          t[2 * j + 1].odd = r[j + VW / 2].hi;
        }
#pragma unroll
        for (uint j = 0; j < VW; ++j) r[j] = t[j];
      }
#pragma unroll
      for (uint j = 0; j < VW; ++j) vstore(r[j], 0, packed + (p + j) * COLUMNS + half_panel);
    }
  }
  for (uint p = whole; p < count; ++p)
    for (uint j = 0; j < COLUMNS; ++j) packed[p * COLUMNS + j] = b[min(j, width - 1) * stride + p];
}

// The start of a tile's sums: 0, or what C holds.
inline void load_tile(global const real* c, size_t stride, uint rows, uint width, bool zero, real* tile) {
  for (uint i = 0; i < rows; ++i, tile += COLUMNS, c += stride) {
    if (zero) {
      vstore((realv)(0), 0, tile);
      vstore((realv)(0), 1, tile);
    } else if (width == COLUMNS) {
      vstore(vload(0, c), 0, tile);
      vstore(vload(1, c), 1, tile);
    } else {
      for (uint j = 0; j < COLUMNS; ++j) tile[j] = j < width ? c[j] : 0;
    }
  }
}

inline void store_tile(global real* c, size_t stride, uint rows, uint width, const real* tile) {
  for (uint i = 0; i < rows; ++i, tile += COLUMNS, c += stride) {
    if (width == COLUMNS) {
      vstore(vload(0, tile), 0, c);
      vstore(vload(1, tile), 1, c);
    } else {
      for (uint j = 0; j < width; ++j) c[j] = tile[j];
    }
  }
}

// What follows the sum; a NaN stays one through the ReLU.
inline real finish(real value, uint flags, real bias, real residual) {
  if (flags & BIAS) value += bias;
  if (flags & RESIDUAL) value += residual;
  return (flags & RELU) && value < 0 ? 0 : value;
}

inline void finish_tile(global const real* bias, global const real* residual, size_t residual_stride, uint flags,
                        uint rows, uint width, real* tile) {
  for (uint i = 0; i < rows; ++i, tile += COLUMNS, residual += residual_stride) {
    if (width == COLUMNS) {
      for (uint h = 0; h < 2; ++h) {
        realv value = vload(h, tile);
        if (flags & BIAS) value += vload(h, bias);
        if (flags & RESIDUAL) value += vload(h, residual);
        if (flags & RELU) value = value < (realv)(0) ? (realv)(0) : value;
        vstore(value, h, tile);
      }
    } else {
      for (uint j = 0; j < width; ++j)
        tile[j] = finish(tile[j], flags, flags & BIAS ? bias[j] : 0, flags & RESIDUAL ? residual[j] : 0);
    }
  }
}

// Element (i, p) of A is a[i * strides.x + p * strides.y]; element (p, j) of B is b[j * strides.z + p * strides.w], where
// one of the two is 1. Groups: x over panels, y over rows, z over the batch.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm(
    global const real* restrict a, uint a_first, global const real* restrict b, uint b_first, global real* restrict c,
    uint c_first, global const real* restrict bias, uint bias_first, global const real* restrict residual,
    uint residual_first, uint m, uint n, uint k, uint4 strides, uint c_stride, uint residual_stride,
    uint segments, uint4 a_offsets, uint4 b_offsets, uint4 batch_strides, uint flags, uint rows_per_group,
    uint panels_per_group, uint block) {
  real packed[BLOCK * COLUMNS] __attribute__((aligned(64)));
  real tile[MOST_ROWS * COLUMNS] __attribute__((aligned(64)));
  const uint a_offset[4] = {a_offsets.x, a_offsets.y, a_offsets.z, a_offsets.w};
  const uint b_offset[4] = {b_offsets.x, b_offsets.y, b_offsets.z, b_offsets.w};
  const size_t batch = get_group_id(2);
  a += a_first + batch * batch_strides.x;
  b += b_first + batch * batch_strides.y;
  c += c_first + batch * batch_strides.z;
  bias += bias_first;
  residual += residual_first;
  const uint row_begin = get_group_id(1) * rows_per_group, row_end = min(m, row_begin + rows_per_group);
  const uint column_begin = get_group_id(0) * panels_per_group * COLUMNS;
  const uint column_end = min(n, column_begin + panels_per_group * COLUMNS);
  const size_t a_row = strides.x, a_p = strides.y, b_column = strides.z, b_p = strides.w, c_row = c_stride;
  block = min(block, (uint)BLOCK);
  const bool together = segments * k <= block;

  for (uint j = column_begin; j < column_end; j += COLUMNS) {
    const uint width = min((uint)COLUMNS, column_end - j);
    uint segment = 0, p = 0;  // where the next block starts
    do {
      const uint count = together ? k : min(block, k - p);
      const uint segment_end = together ? segments : segment + 1;
      const bool first = segment == 0 && p == 0, last = segment_end == segments && p + count == k;
      for (uint s = segment; s < segment_end; ++s) {
        global const real* from = b + b_offset[s] + p * b_p + j * b_column;
        real* to = packed + (s - segment) * count * COLUMNS;
        if (b_column == 1)
          pack_rows(from, b_p, count, width, to);
        else
          pack_transposed(from, b_column, count, width, to);
      }
      for (uint i = row_begin, rows; i < row_end; i += rows) {
        const uint left = row_end - i;
        rows = left >= MOST_ROWS ? MOST_ROWS : left >= 8 ? 8 : left >= 4 ? 4 : left >= 2 ? 2 : 1;
        load_tile(c + i * c_row + j, c_row, rows, width, first && !(flags & ACCUMULATE), tile);
        for (uint s = segment; s < segment_end; ++s) {
          global const real* rows_of_a = a + a_offset[s] + i * a_row + p * a_p;
          const real* panel = packed + (s - segment) * count * COLUMNS;
          switch (rows) {
#if MOST_ROWS == 12
            case 12:
              multiply_12(rows_of_a, a_row, a_p, count, panel, tile);
              break;
            case 8:
              multiply_8(rows_of_a, a_row, a_p, count, panel, tile);
              break;
#else
            case 6:
              multiply_6(rows_of_a, a_row, a_p, count, panel, tile);
              break;
#endif
            case 4:
              multiply_4(rows_of_a, a_row, a_p, count, panel, tile);
              break;
            case 2:
              multiply_2(rows_of_a, a_row, a_p, count, panel, tile);
              break;
            default:
              multiply_1(rows_of_a, a_row, a_p, count, panel, tile);
          }
        }
        if (last && (flags & (BIAS | RESIDUAL | RELU)))
          finish_tile(bias + j, residual + (size_t)i * residual_stride + j, residual_stride, flags, rows, width, tile);
        store_tile(c + i * c_row + j, c_row, rows, width, tile);
      }
      p += count;
      if (p >= k) {
        p = 0;
        segment = segment_end;
      }
    } while (segment < segments);
  }
}

// The epilogue alone, for results of another engine. Items over n, m and the batch.
kernel void gemm_finish(global real* c, uint c_first, global const real* bias, uint bias_first,
                        global const real* residual, uint residual_first, uint m, uint n, uint c_stride,
                        uint residual_stride, uint batch_stride, uint flags) {
  const size_t index = get_global_id(0), batch = get_global_id(1);
  if (index >= (size_t)m * n) return;
  const size_t i = index / n, j = index % n;
  global real* at = c + c_first + batch * batch_stride + i * c_stride + j;
  *at = finish(*at, flags, flags & BIAS ? bias[bias_first + j] : 0,
               flags & RESIDUAL ? residual[residual_first + i * residual_stride + j] : 0);
}
