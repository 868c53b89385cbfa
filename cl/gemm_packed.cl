// Products with the same B many times, such as the weights of a recurrent network: B is packed once. Results
// are bit-equal to those of gemm.cl. gemm_packed_bf16.cl compiles the same for a B of bfloat16 values.
#include "gemm_panels.cl"

// Packs B into panels of COLUMNS columns, out[panel][p][COLUMNS]. Columns past n are undefined. Work-groups:
// x over panels, y over blocks of BLOCK values of p.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_pack(global const real* b, uint b_first,
                                                                     uint b_p, uint b_column, uint n, uint k,
                                                                     global weight* out, uint out_first) {
  realv packed[BLOCK * 2];
  const uint column = get_group_id(0) * COLUMNS, p = get_group_id(1) * BLOCK;
  const uint width = min((uint)COLUMNS, n - column), count = min((uint)BLOCK, k - p);
  global const real* from = b + b_first + p * b_p + column * b_column;
  if (b_column != 1)
    pack_transposed(from, b_column, count, width, packed);
  else
    pack_narrow_rows(from, b_p, count, width, width == COLUMNS ? count : 0, packed);
  global weight* to = out + out_first + ((size_t)get_group_id(0) * k + p) * WEIGHT_ROW;
  for (uint i = 0; i < count; ++i, to += WEIGHT_ROW) {
    WRITE_WEIGHTS(to, packed[2 * i], packed[2 * i + 1]);
  }
}

// One row times DIRECT panels: a single stream of B would be bound by memory latency.
static inline void multiply_panels_1(global const real* a, uint count, global const weight* b, size_t panel,
                                     realv* sums) {
  realv s0 = sums[0], s1 = sums[1], s2 = sums[2], s3 = sums[3];
  realv s4 = sums[4], s5 = sums[5], s6 = sums[6], s7 = sums[7];
  for (uint p = 0; p < count; ++p, b += WEIGHT_ROW) {
    const realv value = a[p];
    READ_WEIGHTS(b, b0, b1);
    READ_WEIGHTS(b + panel, b2, b3);
    READ_WEIGHTS(b + 2 * panel, b4, b5);
    READ_WEIGHTS(b + 3 * panel, b6, b7);
    s0 = fma(value, b0, s0), s1 = fma(value, b1, s1);
    s2 = fma(value, b2, s2), s3 = fma(value, b3, s3);
    s4 = fma(value, b4, s4), s5 = fma(value, b5, s5);
    s6 = fma(value, b6, s6), s7 = fma(value, b7, s7);
  }
  sums[0] = s0, sums[1] = s1, sums[2] = s2, sums[3] = s3;
  sums[4] = s4, sums[5] = s5, sums[6] = s6, sums[7] = s7;
}

// The product with a packed B, for batch 1 and A not transposed; the panels of segment s start at
// b_segment[s]. Bit-equal to the product without packing. With RECTIFY, ReLU(C) is also written to
// `rectified`, with C's row stride. Work-groups: x over panels (panels_per_group each), y over rows.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_packed(
    global const real* restrict a, global const weight* restrict b, global real* restrict c,
    global const real* restrict bias, global const real* restrict residual, const Numbers g,
    global real* restrict rectified, uint rectified_first) {
  realv tile[MOST_ROWS * 2];
  a += g.a_first;
  rectified += rectified_first;
  b += g.b_first;
  c += g.c_first;
  bias += g.bias_first;
  residual += g.residual_first;
  const uint k = g.k, flags = g.flags, n = g.n, segments = g.segments;
  const uint row_begin = get_group_id(1) * g.rows_per_group, row_end = min(g.m, row_begin + g.rows_per_group);
  const uint column_begin = get_group_id(0) * g.panels_per_group * COLUMNS;
  const uint column_end = min(n, column_begin + g.panels_per_group * COLUMNS);
  const size_t a_row = g.a_row, c_row = g.c_row, residual_row = g.residual_row,
               panel = (size_t)k * WEIGHT_ROW;
  // Rows a multiple of 4 KB apart map to one set of the 8-way L1 cache: take at most 8 rows at a time.
  const uint most = MOST_ROWS > 8 && a_row * REAL_BYTES % 4096 == 0 ? 8 : MOST_ROWS;
  for (uint j = column_begin; j < column_end; j += COLUMNS) {
    global const weight* from = b + j / COLUMNS * panel;
    if (row_end - row_begin == 1 && column_end - j >= DIRECT * COLUMNS) {
      realv sums[2 * DIRECT];
      global const real* at = c + row_begin * c_row + j;
      for (uint w = 0; w < 2 * DIRECT; ++w) sums[w] = flags & ACCUMULATE ? READ(at + w * VW) : (realv)(0);
      for (uint s = 0; s < segments; ++s)
        multiply_panels_1(a + g.a_segment[s] + row_begin * a_row, k, from + g.b_segment[s], panel, sums);
      for (uint w = 0; w < DIRECT; ++w, j += COLUMNS)
        store_tile(c + row_begin * c_row + j, 0, 1, COLUMNS, bias + j,
                   residual + row_begin * residual_row + j, 0, flags, sums + 2 * w);
      if (flags & RECTIFY)
        rectify(c + row_begin * c_row + j - DIRECT * COLUMNS, c_row, 1, DIRECT * COLUMNS,
                rectified + row_begin * c_row + j - DIRECT * COLUMNS);
      j -= COLUMNS;
      continue;
    }
    const uint width = min((uint)COLUMNS, column_end - j);
    for (uint i = row_begin, rows; i < row_end; i += rows) {
      rows = tile_rows(row_end - i, most);
      if (flags & ACCUMULATE)
        load_tile(c + i * c_row + j, c_row, rows, width, tile);
      else
        for (uint e = 0; e < 2 * rows; ++e) tile[e] = 0;
      for (uint s = 0; s < segments; ++s) {
        global const real* rows_of_a = a + g.a_segment[s] + i * a_row;
        global const weight* piece = from + g.b_segment[s];
#define MULTIPLY_PANEL(R) \
  if (rows == R) multiply_panel_##R(rows_of_a, a_row, k, piece, tile);
        FOR_TILE_ROWS(MULTIPLY_PANEL)
      }
      store_tile(c + i * c_row + j, c_row, rows, width, bias + j, residual + i * residual_row + j,
                 residual_row, flags, tile);
      if (flags & RECTIFY) rectify(c + i * c_row + j, c_row, rows, width, rectified + i * c_row + j);
    }
  }
}

