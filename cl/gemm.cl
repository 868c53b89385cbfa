// C = epilogue((accumulate ? C : 0) + sum over segments of A * B), row-major, made for CPU devices (correct
// on all).
//
// One work-group is one work-item: it takes a range of rows and a few panels of COLUMNS columns. A panel of B
// is copied (or transposed) into private memory, then tiles of up to 12 x COLUMNS of C are held in registers
// while p runs. Every element is fma(a, b, sum) over p ascending, segment after segment, starting from what C
// holds or 0: neither the row, nor the size of its tile, nor the blocking of p changes a bit of the result.

#define COLUMNS (2 * VW)
#ifdef REAL_IS_DOUBLE
#define REAL_BYTES 8
#else
#define REAL_BYTES 4
#endif

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

typedef JOIN(REAL, 4) real4;

// Vectors in private memory are of type realv, aligned; those in tensors lie anywhere. PoCL's vstore writes
// pieces of 16 bytes, so a type of lower alignment stands in for it (and for vload) on the CPU.
#ifdef DEVICE_IS_CPU
typedef realv anywhere __attribute__((aligned(REAL_BYTES)));
typedef real4 anywhere4 __attribute__((aligned(REAL_BYTES)));
#define READ(p) (*(global const anywhere*)(p))
#define READ4(p) (*(global const anywhere4*)(p))
#define WRITE(p, value) (*(global anywhere*)(p) = (value))
#else
#define READ(p) vload(0, p)
#define READ4(p) vload4(0, p)
#define WRITE(p, value) vstore(value, 0, p)
#endif

#define LOAD(i) realv x##i = tile[2 * i], y##i = tile[2 * i + 1];
#define STORE(i) tile[2 * i] = x##i, tile[2 * i + 1] = y##i;
#define FMA(i)                             \
  {                                        \
    const realv value = a[i * row_stride]; \
    x##i = fma(value, b0, x##i);           \
    y##i = fma(value, b1, y##i);           \
  }
#define LOAD_HALF(i) realv x##i = tile[2 * i];
#define STORE_HALF(i) tile[2 * i] = x##i;
#define FMA_HALF(i) x##i = fma((realv)(a[i * row_stride]), b0, x##i);

// tile[R][COLUMNS] += A * packed for `count` values of p; the second only for the first VW columns.
#define DEFINE_MULTIPLY(R)                                                                                   \
  static inline void multiply_##R(global const real* a, size_t row_stride, size_t p_stride, uint count,      \
                                  const realv* b, realv* tile) {                                             \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, a += p_stride, b += 2) {                                 \
      const realv b0 = b[0], b1 = b[1];                                                                      \
      ROWS_##R(FMA)                                                                                          \
    }                                                                                                        \
    ROWS_##R(STORE)                                                                                          \
  }                                                                                                          \
  static inline void multiply_half_##R(global const real* a, size_t row_stride, size_t p_stride, uint count, \
                                       const realv* b, realv* tile) {                                        \
    ROWS_##R(LOAD_HALF) for (uint p = 0; p < count; ++p, a += p_stride, b += 2) {                            \
      const realv b0 = b[0];                                                                                 \
      ROWS_##R(FMA_HALF)                                                                                     \
    }                                                                                                        \
    ROWS_##R(STORE_HALF)                                                                                     \
  }

// 12 rows take 24 of the 32 registers of a machine with 64-byte vectors, 6 rows 12 of the 16 of smaller ones.
#if VW * REAL_BYTES == 64
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

// packed[panels][count][COLUMNS] from B stored [p][j]: a row of several panels is read in one go, for short
// pieces of far rows come slowly.
static inline void pack_rows(global const real* b, size_t stride, uint count, uint panels,
                             size_t panel_stride, realv* packed) {
  for (uint p = 0; p < count; ++p, b += stride, packed += 2) {
    global const real* from = b;
    realv* to = packed;
    for (uint w = 0; w < panels; ++w, from += COLUMNS, to += panel_stride) {
      to[0] = READ(from);
      to[1] = READ(from + VW);
    }
  }
}

