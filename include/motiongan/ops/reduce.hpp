// Reductions over an axis, broadcasting (their adjoint), and operations built on them: means, pooling,
// softmax. Internally a tensor is viewed as [outer, count, inner] around the axis.
#pragma once
#include "motiongan/core/rows.hpp"
#include "motiongan/ops/elementwise.hpp"
#include "motiongan/ops/reshape.hpp"

namespace motiongan {

namespace detail {

/// The number of vectors that hold n elements.
inline std::size_t vectors(const Context& context, std::size_t n) {
  return (n + context.vector_width() - 1) / context.vector_width();
}

/// Views a tensor as [outer, count, inner] around one axis. Throws Error, starting with `operation`, if there
/// is no such axis.
struct AxisView {
  std::size_t outer = 1, count = 0, inner = 1;
  AxisView(const char* operation, const Shape& shape, std::size_t axis) {
    require(axis < shape.size(), operation, ": shape ", shape, " has no axis ", axis);
    count = shape[axis];
    for (std::size_t i = 0; i < shape.size(); ++i)
      if (i != axis) (i < axis ? outer : inner) *= shape[i];
  }
};

/// The same around the last axis: its rows are `outer`.
inline AxisView last_axis(const char* operation, const Shape& shape) {
  return {operation, shape, shape.empty() ? 0 : shape.size() - 1};
}

/// Elements of one entry of the first axis, such as a frame; right for no frames too.
inline std::size_t frame_size(const char* operation, const Var& x) {
  return AxisView(operation, x.shape(), 0).inner;
}

/// scale * sum over the middle axis: [outer, count, inner] -> [outer, inner]. The order of summation is
/// fixed. A sum of no elements is 0.
inline Tensor sum_axis_value(const Tensor& x, std::size_t outer, std::size_t count, std::size_t inner,
                             double scale, Shape shape) {
  const Context& context = x.context();
  Tensor out(context, std::move(shape));
  if (count == 0) {
    fill(out, 0);
    return out;
  }
  if (inner == 1 && count > 1) {
    constexpr std::size_t chunk = 4096;
    const std::size_t pieces = context.wide() ? (count + chunk - 1) / chunk : 1;
    if (pieces > 1) {  // one work-group would leave the device idle
      const Tensor partial(context, {outer, pieces});
      launch_rows(context, "sum_pieces", outer * pieces, chunk, x, partial, outer, count, chunk);
      launch_rows(context, "sum_rows", outer, pieces, partial, out, outer, pieces, KernelReal{scale});
    } else {
      launch_rows(context, "sum_rows", outer, count, x, out, outer, count, KernelReal{scale});
    }
    return out;
  }
  // Long sums over few columns run in two stages to give every core work; the order stays fixed.
  const std::size_t columns = vectors(context, inner);
  constexpr std::size_t piece = 64, enough_items = 2048;
  if (count > 2 * piece && outer * columns < enough_items) {
    const std::size_t pieces = (count + piece - 1) / piece;
    const Tensor partial(context, {outer, pieces, inner});
    context.launch("reduce", "sum_axis", LaunchGrid::items(outer * pieces * columns), x, partial, outer,
                   count, inner, piece, KernelReal{1});
    context.launch("reduce", "sum_axis", LaunchGrid::items(outer * columns), partial, out, outer, pieces,
                   inner, pieces, KernelReal{scale});
  } else {
    context.launch("reduce", "sum_axis", LaunchGrid::items(outer * columns), x, out, outer, count, inner,
                   count, KernelReal{scale});
  }
  return out;
}

/// scale * x repeated along a new middle axis: [outer, inner] -> [outer, count, inner].
inline Tensor broadcast_axis_value(const Tensor& x, std::size_t outer, std::size_t count, std::size_t inner,
                                   double scale, Shape shape) {
  const Context& context = x.context();
  Tensor out(context, std::move(shape));
  if (inner == 1)
    context.launch("reduce", "broadcast_rows", LaunchGrid::items(outer * vectors(context, count)), x, out,
                   outer, count, KernelReal{scale});
  else
    context.launch("reduce", "broadcast_axis", LaunchGrid::items(outer * count * vectors(context, inner)), x,
                   out, outer, count, inner, KernelReal{scale});
  return out;
}

inline Var broadcast_axis(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                          Shape shape);

/// scale * sum over the middle axis of x viewed as [outer, count, inner]; the result has shape `shape`, of
/// outer * inner elements. Throws Error if the sizes do not fit.
inline Var sum_axis(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                    Shape shape) {
  require(x.size() == outer * count * inner && element_count(shape) == outer * inner, "sum_axis: ", x.shape(),
          " is not ", outer, " x ", count, " x ", inner, ", or does not give ", shape);
  Tensor value = sum_axis_value(x.value(), outer, count, inner, scale, std::move(shape));
  return record("sum", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {broadcast_axis(g, outer, count, inner, scale, self.inputs[0].shape())};
                });
}

/// scale * x repeated along a new middle axis: [outer, inner] -> [outer, count, inner], returned with shape
/// `shape`. Throws Error if the sizes do not fit.
inline Var broadcast_axis(const Var& x, std::size_t outer, std::size_t count, std::size_t inner, double scale,
                          Shape shape) {
  require(x.size() == outer * inner && element_count(shape) == outer * count * inner,
          "broadcast_axis: ", x.shape(), " is not ", outer, " x ", inner, ", or does not give ", shape);
  Tensor value = broadcast_axis_value(x.value(), outer, count, inner, scale, std::move(shape));
  return record("broadcast", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  return {sum_axis(g, outer, count, inner, scale, self.inputs[0].shape())};
                });
}

}  // namespace detail

