// Copying, shifting and gathering rows and frames. Motion is [frames, batch, channels]; a row is one frame of
// one sample.

/// out[o*out_stride + r] = x[o*x_stride + r] for r < run, o < outer.
kernel void copy_runs(global const real* x, uint x0, uint x_stride, global real* out, uint out0,
                      uint out_stride, uint outer, uint run) {
  const uint columns = (run + VW - 1) / VW, item = get_global_id(0);
  const uint o = item / columns, r = item % columns * VW;
  if (o >= outer) return;
  const uint left = run - r;
  store_some(load_some(x + x0 + o * x_stride + r, left), out + out0 + o * out_stride + r, left);
}

// Up to MOST_PARTS tensors that copy_parts copies: part p is `run[p]` elements from x[p] of its buffer, for
// each o, and goes to at[p]. Its vectors are those from item[p] on.
#define MOST_PARTS 8
typedef struct {
  uint x[MOST_PARTS], at[MOST_PARTS], run[MOST_PARTS], item[MOST_PARTS];
  uint count, items;
} Parts;

/// out[o*out_stride + at[p] + r] = x_p[o*run[p] + r] for all parts p, r < run[p] and o < outer. Work-items:
/// outer times the vectors of all parts.
kernel void copy_parts(global const real* x0, global const real* x1, global const real* x2,
                       global const real* x3, global const real* x4, global const real* x5,
                       global const real* x6, global const real* x7, global real* out, uint out0,
                       const Parts parts, uint out_stride, uint outer) {
  const uint o = get_global_id(0) / parts.items, item = get_global_id(0) % parts.items;
  if (o >= outer) return;
  global const real* x = x0;
  uint from = parts.x[0], to = parts.at[0], run = parts.run[0], first = parts.item[0];
  // Constant indices: Mesa's llvmpipe crashes where a struct that is an argument is indexed by a variable.
#define TAKE_PART(p)                               \
  if (p < parts.count && item >= parts.item[p]) {  \
    x = x##p, from = parts.x[p], to = parts.at[p]; \
    run = parts.run[p], first = parts.item[p];     \
  }
  TAKE_PART(1);
  TAKE_PART(2);
  TAKE_PART(3);
  TAKE_PART(4);
  TAKE_PART(5);
  TAKE_PART(6);
  TAKE_PART(7);
  const uint r = (item - first) * VW, left = run - r;
  store_some(load_some(x + from + o * run + r, left), out + out0 + o * out_stride + to + r, left);
}

/// out[o, r] = x[o, r - before] if 0 <= r - before < run, else 0; r < out_run.
kernel void pad_runs(global const real* x, uint x0, global real* out, uint out0, uint outer, uint run,
                     uint out_run, uint before) {
  const uint columns = (out_run + VW - 1) / VW, item = get_global_id(0);
  const uint o = item / columns, r = item % columns * VW;
  if (o >= outer) return;
  const uint left = out_run - r;
  realv v = 0;
  if (r >= before && r + VW <= before + run) {
    v = LOAD_VECTOR(x + x0 + o * run + r - before);
  } else if (r + VW > before && r < before + run) {
    real lanes[VW];
    for (uint j = 0; j < VW; ++j)
      lanes[j] = r + j >= before && r + j < before + run ? x[x0 + o * run + r + j - before] : (real)0;
    v = vload(0, lanes);
  }
  store_some(v, out + out0 + o * out_run + r, left);
}

/// out[t, b, :] = x[t + first + sign*offset[b], b, :], or `outside` if there is no such frame.
kernel void shift_frames(global const real* x, uint x0, global const int* offset, global real* out, uint out0,
                         uint frames_in, uint frames_out, uint batch, uint channels, int first, int sign,
                         real outside) {
  const uint columns = (channels + VW - 1) / VW, item = get_global_id(0);
  const uint row = item / columns, c = item % columns * VW;
  if (row >= frames_out * batch) return;
  const uint b = row % batch, left = channels - c;
  const int t = (int)(row / batch) + first + sign * offset[b];
  realv v = outside;
  if (t >= 0 && t < (int)frames_in) v = load_some(x + x0 + ((uint)t * batch + b) * channels + c, left);
  store_some(v, out + out0 + row * channels + c, left);
}

