// C = epilogue((accumulate ? C : 0) + sum over segments of A * B), row-major, for wide devices: the items of
// a work-group compute a tile of C from tiles of A and B in local memory.
//
// A sum has one order in both kernels: p in blocks of DEPTH, each block summed from 0 by fma(a, b, sum) with
// p ascending, the blocks added one after the other, segment after segment, to C or 0. So neither the kernel,
// the size of the group, m, n nor the batch changes a bit of an element.
#include "gemm_epilogue.cl"

#define DEPTH 16

// The items of a group: ACROSS times DOWN.
#if GROUP == 64
#define ACROSS 8
#define DOWN 8
#elif GROUP == 32
#define ACROSS 8
#define DOWN 4
#elif GROUP == 16
#define ACROSS 4
#define DOWN 4
#elif GROUP == 8
#define ACROSS 4
#define DOWN 2
#elif GROUP == 4
#define ACROSS 2
#define DOWN 2
#elif GROUP == 2
#define ACROSS 2
#define DOWN 1
#else
#define ACROSS 1
#define DOWN 1
#endif

// Fills tile[p * (width + 1) + i] for p < depth and i < width with the elements at from[i * stride + p *
// p_stride], 0 for p >= count or i >= used. Neighbouring items read neighbouring elements: one of the strides
// is 1. A row of the tile is one longer than its width, so that items that write a column do not meet in one
// bank.
static inline void load_block(global const real* from, size_t stride, size_t p_stride, uint used, uint count,
                              uint width, uint depth, local real* tile) {
  for (uint e = get_local_id(0); e < depth * width; e += GROUP) {
    const uint p = p_stride == 1 ? e % depth : e / width, i = p_stride == 1 ? e / depth : e % width;
    tile[p * (width + 1) + i] = p < count && i < used ? from[i * stride + p * p_stride] : (real)0;
  }
}

// Writes element (i, j) of C, and of `rectified` with RECTIFY.
static inline void finish_element(global real* c, global const real* bias, global const real* residual,
                                  global real* rectified, size_t c_row, size_t residual_row, uint flags,
                                  size_t i, size_t j, real sum) {
  const real value = finish_one(sum, flags, bias + j, residual + i * residual_row + j);
  c[i * c_row + j] = value;
  if (flags & RECTIFY) rectified[i * c_row + j] = value < 0 ? 0 : value;
}

// The operands of a group's problem of the batch. The offsets of the segments are copied, because Mesa
// crashes on an argument with an index.
#define START_PRODUCT                                                                         \
  const size_t batch = get_group_id(2);                                                       \
  a += g.a_first + batch * g.a_batch;                                                         \
  b += g.b_first + batch * g.b_batch;                                                         \
  c += g.c_first + batch * g.c_batch;                                                         \
  bias += g.bias_first;                                                                       \
  residual += g.residual_first;                                                               \
  rectified += rectified_first;                                                               \
  const uint item = get_local_id(0), k = g.k;                                                 \
  const size_t c_row = g.c_row;                                                               \
  const uint a_segment[4] = {g.a_segment[0], g.a_segment[1], g.a_segment[2], g.a_segment[3]}; \
  const uint b_segment[4] = {g.b_segment[0], g.b_segment[1], g.b_segment[2], g.b_segment[3]};

// Rows and columns of C of an item, ACROSS and DOWN apart.
#define SIDE 4
#define TILE_ROWS (SIDE * DOWN)
#define TILE_COLUMNS (SIDE * ACROSS)

