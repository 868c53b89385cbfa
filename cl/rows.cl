// Functions of rows, each the work of a team: of one work-item here, of a work-group in rows_wide.cl.
#include "team.cl"

/// out[r] = scale * sum of x[r, :].
TEAM_SIZE kernel void sum_rows(global const real* x, uint x0, global real* out, uint out0, uint rows,
                               uint count, real scale) {
  TEAM_MEMORY(memory);
  const uint r = TEAM;
  if (r >= rows) return;
  global const real* p = x + x0 + r * count;
  realv sum = 0;
  for (uint j = ITEM * VW; j < count; j += ITEMS * VW) sum += load_some(p + j, count - j);
  const real total = team_sum(lane_sum(sum), memory);
  if (ITEM == 0) out[out0 + r] = total * scale;
}

/// out[r, s] = sum of x[r, j] over j in [s*chunk, (s+1)*chunk). Teams: rows times pieces.
TEAM_SIZE kernel void sum_pieces(global const real* x, uint x0, global real* out, uint out0, uint rows,
                                 uint count, uint chunk) {
  TEAM_MEMORY(memory);
  const uint pieces = (count + chunk - 1) / chunk, at = TEAM;
  if (at >= rows * pieces) return;
  const uint first = at % pieces * chunk, last = min(first + chunk, count);
  global const real* p = x + x0 + at / pieces * count;
  realv sum = 0;
  for (uint j = first + ITEM * VW; j < last; j += ITEMS * VW) sum += load_some(p + j, last - j);
  const real total = team_sum(lane_sum(sum), memory);
  if (ITEM == 0) out[out0 + at] = total;
}

/// out[s] = sum of squares of x in [s*chunk, (s+1)*chunk). Teams: chunks.
TEAM_SIZE kernel void squares_of_chunks(global const real* x, uint x0, global real* out, uint out0, uint n,
                                        uint chunk) {
  TEAM_MEMORY(memory);
  const uint s = TEAM, first = s * chunk;
  if (first >= n) return;
  const uint last = min(first + chunk, n);
  realv sum = 0;
  for (uint i = first + ITEM * VW; i < last; i += ITEMS * VW) {
    const realv v = load_some(x + x0 + i, last - i);
    sum += v * v;
  }
  const real total = team_sum(lane_sum(sum), memory);
  if (ITEM == 0) out[out0 + s] = total;
}

/// out[r] = sum over the columns of x[r]^2.
TEAM_SIZE kernel void squares_of_rows(global const real* x, uint x0, global real* out, uint out0, uint rows,
                                      uint columns) {
  TEAM_MEMORY(memory);
  const uint r = TEAM;
  if (r >= rows) return;
  global const real* p = x + x0 + (size_t)r * columns;
  realv sum = 0;
  for (uint j = ITEM * VW; j < columns; j += ITEMS * VW) {
    const realv v = load_some(p + j, columns - j);
    sum = fma(v, v, sum);
  }
  const real total = team_sum(lane_sum(sum), memory);
  if (ITEM == 0) out[out0 + r] = total;
}

/// out[r, :] = softmax of x[r, :]; the maximum is subtracted first to avoid overflow.
TEAM_SIZE kernel void softmax_rows(global const real* x, uint x0, global real* out, uint out0, uint rows,
                                   uint count) {
  TEAM_MEMORY(memory);
  const uint r = TEAM;
  if (r >= rows) return;
  global const real* p = x + x0 + r * count;
  global real* q = out + out0 + r * count;
  real top = p[0];
  for (uint j = ITEM; j < count; j += ITEMS) top = fmax(top, p[j]);
  top = team_max(top, memory);
  real sum = 0;
  for (uint j = ITEM; j < count; j += ITEMS) {
    q[j] = exp(p[j] - top);
    sum += q[j];
  }
  sum = team_sum(sum, memory);
  for (uint j = ITEM; j < count; j += ITEMS) q[j] /= sum;
}

/// out[r, :] = log softmax of x[r, :].
TEAM_SIZE kernel void log_softmax_rows(global const real* x, uint x0, global real* out, uint out0, uint rows,
                                       uint count) {
  TEAM_MEMORY(memory);
  const uint r = TEAM;
  if (r >= rows) return;
  global const real* p = x + x0 + r * count;
  global real* q = out + out0 + r * count;
  real top = p[0];
  for (uint j = ITEM; j < count; j += ITEMS) top = fmax(top, p[j]);
  top = team_max(top, memory);
  real sum = 0;
  for (uint j = ITEM; j < count; j += ITEMS) sum += exp(p[j] - top);
  const real shift = top + log(team_sum(sum, memory));
  for (uint j = ITEM; j < count; j += ITEMS) q[j] = p[j] - shift;
}