// The same for the last panel when it is narrower. Its first `readable` rows may be read to COLUMNS; what
// stands past `width` is never used.
static inline void pack_narrow_rows(global const real* b, size_t stride, uint count, uint width,
                                    uint readable, realv* packed) {
  readable = min(readable, count);
  pack_rows(b, stride, readable, 1, 0, packed);
  for (uint p = readable; p < count; ++p)
    for (uint j = 0; j < COLUMNS; ++j) ((real*)packed)[p * COLUMNS + j] = j < width ? b[p * stride + j] : 0;
}

// packed[count][COLUMNS] from B stored [j][p], columns from `width` on repeat the last one. Four values of p
// at a time: each vector takes 4 values of VW / 4 rows; taking the even and the odd elements of pairs of them
// twice brings those of one p together, in the order of the columns.
#define AT(j) READ4(b + min((uint)(j), last) * stride)
#if VW == 16
#define GATHER(i) (realv)(AT(4 * i), AT(4 * i + 1), AT(4 * i + 2), AT(4 * i + 3))
#elif VW == 8
#define GATHER(i) (realv)(AT(2 * i), AT(2 * i + 1))
#else
#define GATHER(i) AT(i)
#endif
static inline void pack_transposed_half(global const real* b, size_t stride, uint count, uint width,
                                        realv* to) {
  const uint whole = count / 4 * 4, last = width - 1;
  for (uint p = 0; p < whole; p += 4, b += 4, to += 8) {
    const realv r0 = GATHER(0), r1 = GATHER(1), r2 = GATHER(2), r3 = GATHER(3);
    const realv even01 = (realv)(r0.even, r1.even), even23 = (realv)(r2.even, r3.even);
    const realv odd01 = (realv)(r0.odd, r1.odd), odd23 = (realv)(r2.odd, r3.odd);
    to[0] = (realv)(even01.even, even23.even);
    to[2] = (realv)(odd01.even, odd23.even);
    to[4] = (realv)(even01.odd, even23.odd);
    to[6] = (realv)(odd01.odd, odd23.odd);
  }
  for (uint p = whole; p < count; ++p, ++b, to += 2)
    for (uint j = 0; j < VW; ++j) ((real*)to)[j] = b[min(j, last) * stride];
}
static inline void pack_transposed(global const real* b, size_t stride, uint count, uint width,
                                   realv* packed) {
  pack_transposed_half(b, stride, count, min(width, (uint)VW), packed);
  if (width > VW) pack_transposed_half(b + VW * stride, stride, count, width - VW, packed + 1);
}

// sums[2 * DIRECT] += a row of A times DIRECT panels of B stored [p][j], read where they are: for few rows,
// packing costs as much as the product.
#define DIRECT 4
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

// A row of a tile is two vectors. When the panel is narrower but holds one, the second vector is the one that
// ends with the panel: it overlaps the first, and nothing outside is touched.
static inline void load_tile(global const real* c, size_t stride, uint rows, uint width, realv* tile) {
  for (uint i = 0; i < rows; ++i, tile += 2, c += stride) {
    if (width == COLUMNS) {
      tile[0] = READ(c);
      tile[1] = READ(c + VW);
    } else {
      for (uint j = 0; j < width; ++j) ((real*)tile)[j] = c[j];
    }
  }
}

// What follows the sum; a NaN stays one through the ReLU.
static inline real finish_one(real value, uint flags, global const real* bias, global const real* residual) {
  if (flags & BIAS) value += *bias;
  if (flags & RESIDUAL) value += *residual;
  return (flags & RELU) && value < 0 ? 0 : value;
}