/// Sum of all elements, [1].
inline Var sum(const Var& x) { return detail::sum_axis(x, 1, x.size(), 1, 1, {1}); }
/// Mean of all elements, [1]. Throws Error if there are none.
inline Var mean(const Var& x) {
  require(x.size() > 0, "mean: shape ", x.shape(), " has no elements; give at least one frame and sample");
  return detail::sum_axis(x, 1, x.size(), 1, 1.0 / static_cast<double>(x.size()), {1});
}

namespace detail {
/// An axis that may be negative, counted from the end, as an index. Throws Error if there is no such axis.
inline std::size_t axis_index(const char* operation, const Shape& shape, int axis) {
  const auto rank = static_cast<int>(shape.size());
  require(axis >= -rank && axis < rank, operation, ": axis ", axis, " of ", shape, ", expected ", -rank,
          " to ", rank - 1);
  return static_cast<std::size_t>(axis < 0 ? axis + rank : axis);
}
}  // namespace detail

/// scale * sum over one axis, which is removed: [2, 3, 5] over axis 1 -> [2, 5]. Negative axes count from the
/// end, -1 is the last. Throws Error if there is no such axis.
inline Var sum(const Var& x, int axis, double scale = 1) {
  const std::size_t at = detail::axis_index("sum", x.shape(), axis);
  const detail::AxisView view("sum", x.shape(), at);
  Shape shape = x.shape();
  shape.erase(shape.begin() + static_cast<std::ptrdiff_t>(at));
  return detail::sum_axis(x, view.outer, view.count, view.inner, scale, std::move(shape));
}

/// Mean over one axis, which is removed, as in sum(). Throws Error if the axis is empty.
inline Var mean(const Var& x, int axis) {
  const std::size_t count = x.shape()[detail::axis_index("mean", x.shape(), axis)];
  require(count > 0, "mean: axis ", axis, " of ", x.shape(), " is empty; give at least one frame and sample");
  return sum(x, axis, 1.0 / static_cast<double>(count));
}

/// Sum over frames and channels: [T, B, C] -> [B].
inline Var sum_per_sample(const Var& x) { return sum(sum(x, 0), -1); }

/// Broadcasts x to `shape` by the rules of NumPy and PyTorch: missing leading axes and axes of size 1 are
/// repeated, e.g. [B, 1] -> [T, B, C]. Throws Error if the shapes are incompatible.
inline Var broadcast_to(const Var& x, const Shape& shape) {
  const Shape& from = x.shape();
  require(from.size() <= shape.size(), "broadcast_to: ", from, " has more axes than ", shape);
  Shape at(shape.size() - from.size(), 1);
  at.insert(at.end(), from.begin(), from.end());
  for (std::size_t i = 0; i < shape.size(); ++i)
    require(at[i] == shape[i] || at[i] == 1, "broadcast_to: ", from, " does not broadcast to ", shape);
  Var y = x;
  for (std::size_t last = shape.size(); last-- > 0;) {
    if (at[last] == shape[last]) continue;
    std::size_t first = last;  // neighbouring axes of size 1 are broadcast in one pass
    while (first > 0 && at[first - 1] == 1) --first;
    std::size_t outer = 1, count = 1, inner = 1;
    for (std::size_t i = 0; i < first; ++i) outer *= at[i];
    for (std::size_t i = last + 1; i < at.size(); ++i) inner *= at[i];
    for (std::size_t i = first; i <= last; ++i) count *= at[i] = shape[i];
    y = detail::broadcast_axis(y, outer, count, inner, 1, at);
    last = first;
  }
  return y.shape() == shape ? y : reshape(y, shape);
}

