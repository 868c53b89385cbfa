// Sums over an axis and their adjoint, the expansion along one. Both see a tensor as [outer, count, inner].
#pragma once
#include "motiongan/ops/elementwise.hpp"

namespace motiongan {

namespace detail {

inline std::size_t vectors(const Context& context, std::size_t n) {
  return (n + context.vector_width() - 1) / context.vector_width();
}

/// [outer, count, inner] -> [outer, inner], times scale.
inline Tensor sum_middle_value(const Tensor& x, std::size_t outer, std::size_t count, std::size_t inner,
                               double scale, Shape shape) {
  const Context& context = x.context();
  Tensor out(context, std::move(shape));
  if (inner == 1 && count > 1) {
    context.launch("reduce", "sum_rows", Grid::items(outer), x, out, outer, count, Real{scale});
    return out;
  }
  // Long sums over few columns go in two stages, so that there is work for every core; the order stays fixed.
  const std::size_t columns = vectors(context, inner);
  constexpr std::size_t piece = 64, enough_items = 2048;
  if (count > 2 * piece && outer * columns < enough_items) {
    const std::size_t pieces = (count + piece - 1) / piece;
    const Tensor partial(context, {outer, pieces, inner});
    context.launch("reduce", "sum_middle", Grid::items(outer * pieces * columns), x, partial, outer, count,
                   inner, piece, Real{1});
    context.launch("reduce", "sum_middle", Grid::items(outer * columns), partial, out, outer, pieces, inner,
                   pieces, Real{scale});
  } else {
    context.launch("reduce", "sum_middle", Grid::items(outer * columns), x, out, outer, count, inner, count,
                   Real{scale});
  }
  return out;
}

inline Tensor expand_value(const Tensor& x, std::size_t outer, std::size_t count, std::size_t inner,
                           double scale, Shape shape) {
  const Context& context = x.context();
  Tensor out(context, std::move(shape));
  if (inner == 1)
    context.launch("reduce", "expand_rows", Grid::items(outer * vectors(context, count)), x, out, outer,
                   count, Real{scale});
  else
    context.launch("reduce", "expand", Grid::items(outer * count * vectors(context, inner)), x, out, outer,
                   count, inner, Real{scale});
  return out;
}

}  // namespace detail

inline Var expand(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                  Shape shape);

/// scale * sum over the middle axis of x seen as [outer, count, inner]; the result has `shape` (outer*inner
/// numbers).
inline Var sum_middle(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                      Shape shape) {
  require(x.size() == outer * count * inner && element_count(shape) == outer * inner,
          "sum_middle: ", x.shape(), " is not ", outer, " x ", count, " x ", inner, ", or does not give ",
          shape);
  Tensor value = detail::sum_middle_value(x.value(), outer, count, inner, scale, std::move(shape));
  return record("sum_middle", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {expand(g, outer, count, inner, scale, self.inputs[0].shape())};
                });
}

/// scale * x repeated along a new middle axis: x is seen as [outer, inner], the result, of `shape`, as
/// [outer, count, inner].
inline Var expand(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                  Shape shape) {
  require(x.size() == outer * inner && element_count(shape) == outer * count * inner, "expand: ", x.shape(),
          " is not ", outer, " x ", inner, ", or does not give ", shape);
  Tensor value = detail::expand_value(x.value(), outer, count, inner, scale, std::move(shape));
  return record("expand", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {sum_middle(g, outer, count, inner, scale, self.inputs[0].shape())};
                });
}

/// Sum of all numbers, [1].
inline Var sum(const Var& x) { return sum_middle(x, 1, x.size(), 1, 1, {1}); }
/// Mean of all numbers, [1].
inline Var mean(const Var& x) {
  return sum_middle(x, 1, x.size(), 1, 1.0 / static_cast<double>(x.size()), {1});
}

/// Sum over the last axis: [..., n] -> [...].
inline Var sum_last(const Var& x) {
  Shape shape = x.shape();
  const std::size_t n = shape.back();
  shape.pop_back();
  return sum_middle(x, x.size() / n, n, 1, 1, shape);
}