// Packs the weights [4k, in] of an LSTM layer for gemm_lstm_cell: for each p, panel 2u holds gates i and f of
// the VW units from u * VW, panel 2u + 1 gates g and o. Work-groups: x over panels, y over blocks of BLOCK
// values of p.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_pack_gates(global const real* w, uint w_first,
                                                                           uint in, uint k,
                                                                           global weight* out,
                                                                           uint out_first) {
  realv packed[BLOCK * 2];
  const uint unit = get_group_id(0) / 2 * VW, gate = get_group_id(0) % 2 * 2, p = get_group_id(1) * BLOCK;
  const uint width = min((uint)VW, k - unit), count = min((uint)BLOCK, in - p);
  for (uint h = 0; h < 2; ++h)
    pack_transposed_half(w + w_first + ((size_t)(gate + h) * k + unit) * in + p, in, count, width,
                         packed + h);
  global weight* to = out + out_first + ((size_t)get_group_id(0) * in + p) * WEIGHT_ROW;
  for (uint i = 0; i < count; ++i, to += WEIGHT_ROW) {
    WRITE_WEIGHTS(to, packed[2 * i], packed[2 * i + 1]);
  }
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
// z[R][4] = R rows of A times the two panels of VW units.
#define DEFINE_MULTIPLY_GATES(R)                                                             \
  static inline void multiply_gates_##R(global const real* a, size_t row_stride, uint count, \
                                        global const weight* w, size_t panel, realv* z) {    \
    ROWS_##R(GATES_ZERO) for (uint p = 0; p < count; ++p, ++a, w += WEIGHT_ROW) {            \
      READ_WEIGHTS(w, w0, w1);                                                               \
      READ_WEIGHTS(w + panel, w2, w3);                                                       \
      ROWS_##R(GATES_FMA)                                                                    \
    }                                                                                        \
    ROWS_##R(GATES_STORE)                                                                    \
  }
#if VW * REAL_BYTES == 64
#define MOST_GATE_ROWS 6
DEFINE_MULTIPLY_GATES(6)
#else
#define MOST_GATE_ROWS 2
#endif
DEFINE_MULTIPLY_GATES(2)
DEFINE_MULTIPLY_GATES(1)

// One step of an LSTM layer, product and cell: gates = A [batch, in] W^T + x, in the order i, f, g, o; then c
// and h as in lstm_cell. x_row is 0 if all rows share x (a bias). Activated gates are written if `keep` is
// set. With `length`, A is h of the previous step (in = k). Work-groups: x over blocks of VW units, y over
// rows.
__attribute__((reqd_work_group_size(1, 1, 1))) kernel void gemm_lstm_cell(
    global const real* a, uint a_first, uint a_row, uint in, global const weight* w, uint w_first,
    global const real* x, uint x_first, uint x_row, global const real* c_before, uint c_before_first,
    global real* h, uint h_first, uint h_row, global real* c, uint c_first, global real* gates,
    uint gates_first, uint keep, global const int* length, uint step, uint batch, uint k,
    uint rows_per_group) {
  realv z[MOST_GATE_ROWS * 4];
  const uint unit = get_group_id(0) * VW, left = k - unit;
  const uint row_begin = get_group_id(1) * rows_per_group, row_end = min(batch, row_begin + rows_per_group);
  const size_t panel = (size_t)in * WEIGHT_ROW;
  global const weight* panels = w + w_first + get_group_id(0) * 2 * panel;
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
      if (length && step >= (uint)length[r + e]) {  // its sequence has ended
        store_some(load_some(from + (size_t)e * a_row + unit, left),
                   h + h_first + (size_t)(r + e) * h_row + unit, left);
        store_some(load_some(c_before + c_before_first + at, left), c + c_first + at, left);
        continue;
      }
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