static inline void store_tile(global real* c, size_t stride, uint rows, uint width, global const real* bias,
                              global const real* residual, size_t residual_stride, uint flags,
                              const realv* tile) {
  for (uint i = 0; i < rows; ++i, tile += 2, c += stride, residual += residual_stride) {
    if (width >= VW) {
      const uint second = width - VW;
      realv x = tile[0], y = tile[1];
      if (second != VW) y = vload(0, (const real*)tile + second);
      if (flags & BIAS) x += READ(bias), y += READ(bias + second);
      if (flags & RESIDUAL) x += READ(residual), y += READ(residual + second);
      if (flags & RELU) x = x < (realv)(0) ? (realv)(0) : x, y = y < (realv)(0) ? (realv)(0) : y;
      WRITE(c, x);
      WRITE(c + second, y);
    } else {
      for (uint j = 0; j < width; ++j)
        c[j] = finish_one(((const real*)tile)[j], flags, bias + j, residual + j);
    }
  }
}

// What a product needs to know, in one argument: PoCL takes its time over each. The same as GemmNumbers on
// the host.
typedef struct {
  uint m, n, k, segments, flags;
  uint a_first, b_first, c_first, bias_first, residual_first;
  uint a_row, a_p, b_p, b_column, c_row,
      residual_row;  // distances: element (i, p) of A is a[i * a_row + p * a_p]
  uint a_batch, b_batch, c_batch;
  uint a_segment[4], b_segment[4];
  uint rows_per_group, panels_per_group, panels_at_once;
} Numbers;

// One of a_row and a_p is 1, and one of b_p and b_column. Groups: x over panels, y over rows, z over the
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
  const bool together = segments * k <= block;

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
            // Reading on to COLUMNS from a row ends inside B while the rows after it hold that many elements.
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
          const uint left = row_end - i;
          rows = left >= MOST_ROWS ? MOST_ROWS : left >= 8 ? 8 : left >= 4 ? 4 : left >= 2 ? 2 : 1;
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
#if MOST_ROWS == 12
            MULTIPLY(12)
            MULTIPLY(8)
#else
            MULTIPLY(6)
#endif
            MULTIPLY(4)
            MULTIPLY(2)
            MULTIPLY(1)
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

// The epilogue alone, for results of another engine. Items over n, m and the batch.
kernel void gemm_finish(global real* c, uint c_first, global const real* bias, uint bias_first,
                        global const real* residual, uint residual_first, uint m, uint n, uint c_stride,
                        uint residual_stride, uint batch_stride, uint flags) {
  const size_t index = get_global_id(0), batch = get_global_id(1);
  if (index >= (size_t)m * n) return;
  const size_t i = index / n, j = index % n;
  global real* at = c + c_first + batch * batch_stride + i * c_stride + j;
  *at = finish_one(*at, flags, bias + bias_first + j, residual + residual_first + i * residual_stride + j);
}

// B in panels of COLUMNS columns, out[panel][p][COLUMNS], for products that come again and again: what the
// kernel above does for every product is done once. Columns past n are anything. Items: panels, pieces of
// BLOCK values of p.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_pack(global const real* b, uint b_first,
                                                                     uint b_p, uint b_column, uint n, uint k,
                                                                     global real* out, uint out_first) {
  realv packed[BLOCK * 2];
  const uint column = get_group_id(0) * COLUMNS, p = get_group_id(1) * BLOCK;
  const uint width = min((uint)COLUMNS, n - column), count = min((uint)BLOCK, k - p);
  global const real* from = b + b_first + p * b_p + column * b_column;
  if (b_column != 1)
    pack_transposed(from, b_column, count, width, packed);
  else
    pack_narrow_rows(from, b_p, count, width, width == COLUMNS ? count : 0, packed);
  global real* to = out + out_first + ((size_t)get_group_id(0) * k + p) * COLUMNS;
  for (uint i = 0; i < 2 * count; ++i) WRITE(to + i * VW, packed[i]);
}

#define FMA_PANEL(i)                       \
  {                                        \
    const realv value = a[i * row_stride]; \
    x##i = fma(value, b0, x##i);           \
    y##i = fma(value, b1, y##i);           \
  }