// Many rows. Work-groups: x over tiles of TILE_COLUMNS columns, y over tiles of TILE_ROWS rows, z over the
// batch.
__attribute__((reqd_work_group_size(GROUP, 1, 1))) kernel void gemm_tile(
    global const real* restrict a, global const real* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g,
    global real* restrict rectified, uint rectified_first) {
  local real rows[DEPTH * (TILE_ROWS + 1)], columns[DEPTH * (TILE_COLUMNS + 1)];
  START_PRODUCT
  const uint first_row = get_group_id(1) * TILE_ROWS, first_column = get_group_id(0) * TILE_COLUMNS;
  const uint x = item % ACROSS, y = item / ACROSS;
  real sums[SIDE][SIDE];
  for (uint r = 0; r < SIDE; ++r)
    for (uint q = 0; q < SIDE; ++q) {
      const uint i = first_row + y + r * DOWN, j = first_column + x + q * ACROSS;
      sums[r][q] = g.flags & ACCUMULATE && i < g.m && j < g.n ? c[i * c_row + j] : (real)0;
    }
  for (uint s = 0; s < g.segments; ++s)
    for (uint p = 0; p < k; p += DEPTH) {
      load_block(a + a_segment[s] + (size_t)first_row * g.a_row + (size_t)p * g.a_p, g.a_row, g.a_p,
                 g.m - first_row, k - p, TILE_ROWS, DEPTH, rows);
      load_block(b + b_segment[s] + (size_t)first_column * g.b_column + (size_t)p * g.b_p, g.b_column, g.b_p,
                 g.n - first_column, k - p, TILE_COLUMNS, DEPTH, columns);
      barrier(CLK_LOCAL_MEM_FENCE);
      real block[SIDE][SIDE];
#pragma unroll
      for (uint r = 0; r < SIDE; ++r)
#pragma unroll
        for (uint q = 0; q < SIDE; ++q) block[r][q] = 0;
#pragma unroll
      for (uint d = 0; d < DEPTH; ++d) {
        real u[SIDE], v[SIDE];
#pragma unroll
        for (uint r = 0; r < SIDE; ++r) {
          u[r] = rows[d * (TILE_ROWS + 1) + y + r * DOWN];
          v[r] = columns[d * (TILE_COLUMNS + 1) + x + r * ACROSS];
        }
#pragma unroll
        for (uint r = 0; r < SIDE; ++r)
#pragma unroll
          for (uint q = 0; q < SIDE; ++q) block[r][q] = fma(u[r], v[q], block[r][q]);
      }
#pragma unroll
      for (uint r = 0; r < SIDE; ++r)
#pragma unroll
        for (uint q = 0; q < SIDE; ++q) sums[r][q] += block[r][q];
      barrier(CLK_LOCAL_MEM_FENCE);  // before the tiles are filled again
    }
  for (uint r = 0; r < SIDE; ++r)
    for (uint q = 0; q < SIDE; ++q) {
      const uint i = first_row + y + r * DOWN, j = first_column + x + q * ACROSS;
      if (i < g.m && j < g.n)
        finish_element(c, bias, residual, rectified, c_row, g.residual_row, g.flags, i, j, sums[r][q]);
    }
}

// Rows of C of a group.
#define FEW 4
// Values of p that a group reads at once: a block for each item of a column.
#define STRETCH (DOWN * DEPTH)

// Few rows, or few tiles: the items of a column share its sum, each takes every DOWN-th block of p.
// Work-groups: x over ACROSS columns, y over FEW rows, z over the batch.
__attribute__((reqd_work_group_size(GROUP, 1, 1))) kernel void gemm_few(
    global const real* restrict a, global const real* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g,
    global real* restrict rectified, uint rectified_first) {
  local real rows[STRETCH * (FEW + 1)], columns[STRETCH * (ACROSS + 1)];
  local real blocks[DOWN][FEW * ACROSS], sums[FEW * ACROSS];
  START_PRODUCT
  const uint first_row = get_group_id(1) * FEW, first_column = get_group_id(0) * ACROSS;
  const uint x = item % ACROSS, y = item / ACROSS;
  // Element e of the group's is (e / ACROSS, e % ACROSS); item e % GROUP adds up its blocks.
  for (uint e = item; e < FEW * ACROSS; e += GROUP) {
    const uint i = first_row + e / ACROSS, j = first_column + e % ACROSS;
    sums[e] = g.flags & ACCUMULATE && i < g.m && j < g.n ? c[i * c_row + j] : (real)0;
  }
  for (uint s = 0; s < g.segments; ++s)
    for (uint p = 0; p < k; p += STRETCH) {
      load_block(a + a_segment[s] + (size_t)first_row * g.a_row + (size_t)p * g.a_p, g.a_row, g.a_p,
                 g.m - first_row, k - p, FEW, STRETCH, rows);
      load_block(b + b_segment[s] + (size_t)first_column * g.b_column + (size_t)p * g.b_p, g.b_column, g.b_p,
                 g.n - first_column, k - p, ACROSS, STRETCH, columns);
      barrier(CLK_LOCAL_MEM_FENCE);
      real block[FEW];
#pragma unroll
      for (uint r = 0; r < FEW; ++r) block[r] = 0;
#pragma unroll
      for (uint d = 0; d < DEPTH; ++d) {
        const real v = columns[(y * DEPTH + d) * (ACROSS + 1) + x];
#pragma unroll
        for (uint r = 0; r < FEW; ++r) block[r] = fma(rows[(y * DEPTH + d) * (FEW + 1) + r], v, block[r]);
      }
      for (uint r = 0; r < FEW; ++r) blocks[y][r * ACROSS + x] = block[r];
      barrier(CLK_LOCAL_MEM_FENCE);
      const uint filled = min((uint)DOWN, (k - p + DEPTH - 1) / DEPTH);
      for (uint e = item; e < FEW * ACROSS; e += GROUP)
        for (uint d = 0; d < filled; ++d) sums[e] += blocks[d][e];
    }
  for (uint e = item; e < FEW * ACROSS; e += GROUP) {
    const uint i = first_row + e / ACROSS, j = first_column + e % ACROSS;
    if (i < g.m && j < g.n)
      finish_element(c, bias, residual, rectified, c_row, g.residual_row, g.flags, i, j, sums[e]);
  }
}