/// Mean over frames: [T, B, C] -> [B, C].
inline Var mean_frames(const Var& x) {
  const std::size_t frames = x.dim(0);
  return sum_middle(x, 1, frames, x.size() / frames, 1.0 / static_cast<double>(frames), {x.dim(1), x.dim(2)});
}

/// Sum over frames and channels: [T, B, C] -> [B].
inline Var sum_per_sample(const Var& x) {
  return sum_last(sum_middle(x, 1, x.dim(0), x.dim(1) * x.dim(2), 1, {x.dim(1), x.dim(2)}));
}

/// One number per sample, [B], repeated over frames and channels: [T, B, C].
inline Var expand_samples(const Var& x, std::size_t frames, std::size_t channels) {
  const std::size_t batch = x.size();
  return expand(expand(x, batch, channels, 1, 1, {batch, channels}), 1, frames, batch * channels, 1,
                {frames, batch, channels});
}

/// A scalar, [1], repeated over `shape`.
inline Var expand_scalar(const Var& x, Shape shape) {
  const std::size_t n = element_count(shape);
  return expand(x, 1, n, 1, 1, std::move(shape));
}

/// Nearest-neighbour repetition along the first axis, `Up` of SPEC 0 for times = 2: [T, ...] -> [times*T,
/// ...].
inline Var repeat_frames(const Var& x, std::size_t times, double scale = 1) {
  Shape shape = x.shape();
  shape[0] *= times;
  return expand(x, x.dim(0), times, x.size() / x.dim(0), scale, std::move(shape));
}

/// Sums of `times` neighbouring frames: [times*T, ...] -> [T, ...]; `Down` of SPEC 0 for times = 2, scale =
/// 1/2.
inline Var sum_frames(const Var& x, std::size_t times, double scale = 1) {
  Shape shape = x.shape();
  shape[0] /= times;
  return sum_middle(x, shape[0], times, x.size() / x.dim(0), scale, shape);
}

/// Rows of length 1, x / |x|: [rows, n] -> [rows, n]; a row of zeros stays one.
inline Var normalize_rows(const Var& x) {
  const std::size_t rows = x.dim(0), n = x.dim(1);
  return x / expand(sqrt(sum_last(square(x)) + 1e-24), rows, n, 1, 1, {rows, n});
}

/// relu(big + small repeated): big is [count*T, ...], small [T, ...]. One pass instead of three.
inline Var relu_of_sum(const Var& big, const Var& small) {
  require(big.size() % small.size() == 0 && big.size() / big.dim(0) * small.dim(0) == small.size(),
          "relu_of_sum: shapes ", big.shape(), " and ", small.shape());
  const std::size_t outer = small.dim(0), count = big.dim(0) / outer, inner = small.size() / outer;
  const Context& context = big.context();
  Tensor value(context, big.shape());
  context.launch("elementwise", "add_expand_relu",
                 Grid::items(outer * count * detail::vectors(context, inner)), big.value(), small.value(),
                 value, outer, count, inner);
  return record("relu_of_sum", {big, small}, std::move(value),
                [count](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var masked = detail::leaky_relu_grad(g, self.value, 0);
                  return {masked, needs[1] ? (count == 1 ? masked : sum_frames(masked, count)) : Var()};
                });
}

/// Softmax over the last axis, [..., n].
inline Var softmax(const Var& x) {
  const std::size_t n = x.shape().back(), rows = x.size() / n;
  Tensor value(x.context(), x.shape());
  x.context().launch("softmax", "softmax_rows", Grid::items(rows), x.value(), value, rows, n);
  return record("softmax", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  const Var y = detail::itself(self);
                  return {y * (g - expand(sum_last(g * y), rows, n, 1, 1, self.value.shape()))};
                });
}

/// Logarithm of softmax over the last axis, [..., n]: finite where softmax itself would round to 0.
inline Var log_softmax(const Var& x) {
  const std::size_t n = x.shape().back(), rows = x.size() / n;
  Tensor value(x.context(), x.shape());
  x.context().launch("softmax", "log_softmax_rows", Grid::items(rows), x.value(), value, rows, n);
  return record("log_softmax", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  const Var p = exp(detail::itself(self));
                  return {g - p * expand(sum_last(g), rows, n, 1, 1, self.value.shape())};
                });
}

}  // namespace motiongan
