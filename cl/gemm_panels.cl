// Products with the panels of a packed B, shared by gemm_packed.cl and winograd.cl.
#include "gemm_tiles.cl"

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
    global const real* next = a + R * row_stride;                                            \
    ROWS_##R(LOAD) for (uint p = 0; p < count; ++p, ++a, b += COLUMNS, next += R) {          \
      PREFETCH(next);                                                                        \
      PREFETCH(b + ROWS_AHEAD * COLUMNS);                                                    \
      PREFETCH(b + ROWS_AHEAD * COLUMNS + VW);                                               \
      const realv b0 = READ(b), b1 = READ(b + VW);                                           \
      ROWS_##R(FMA_PANEL)                                                                    \
    }                                                                                        \
    ROWS_##R(STORE)                                                                          \
  }
FOR_TILE_ROWS(DEFINE_MULTIPLY_PANEL)

#define RECTIFY 16

static inline void rectify(global const real* c, size_t stride, uint rows, uint width, global real* out) {
  for (uint i = 0; i < rows; ++i, c += stride, out += stride)
    for (uint j = 0; j < width; j += VW) {
      const realv x = load_some(c + j, width - j);
      store_some(x < (realv)(0) ? (realv)(0) : x, out + j, width - j);
    }
}
