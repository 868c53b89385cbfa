// Attention over frames, per sample (Malek-Podjaski & Deligianni, eq. 1, 2).
//
// Motion is [frames, batch, channels], so the frames of a sample are batch * channels elements apart and the
// products read them in place. An attention map is [batch, rows, columns], one matrix per sample. The two
// products are closed under differentiation: the gradients of each are the same two products.
#pragma once
#include "motiongan/core/gemm.hpp"
#include "motiongan/ops/reduce.hpp"

namespace motiongan {

inline Var attention_apply(const Var& map, const Var& x, bool transposed = false);

/// Attention scores: map[b, j, i] = a_j . c_i for every sample b: [J, B, C], [I, B, C] -> [B, J, I]. Throws
/// Error if B or C differ.
inline Var attention_scores(const Var& a, const Var& c) {
  require(a.value().rank() == 3 && c.value().rank() == 3 && a.dim(1) == c.dim(1) && a.dim(2) == c.dim(2),
          "attention_scores: shapes ", a.shape(), " and ", c.shape());
  const std::size_t rows = a.dim(0), columns = c.dim(0), batch = a.dim(1), channels = a.dim(2);
  GemmCall call{.m = rows, .n = columns, .k = channels, .a = a.value(), .b = c.value()};
  call.c = Tensor(a.context(), {batch, rows, columns});
  call.a_ld = call.b_ld = batch * channels, call.c_ld = columns;
  call.batch = batch;
  call.a_batch_stride = call.b_batch_stride = channels, call.c_batch_stride = rows * columns;
  call.b_transposed = true;
  gemm(a.context(), call);
  return record("attention_scores", {a, c}, call.c,
                [](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  return {needs[0] ? attention_apply(g, self.inputs[1]) : Var(),
                          needs[1] ? attention_apply(g, self.inputs[0], true) : Var()};
                });
}

/// out_j = sum over i of map[b, j, i] x_i for every sample b: [B, J, I], [I, B, C] -> [J, B, C]. With
/// `transposed`, the map is [B, I, J]. Throws Error if the shapes do not fit.
inline Var attention_apply(const Var& map, const Var& x, bool transposed) {
  require(map.value().rank() == 3 && x.value().rank() == 3 && map.dim(0) == x.dim(1) &&
              map.dim(transposed ? 1 : 2) == x.dim(0),
          "attention_apply: a map ", map.shape(), transposed ? " (transposed)" : "", " over frames ",
          x.shape());
  const std::size_t rows = map.dim(transposed ? 2 : 1), inner = x.dim(0), batch = x.dim(1),
                    channels = x.dim(2);
  GemmCall call{.m = rows, .n = channels, .k = inner, .a = map.value(), .b = x.value()};
  call.c = Tensor(x.context(), {rows, batch, channels});
  call.a_ld = map.dim(2), call.b_ld = call.c_ld = batch * channels;
  call.batch = batch;
  call.a_batch_stride = rows * inner, call.b_batch_stride = call.c_batch_stride = channels;
  call.a_transposed = transposed;
  gemm(x.context(), call);
  return record("attention_apply", {map, x}, call.c,
                [transposed](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var &m = self.inputs[0], &frames = self.inputs[1];
                  Var by_map;
                  if (needs[0])
                    by_map = transposed ? attention_scores(frames, g) : attention_scores(g, frames);
                  return {by_map, needs[1] ? attention_apply(m, g, !transposed) : Var()};
                });
}

/// Attention weights beta (Malek-Podjaski & Deligianni, eq. 1): map[b, j, i] = softmax over i of query_i .
/// key_j, the weight of frame i in the output of frame j; every row sums to 1. [I, B, R], [J, B, R] ->
/// [B, J, I].
inline Var attention_map(const Var& query, const Var& key) { return softmax(attention_scores(key, query)); }

namespace detail {

/// Rows [T, B, dof + Y + n] at `out`: a prior [T, B, dof] with classes [B, Y] and, if not empty, noise [B, n]
/// repeated on every frame.
inline void rows_with_constants(const Tensor& prior, const Tensor& classes, const Tensor& noise,
                                const At& out) {
  const Context& context = prior.context();
  const std::size_t batch = prior.dim(1), dof = prior.dim(2), rows = prior.dim(0) * batch;
  context.launch("attention", "rows_with_constants", LaunchGrid::items(rows * (vectors(context, dof) + 1)),
                 prior, classes, noise.empty() ? classes : noise, out, rows, batch, dof, classes.dim(1),
                 noise.empty() ? std::size_t{0} : noise.dim(1));
}

/// The output projection of self-attention, gamma included: weight [inner, C], bias [C].
struct AttentionOutput {
  const Tensor &weight, &bias;
};

/// A layer of self-attention after its first product, in one kernel and without a graph: `all` [T, B, 3 *
/// inner] holds query, key and value; out [T, B, C] = x [T, B, C] + attention, its ReLU goes to `rectified`.
/// `scratch` is [pieces, B, T + inner]; a sample's frames are cut into `pieces`, to keep all cores busy.
inline void attend_frames(const Tensor& all, const Tensor& scratch, const Tensor& x,
                          const AttentionOutput& output, const Tensor& out, const At& rectified,
                          std::size_t pieces) {
  if (x.size() == 0) return;
  const std::size_t frames = x.dim(0), batch = x.dim(1), rows = (frames + pieces - 1) / pieces,
                    blocks = (frames + rows - 1) / rows;
  x.context().launch(
      "attention", "attend_frames",
      x.context().wide() ? x.context().groups(batch, blocks) : LaunchGrid::groups(batch, blocks), all,
      scratch, x, output.weight, output.bias, out, rectified, frames, batch, all.dim(2) / 3, x.dim(2), rows);
}

}  // namespace detail
}  // namespace motiongan