/// scale * nearest-neighbour upsampling along the first axis: [T, ...] -> [times*T, ...]. DVGAN's `Up` for
/// times = 2.
inline Var upsample_nearest(const Var& x, std::size_t times, double scale = 1) {
  const std::size_t size = detail::frame_size("upsample_nearest", x), frames = x.dim(0);
  Shape shape = x.shape();
  shape[0] = element_count({frames, times});
  return detail::broadcast_axis(x, frames, times, size, scale, std::move(shape));
}

/// scale * sum over groups of `times` consecutive frames: [times*T, ...] -> [T, ...]. With times = 2 and
/// scale = 1/2 this is average pooling, DVGAN's `Down`. Throws Error unless `times` divides the frames.
inline Var sum_pool(const Var& x, std::size_t times, double scale = 1) {
  const std::size_t size = detail::frame_size("sum_pool", x);
  require(times > 0 && x.dim(0) % times == 0, "sum_pool: groups of ", times, " frames of ", x.shape(),
          ", expected a divisor of the number of frames");
  Shape shape = x.shape();
  shape[0] /= times;
  return detail::sum_axis(x, shape[0], times, size, scale, shape);
}

/// Normalises every row to unit length: [rows, n] -> [rows, n]; a zero row stays zero.
inline Var normalize_rows(const Var& x) {
  const std::size_t rows = x.dim(0), n = x.dim(1);
  return x / detail::broadcast_axis(sqrt(sum(square(x), -1) + 1e-24), rows, n, 1, 1, {rows, n});
}

namespace detail {
/// out[o, j, i] = relu(big[o, j, i] + small[o, i]), seen as [outer, count, inner]; out may be big.
inline void add_broadcast_relu(const Tensor& big, const Tensor& small, const Tensor& out, std::size_t outer,
                               std::size_t count, std::size_t inner) {
  const Context& context = big.context();
  context.launch("elementwise", "add_broadcast_relu",
                 LaunchGrid::items(outer * count * vectors(context, inner)), big, small, out, outer, count,
                 inner);
}
}  // namespace detail

/// relu(big + small), with each frame of small added to `count` consecutive frames of big: [count*T, ...],
/// [T, ...] -> [count*T, ...]. One pass instead of three. Throws Error if the shapes do not fit.
inline Var relu_of_sum(const Var& big, const Var& small) {
  const std::size_t inner = detail::frame_size("relu_of_sum", big), outer = small.dim(0),
                    count = outer > 0 ? big.dim(0) / outer : 1;
  require(detail::frame_size("relu_of_sum", small) == inner && big.dim(0) == outer * count && count > 0,
          "relu_of_sum: shapes ", big.shape(), " and ", small.shape());
  Tensor value(big.context(), big.shape());
  detail::add_broadcast_relu(big.value(), small.value(), value, outer, count, inner);
  return record("relu_of_sum", {big, small}, std::move(value),
                [count](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var masked = detail::leaky_relu_grad(g, self.value, 0);
                  return {masked, needs[1] ? (count == 1 ? masked : sum_pool(masked, count)) : Var()};
                });
}

namespace detail {
/// A function of every row of `view`, [rows, n], by a kernel of cl/rows.cl.
inline Tensor row_function(const char* kernel, const Tensor& x, const AxisView& view) {
  Tensor value(x.context(), x.shape());
  launch_rows(x.context(), kernel, view.count > 0 ? view.outer : 0, view.count, x, value, view.outer,
              view.count);
  return value;
}
}  // namespace detail

/// Softmax over the last axis.
inline Var softmax(const Var& x) {
  const detail::AxisView view = detail::last_axis("softmax", x.shape());
  const std::size_t n = view.count, rows = view.outer;
  Tensor value = detail::row_function("softmax_rows", x.value(), view);
  return record(
      "softmax", {x}, std::move(value),
      [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
        const Var y = detail::itself(self);
        return {y * (g - detail::broadcast_axis(sum(g * y, -1), rows, n, 1, 1, self.value.shape()))};
      });
}

/// Logarithm of the softmax over the last axis; finite even where the softmax underflows to 0.
inline Var log_softmax(const Var& x) {
  const detail::AxisView view = detail::last_axis("log_softmax", x.shape());
  const std::size_t n = view.count, rows = view.outer;
  Tensor value = detail::row_function("log_softmax_rows", x.value(), view);
  return record("log_softmax", {x}, std::move(value),
                [=](const Node& self, const Var& g, const Needs&) -> std::vector<Var> {
                  const Var p = exp(detail::itself(self));
                  return {g - p * detail::broadcast_axis(sum(g, -1), rows, n, 1, 1, self.value.shape())};
                });
}

}  // namespace motiongan