// tile[R][COLUMNS] += A * a panel.
#define DEFINE_MULTIPLY_PANEL(R)                                                             \
  static inline void multiply_panel_##R(global const real* a, size_t row_stride, uint count, \
                                        global const real* b, realv* tile) {                 \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, ++a, b += COLUMNS) {                     \
      const realv b0 = READ(b), b1 = READ(b + VW);                                           \
      ROWS_##R(FMA_PANEL)                                                                    \
    }                                                                                        \
    ROWS_##R(STORE)                                                                          \
  }
#if MOST_ROWS == 12
DEFINE_MULTIPLY_PANEL(12)
DEFINE_MULTIPLY_PANEL(8)
#else
DEFINE_MULTIPLY_PANEL(6)
#endif
DEFINE_MULTIPLY_PANEL(4)
DEFINE_MULTIPLY_PANEL(2)
DEFINE_MULTIPLY_PANEL(1)

// One row times DIRECT panels: several streams of B at once, for one waits on memory.
static inline void multiply_panels_1(global const real* a, uint count, global const real* b, size_t panel,
                                     realv* sums) {
  realv s0 = sums[0], s1 = sums[1], s2 = sums[2], s3 = sums[3];
  realv s4 = sums[4], s5 = sums[5], s6 = sums[6], s7 = sums[7];
  for (uint p = 0; p < count; ++p, b += COLUMNS) {
    const realv value = a[p];
    global const real *b1 = b + panel, *b2 = b1 + panel, *b3 = b2 + panel;
    s0 = fma(value, READ(b), s0), s1 = fma(value, READ(b + VW), s1);
    s2 = fma(value, READ(b1), s2), s3 = fma(value, READ(b1 + VW), s3);
    s4 = fma(value, READ(b2), s4), s5 = fma(value, READ(b2 + VW), s5);
    s6 = fma(value, READ(b3), s6), s7 = fma(value, READ(b3 + VW), s7);
  }
  sums[0] = s0, sums[1] = s1, sums[2] = s2, sums[3] = s3;
  sums[4] = s4, sums[5] = s5, sums[6] = s6, sums[7] = s7;
}

// The product with a packed B: one problem, one segment, A not transposed, C not accumulated; the same bits
// as without packing. Groups: x over panels (panels_per_group each), y over rows.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_packed(
    global const real* restrict a, global const real* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g) {
  realv tile[MOST_ROWS * 2];
  a += g.a_first + g.a_segment[0];
  b += g.b_first;
  c += g.c_first;
  bias += g.bias_first;
  residual += g.residual_first;
  const uint k = g.k, flags = g.flags, n = g.n;
  const uint row_begin = get_group_id(1) * g.rows_per_group, row_end = min(g.m, row_begin + g.rows_per_group);
  const uint column_begin = get_group_id(0) * g.panels_per_group * COLUMNS;
  const uint column_end = min(n, column_begin + g.panels_per_group * COLUMNS);
  const size_t a_row = g.a_row, c_row = g.c_row, residual_row = g.residual_row, panel = (size_t)k * COLUMNS;
  // Rows 4 KB apart share one set of the first cache, which holds eight lines: no more rows at a time then.
  const uint most = MOST_ROWS > 8 && a_row * REAL_BYTES % 4096 == 0 ? 8 : MOST_ROWS;
  for (uint j = column_begin; j < column_end; j += COLUMNS) {
    global const real* from = b + j / COLUMNS * panel;
    if (row_end - row_begin == 1 && column_end - j >= DIRECT * COLUMNS) {
      realv sums[2 * DIRECT];
      global const real* at = c + row_begin * c_row + j;
      for (uint w = 0; w < 2 * DIRECT; ++w) sums[w] = flags & ACCUMULATE ? READ(at + w * VW) : (realv)(0);
      multiply_panels_1(a + row_begin * a_row, k, from, panel, sums);
      for (uint w = 0; w < DIRECT; ++w, j += COLUMNS)
        store_tile(c + row_begin * c_row + j, 0, 1, COLUMNS, bias + j,
                   residual + row_begin * residual_row + j, 0, flags, sums + 2 * w);
      j -= COLUMNS;
      continue;
    }
    const uint width = min((uint)COLUMNS, column_end - j);
    for (uint i = row_begin, rows; i < row_end; i += rows) {
      const uint left = row_end - i;
      rows = left >= most ? most : left >= 8 ? 8 : left >= 4 ? 4 : left >= 2 ? 2 : 1;
      global const real* rows_of_a = a + i * a_row;
      if (flags & ACCUMULATE)
        load_tile(c + i * c_row + j, c_row, rows, width, tile);
      else
        for (uint e = 0; e < 2 * rows; ++e) tile[e] = 0;
#define MULTIPLY_PANEL(R) \
  if (rows == R) multiply_panel_##R(rows_of_a, a_row, k, from, tile);
#if MOST_ROWS == 12
      MULTIPLY_PANEL(12)
      MULTIPLY_PANEL(8)
#else
      MULTIPLY_PANEL(6)
#endif
      MULTIPLY_PANEL(4)
      MULTIPLY_PANEL(2)
      MULTIPLY_PANEL(1)
      store_tile(c + i * c_row + j, c_row, rows, width, bias + j, residual + i * residual_row + j,
                 residual_row, flags, tile);
    }
  }
}

