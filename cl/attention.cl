// Self-attention for sampling: the kernels of AttentionRollout, which records no graph.
#ifdef WIDE
#define TEAM_IS_GROUP
#endif
#include "team.cl"

/// A self-attention layer after the projections, per sample (Malek-Podjaski & Deligianni, eq. 1-3): o_j = sum
/// over i of softmax_i(query_i . key_j) value_i, then out_j = x_j + bias + weight o_j and rectified_j =
/// ReLU(out_j). `all` [frames, batch, 3 * inner] holds query, key and value; x, out and rectified are
/// [frames, batch, width]; weight is [inner, width]. Each work-group has frames + inner elements of
/// `scratch`: a row of the attention map and o_j. A work-group is a team: x over samples, y over blocks of
/// `rows` frames.
__attribute__((reqd_work_group_size(ITEMS, 1, 1))) kernel void attend_frames(
    global const real* all, uint all0, global real* scratch, uint scratch0, global const real* x, uint x0,
    global const real* weight, uint weight0, global const real* bias, uint bias0, global real* out, uint out0,
    global real* rectified, uint rectified0, uint frames, uint batch, uint inner, uint width, uint rows) {
  TEAM_MEMORY(memory);
  const uint b = get_group_id(0), step = batch * 3 * inner;
  const uint begin = get_group_id(1) * rows, end = min(frames, begin + rows);
  global const real* query = all + all0 + b * 3 * inner;
  global real* p = scratch + scratch0 + (get_group_id(1) * batch + b) * (frames + inner);
  global real* o = p + frames;
  for (uint j = begin; j < end; ++j) {
    global const real* key = query + j * step + inner;
    real top = -INFINITY;
    for (uint i = ITEM; i < frames; i += ITEMS) {
      global const real* q = query + i * step;
      realv sums = 0;
      for (uint c = 0; c < inner; c += VW)
        sums = fma(load_some(q + c, inner - c), load_some(key + c, inner - c), sums);
      p[i] = lane_sum(sums);
      top = fmax(top, p[i]);
    }
    top = team_max(top, memory);
    team_barrier();
    real sum = 0;
    for (uint i = ITEM * VW; i < frames; i += ITEMS * VW)
      store_some(exp(load_some(p + i, frames - i) - top), p + i, frames - i);
    team_barrier();
    for (uint i = ITEM; i < frames; i += ITEMS) sum += p[i];
    sum = team_sum(sum, memory);
    for (uint c = ITEM * VW; c < inner; c += ITEMS * VW) {
      global const real* value = query + 2 * inner + c;
      realv mixed = 0;
      for (uint i = 0; i < frames; ++i, value += step)
        mixed = fma((realv)(p[i]), load_some(value, inner - c), mixed);
      store_some(mixed / sum, o + c, inner - c);
    }
    team_barrier();
    const uint row = (j * batch + b) * width;
    for (uint h = ITEM * VW; h < width; h += ITEMS * VW) {
      const uint left = width - h;
      realv sums = 0;
      for (uint c = 0; c < inner; ++c)
        sums = fma((realv)(o[c]), load_some(weight + weight0 + c * width + h, left), sums);
      sums += load_some(bias + bias0 + h, left) + load_some(x + x0 + row + h, left);
      store_some(sums, out + out0 + row + h, left);
      store_some(sums < 0 ? (realv)0 : sums, rectified + rectified0 + row + h, left);
    }
  }
}

/// The input of the attention generator, out [frames, batch, dof + class_count + noise_count]: the prior
/// [frames, batch, dof] with classes [batch, class_count] and noise [batch, noise_count] appended to every
/// frame.
kernel void rows_with_constants(global const real* prior, uint prior0, global const real* classes,
                                uint classes0, global const real* noise, uint noise0, global real* out,
                                uint out0, uint rows, uint batch, uint dof, uint class_count,
                                uint noise_count) {
  const uint width = dof + class_count + noise_count, columns = (dof + VW - 1) / VW + 1;
  const uint r = get_global_id(0) / columns, c = get_global_id(0) % columns * VW, b = r % batch;
  if (r >= rows) return;
  global real* to = out + out0 + r * width;
  if (c < dof) {
    store_some(load_some(prior + prior0 + r * dof + c, dof - c), to + c, dof - c);
    return;
  }
  for (uint i = 0; i < class_count; ++i) to[dof + i] = classes[classes0 + b * class_count + i];
  for (uint i = 0; i < noise_count; ++i) to[dof + class_count + i] = noise[noise0 + b * noise_count + i];
}
