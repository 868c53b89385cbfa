// Products with the panels of a packed B, shared by gemm_packed.cl and winograd.cl.
#include "gemm_tiles.cl"

// A row of a panel, COLUMNS weights: two vectors or, of bfloat16 weights, one of 32-bit lanes, in which the
// first vector is the low half and the second one the high half.
#ifdef WEIGHTS_ARE_BF16
typedef uint weight;
#define WEIGHT_ROW VW
#define READ_WEIGHTS(p, first, second)    \
  const bitsv pair_##first = vload(0, p); \
  const realv first = from_bf16(pair_##first << 16), second = from_bf16(pair_##first & (uint)0xffff0000u)
#define WRITE_WEIGHTS(p, first, second) vstore(to_bf16(first) >> 16 | to_bf16(second), 0, p)
#define PREFETCH_WEIGHTS(p) PREFETCH((p) + ROWS_AHEAD * WEIGHT_ROW)
#else
typedef real weight;
#define WEIGHT_ROW COLUMNS
#define READ_WEIGHTS(p, first, second) const realv first = READ(p), second = READ((p) + VW)
#define WRITE_WEIGHTS(p, first, second) \
  WRITE(p, first);                      \
  WRITE((p) + VW, second)
#define PREFETCH_WEIGHTS(p)                \
  PREFETCH((p) + ROWS_AHEAD * WEIGHT_ROW); \
  PREFETCH((p) + ROWS_AHEAD * WEIGHT_ROW + VW)
#endif

#define FMA_PANEL(i)                       \
  {                                        \
    const realv value = a[i * row_stride]; \
    x##i = fma(value, b0, x##i);           \
    y##i = fma(value, b1, y##i);           \
  }
// tile[R][COLUMNS] += A * a panel.
#define DEFINE_MULTIPLY_PANEL(R)                                                             \
  static inline void multiply_panel_##R(global const real* a, size_t row_stride, uint count, \
                                        global const weight* b, realv* tile) {               \
    global const real* next = a + R * row_stride;                                            \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, ++a, b += WEIGHT_ROW, next += R) {       \
      PREFETCH(next);                                                                        \
      PREFETCH_WEIGHTS(b);                                                                   \
      READ_WEIGHTS(b, b0, b1);                                                               \
      ROWS_##R(FMA_PANEL)                                                                    \
    }                                                                                        \
    ROWS_##R(STORE)                                                                          \
  }
FOR_TILE_ROWS(DEFINE_MULTIPLY_PANEL)

static inline void rectify(global const real* c, size_t stride, uint rows, uint width, global real* out) {
  for (uint i = 0; i < rows; ++i, c += stride, out += stride)
    for (uint j = 0; j < width; j += VW) {
      const realv x = load_some(c + j, width - j);
      store_some(x < (realv)(0) ? (realv)(0) : x, out + j, width - j);
    }
}