// out[j][i] = x[i][j]. Items: squares of VW rows and VW columns of x, a row of squares after another.
kernel void gemm_turn(global const real* x, uint x_first, uint x_row, uint rows, uint columns,
                      global real* out, uint out_first, uint out_row) {
  const uint across = (columns + VW - 1) / VW, item = get_global_id(0);
  const uint i = item / across * VW, j = item % across * VW;
  if (i >= rows) return;
  real square[VW * VW], line[VW];
  const uint high = min(rows - i, (uint)VW), wide = min(columns - j, (uint)VW);
  for (uint r = 0; r < high; ++r)
    vstore(load_some(x + x_first + (i + r) * x_row + j, columns - j), r, square);
  for (uint c = 0; c < wide; ++c) {
    for (uint r = 0; r < high; ++r) line[r] = square[r * VW + c];
    store_some(vload(0, line), out + out_first + (j + c) * out_row + i, rows - i);
  }
}

// The weights [4k, in] of an LSTM layer for gemm_lstm_cell: panel 2u holds, for each p, gates i and f of
// units u * VW .., panel 2u + 1 gates g and o. Items: panels, pieces of BLOCK values of p.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_pack_gates(global const real* w, uint w_first,
                                                                           uint in, uint k, global real* out,
                                                                           uint out_first) {
  realv packed[BLOCK * 2];
  const uint unit = get_group_id(0) / 2 * VW, gate = get_group_id(0) % 2 * 2, p = get_group_id(1) * BLOCK;
  const uint width = min((uint)VW, k - unit), count = min((uint)BLOCK, in - p);
  for (uint h = 0; h < 2; ++h)
    pack_transposed_half(w + w_first + ((size_t)(gate + h) * k + unit) * in + p, in, count, width,
                         packed + h);
  global real* to = out + out_first + ((size_t)get_group_id(0) * in + p) * COLUMNS;
  for (uint i = 0; i < 2 * count; ++i) WRITE(to + i * VW, packed[i]);
}

#define GATES_ZERO(r) realv i##r = 0, f##r = 0, g##r = 0, o##r = 0;
#define GATES_FMA(r)                       \
  {                                        \
    const realv value = a[r * row_stride]; \
    i##r = fma(value, w0, i##r);           \
    f##r = fma(value, w1, f##r);           \
    g##r = fma(value, w2, g##r);           \
    o##r = fma(value, w3, o##r);           \
  }