/// Means of neighbouring frames, odd pairs first: with pairs = frames/2, out[t] = (x[2t-1] + x[2t])/2 for t =
/// 0..pairs and out[pairs+1+t] = (x[2t] + x[2t+1])/2 for t < pairs; frames outside are zero. `slab` is the
/// size of one frame of the batch.
kernel void pair_means(global const real* x, uint x0, global real* out, uint out0, uint frames, uint slab) {
  const uint columns = (slab + VW - 1) / VW, item = get_global_id(0), pairs = frames / 2;
  const uint t = item / columns, i = item % columns * VW;
  if (t >= 2 * pairs + 1) return;
  const uint left = slab - i;
  const int first = t <= pairs ? 2 * (int)t - 1 : 2 * (int)(t - pairs - 1);
  realv v = 0;
  if (first >= 0) v = load_some(x + x0 + (uint)first * slab + i, left);
  if (first + 1 < (int)frames) v += load_some(x + x0 + (uint)(first + 1) * slab + i, left);
  store_some(v * (real)0.5, out + out0 + t * slab + i, left);
}

/// The adjoint of pair_means: out has `frames` frames, g has 2*(frames/2)+1.
kernel void pair_means_adjoint(global const real* g, uint g0, global real* out, uint out0, uint frames,
                               uint slab) {
  const uint columns = (slab + VW - 1) / VW, item = get_global_id(0), pairs = frames / 2;
  const uint u = item / columns, i = item % columns * VW;
  if (u >= frames) return;
  const uint left = slab - i, t = u / 2;
  const uint odd = t + u % 2;  // the odd pair that u is in: u = 2*odd or 2*odd - 1
  realv v = 0;
  if (odd <= pairs) v = load_some(g + g0 + odd * slab + i, left);
  if (t < pairs) v += load_some(g + g0 + (pairs + 1 + t) * slab + i, left);
  store_some(v * (real)0.5, out + out0 + u * slab + i, left);
}

/// out[r, :] = x[index[r], :]
kernel void gather_rows(global const real* x, uint x0, global const int* index, global real* out, uint out0,
                        uint rows, uint channels) {
  const uint columns = (channels + VW - 1) / VW, item = get_global_id(0);
  const uint r = item / columns, c = item % columns * VW;
  if (r >= rows) return;
  const uint left = channels - c;
  store_some(load_some(x + x0 + (uint)index[r] * channels + c, left), out + out0 + r * channels + c, left);
}

/// out[v, :] = sum of x[r, :] over the rows r with index[r] = v, in ascending order, so that reruns are
/// bit-equal.
kernel void scatter_add_rows(global const real* x, uint x0, global const int* index, global real* out,
                             uint out0, uint rows, uint out_rows, uint channels) {
  const uint columns = (channels + VW - 1) / VW, item = get_global_id(0);
  const uint v = item / columns, c = item % columns * VW;
  if (v >= out_rows) return;
  const uint left = channels - c;
  realv sum = 0;
  for (uint r = 0; r < rows; ++r)
    if (index[r] == (int)v) sum += load_some(x + x0 + r * channels + c, left);
  store_some(sum, out + out0 + v * channels + c, left);
}

/// One window of frames per sample: out[t, b, c] = poses[row[b] + t*stride, c], minus its value in the
/// window's first frame if relative[c] is set. If yaw < channels, the channels x and z are then rotated by
/// minus the yaw of the window's first frame (yaw_scale radians per unit).
kernel void gather_windows(global const real* poses, uint poses0, global const int* row,
                           global const int* relative, global real* out, uint out0, uint frames, uint batch,
                           uint channels, uint stride, uint x, uint z, uint yaw, real yaw_scale) {
  const uint r = get_global_id(0);  // row of out
  if (r >= frames * batch) return;
  global const real* first = poses + poses0 + (uint)row[r % batch] * channels;
  global const real* now = first + r / batch * stride * channels;
  global real* to = out + out0 + r * channels;
  for (uint c = 0; c < channels; ++c) to[c] = relative[c] ? now[c] - first[c] : now[c];
  if (yaw < channels) {
    real cosine;
    const real sine = sincos(first[yaw] * yaw_scale, &cosine), old_x = to[x], old_z = to[z];
    to[x] = cosine * old_x - sine * old_z;
    to[z] = sine * old_x + cosine * old_z;
  }
}

/// out[r, :] += factor * x[r, :] for `rows` rows of `run` elements.
kernel void add_rows(global const real* x, uint x0, uint x_stride, real factor, global real* out, uint out0,
                     uint out_stride, uint rows, uint run) {
  const uint columns = (run + VW - 1) / VW, item = get_global_id(0);
  const uint r = item / columns, j = item % columns * VW;
  if (r >= rows) return;
  const uint left = run - j;
  global real* to = out + out0 + r * out_stride + j;
  store_some(load_some(to, left) + factor * load_some(x + x0 + r * x_stride + j, left), to, left);
}
