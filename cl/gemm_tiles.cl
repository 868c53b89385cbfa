// Shared by gemm.cl and gemm_packed.cl: unaligned vectors, packing of B, and register tiles of C.
#include "gemm_epilogue.cl"

#define COLUMNS (2 * VW)
#ifdef REAL_IS_DOUBLE
#define REAL_BYTES 8
#else
#define REAL_BYTES 4
#endif

// Values of p packed at once: 96 KB with 16 floats per vector, which fits in the L2 cache.
#ifdef FOR_CPU
#define BLOCK 768
#else
#define BLOCK 32
#endif

#define ROWS_1(F) F(0)
#define ROWS_2(F) ROWS_1(F) F(1)
#define ROWS_4(F) ROWS_2(F) F(2) F(3)
#define ROWS_6(F) ROWS_4(F) F(4) F(5)
#define ROWS_8(F) ROWS_6(F) F(6) F(7)
#define ROWS_12(F) ROWS_8(F) F(8) F(9) F(10) F(11)

typedef JOIN(REAL, 4) real4;

// Vectors in private memory are aligned (realv), those in tensors are not. PoCL's vstore splits into pieces
// of 16 bytes, so on the CPU a vector type of lower alignment replaces vload and vstore.
#ifdef FOR_CPU
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

// Rows that lie a few kilobytes apart are not fetched ahead by the processor itself.
#ifdef CAN_PREFETCH
#define PREFETCH(p) __builtin_prefetch((const void*)(size_t)(p))
#else
#define PREFETCH(p)
#endif
#define ROWS_AHEAD 8

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

// tile[R][COLUMNS] += A * packed for `count` values of p; the _half version only for the first VW columns.
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

// 12 rows take 24 of the 32 registers with 64-byte vectors, 6 rows take 12 of the 16 with shorter ones.
#if VW * REAL_BYTES == 64
#define MOST_ROWS 12
#define FOR_TILE_ROWS(F) F(12) F(8) F(4) F(2) F(1)
#else
#define MOST_ROWS 6
#define FOR_TILE_ROWS(F) F(6) F(4) F(2) F(1)
#endif
FOR_TILE_ROWS(DEFINE_MULTIPLY)

// Rows of the next tile, at most `most`, if `left` rows are left.
static inline uint tile_rows(uint left, uint most) {
  return left >= most ? most : left >= 8 ? 8 : left >= 4 ? 4 : left >= 2 ? 2 : 1;
}

// packed[panels][count][COLUMNS] from B stored [p][j]. A row is read across all panels at once, because
// reading short pieces of distant rows is slow.
static inline void pack_rows(global const real* b, size_t stride, uint count, uint panels,
                             size_t panel_stride, realv* packed) {
  for (uint p = 0; p < count; ++p, b += stride, packed += 2) {
    global const real* from = b;
    realv* to = packed;
    for (uint w = 0; w < panels; ++w, from += COLUMNS, to += panel_stride) {
      PREFETCH(from + ROWS_AHEAD * stride);
      PREFETCH(from + ROWS_AHEAD * stride + VW);
      to[0] = READ(from);
      to[1] = READ(from + VW);
    }
  }
}

// The same for a last panel of fewer columns. Its first `readable` rows may be read up to COLUMNS; columns
// past `width` are never used.
static inline void pack_narrow_rows(global const real* b, size_t stride, uint count, uint width,
                                    uint readable, realv* packed) {
  readable = min(readable, count);
  pack_rows(b, stride, readable, 1, 0, packed);
  for (uint p = readable; p < count; ++p)
    for (uint j = 0; j < COLUMNS; ++j) ((real*)packed)[p * COLUMNS + j] = j < width ? b[p * stride + j] : 0;
}

// packed[count][COLUMNS] from B stored [j][p]; columns past `width` repeat the last one. Four values of p at
// a time: each vector loads 4 values of VW / 4 rows, and two rounds of separating the even and odd elements
// of pairs of vectors collect the values of each p in column order.
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

// Panels multiplied by one row at a time.
#define DIRECT 4

// A row of a tile is two vectors. In a narrower panel of at least VW columns, store_tile places the second
// vector so that it ends with the panel: it overlaps the first, and nothing outside is touched.
static inline void load_tile(global const real* c, size_t stride, uint rows, uint width, realv* tile) {
  for (uint i = 0; i < rows; ++i, tile += 2, c += stride) {
    if (width == COLUMNS) {
      tile[0] = READ(c);
      tile[1] = READ(c + VW);
    } else if (width >= VW) {  // the second vector ends with the panel; the first overwrites what they share
      vstore(READ(c + width - VW), 0, (real*)tile + width - VW);
      tile[0] = READ(c);
    } else {
      for (uint j = 0; j < width; ++j) ((real*)tile)[j] = c[j];
    }
  }
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