#define GATES_STORE(r) z[4 * r] = i##r, z[4 * r + 1] = f##r, z[4 * r + 2] = g##r, z[4 * r + 3] = o##r;
// z[R][4] = rows of A times the two panels of VW units.
#define DEFINE_MULTIPLY_GATES(R)                                                                    \
  static inline void multiply_gates_##R(global const real* a, size_t row_stride, uint count,        \
                                        global const real* w, size_t panel, realv* z) {             \
    ROWS_##R(GATES_ZERO) for (uint p = 0; p < count; ++p, ++a, w += COLUMNS) {                      \
      const realv w0 = READ(w), w1 = READ(w + VW), w2 = READ(w + panel), w3 = READ(w + panel + VW); \
      ROWS_##R(GATES_FMA)                                                                           \
    }                                                                                               \
    ROWS_##R(GATES_STORE)                                                                           \
  }
#if VW * REAL_BYTES == 64
#define MOST_GATE_ROWS 6
DEFINE_MULTIPLY_GATES(6)
#else
#define MOST_GATE_ROWS 2
#endif
DEFINE_MULTIPLY_GATES(2)
DEFINE_MULTIPLY_GATES(1)

// One step of an LSTM layer, product and cell: gates = A [batch, in] W^T + x, PyTorch's order i, f, g, o;
// then c, h as rollout_cell computes them. x_row is 0 where every row sees the same (a bias). Activated gates
// are written where `keep` is set. Groups: x over VW units, y over rows.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_lstm_cell(
    global const real* a, uint a_first, uint a_row, uint in, global const real* w, uint w_first,
    global const real* x, uint x_first, uint x_row, global const real* c_before, uint c_before_first,
    global real* h, uint h_first, uint h_row, global real* c, uint c_first, global real* gates,
    uint gates_first, uint keep, uint batch, uint k, uint rows_per_group) {
  realv z[MOST_GATE_ROWS * 4];
  const uint unit = get_group_id(0) * VW, left = k - unit;
  const uint row_begin = get_group_id(1) * rows_per_group, row_end = min(batch, row_begin + rows_per_group);
  const size_t panel = (size_t)in * COLUMNS;
  global const real* panels = w + w_first + get_group_id(0) * 2 * panel;
  a += a_first;
  for (uint r = row_begin, rows; r < row_end; r += rows) {
    const uint rest = row_end - r;
    rows = rest >= MOST_GATE_ROWS ? MOST_GATE_ROWS : rest >= 2 ? 2 : 1;
    global const real* from = a + (size_t)r * a_row;
#if MOST_GATE_ROWS == 6
    if (rows == 6) multiply_gates_6(from, a_row, in, panels, panel, z);
#endif
    if (rows == 2) multiply_gates_2(from, a_row, in, panels, panel, z);
    if (rows == 1) multiply_gates_1(from, a_row, in, panels, panel, z);
    for (uint e = 0; e < rows; ++e) {
      const uint at = (r + e) * k + unit;
      global const real* extra = x + x_first + (size_t)(r + e) * x_row + unit;
      const realv i = sigmoid_v(z[4 * e] + load_some(extra, left));
      const realv f = sigmoid_v(z[4 * e + 1] + load_some(extra + k, left));
      const realv g = tanh(z[4 * e + 2] + load_some(extra + 2 * k, left));
      const realv o = sigmoid_v(z[4 * e + 3] + load_some(extra + 3 * k, left));
      const realv state = f * load_some(c_before + c_before_first + at, left) + i * g;
      store_some(state, c + c_first + at, left);
      store_some(o * tanh(state), h + h_first + (size_t)(r + e) * h_row + unit, left);
      if (!keep) continue;
      global real* row = gates + gates_first + (size_t)(r + e) * 4 * k + unit;
      store_some(i, row, left);
      store_some(f, row + k, left);
      store_some(g, row + 2 * k, left);
      store_some(o, row + 3 * k, left);
    }
  }
}
