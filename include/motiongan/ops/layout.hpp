// Differentiable slicing, padding, concatenation, and gathering and shifting of rows and frames.
#pragma once
#include "motiongan/ops/reduce.hpp"

namespace motiongan {

namespace detail {

/// Copies `run` elements of each of `outer` blocks (starting at `first`, `stride` apart) from x to out.
inline void copy_runs(const Tensor& x, std::size_t x_first, std::size_t x_stride, const Tensor& out,
                      std::size_t out_first, std::size_t out_stride, std::size_t outer, std::size_t run) {
  if (outer == 0 || run == 0) return;
  const Context& context = x.context();
  context.launch("layout", "copy_runs", LaunchGrid::items(outer * vectors(context, run)),
                 At{x, x_first, outer * run}, x_stride, At{out, out_first, outer * run}, out_stride, outer,
                 run);
}

/// Mirrors struct Parts in cl/layout.cl, field by field.
struct CopyNumbers {
  static constexpr std::size_t most = 8;
  std::array<cl_uint, most> x{}, at{}, run{}, item{};
  cl_uint count = 0, items = 0;
  std::string describe() const { return concat("{", count, " parts, ", items, " vectors}"); }
};
inline void add_argument(KernelArguments& to, const CopyNumbers& numbers) { to.set(numbers); }

/// A tensor to be copied to element `at` of another one.
struct CopyPart {
  Tensor from;
  std::size_t at;
};

/// Copies parts, each [outer, any size], to rows of `out` that are `stride` apart. A launch copies eight.
inline void copy_parts(std::span<const CopyPart> parts, const Tensor& out, std::size_t outer,
                       std::size_t stride) {
  const Context& context = out.context();
  const auto narrow = [](std::size_t value) { return static_cast<cl_uint>(value); };
  for (std::size_t first = 0; first < parts.size() && outer > 0; first += CopyNumbers::most) {
    CopyNumbers numbers;
    std::array<cl_mem, CopyNumbers::most> buffers{};
    std::size_t copied = 0;
    buffers.fill(parts[first].from.buffer());
    for (const CopyPart& part : parts.subspan(first, std::min(CopyNumbers::most, parts.size() - first))) {
      const std::size_t run = part.from.size() / outer, i = numbers.count;
      if (run == 0) continue;
      numbers.x[i] = narrow(part.from.offset()), numbers.at[i] = narrow(part.at);
      numbers.run[i] = narrow(run), numbers.item[i] = numbers.items;
      numbers.items += narrow(vectors(context, run));
      copied += part.from.size();
      buffers[numbers.count++] = part.from.buffer();
    }
    context.launch("layout", "copy_parts", LaunchGrid::items(outer * numbers.items), buffers[0], buffers[1],
                   buffers[2], buffers[3], buffers[4], buffers[5], buffers[6], buffers[7], At{out, 0, copied},
                   numbers, stride, outer);
    context.count_bytes(static_cast<double>(copied * context.real_size()));  // of the parts
  }
}

/// Copies x to `to`, which has the same size.
inline void copy_tensor(const Tensor& x, const Tensor& to) { copy_runs(x, 0, 0, to, 0, 0, 1, x.size()); }

/// Throws Error for more frames than an int of a kernel can count.
inline void check_frames(const char* operation, std::size_t frames) {
  require(frames < std::numeric_limits<cl_int>::max(), operation, ": ", frames,
          " frames, kernels count up to ", std::numeric_limits<cl_int>::max() - 1, "; use fewer frames");
}

}  // namespace detail

inline Var pad(const Var& x, std::size_t axis, std::size_t before, std::size_t after);

/// Entries first .. first + count - 1 of an axis; a view of the same data for the first axis. Throws Error if
/// they exceed the axis.
inline Var slice(const Var& x, std::size_t axis, std::size_t first, std::size_t count) {
  const detail::AxisView view("slice", x.shape(), axis);
  require(first <= view.count && count <= view.count - first, "slice: ", count, " entries from ", first,
          " of axis ", axis, " of ", x.shape());
  Shape shape = x.shape();
  shape[axis] = count;
  Tensor value;
  if (view.outer == 1) {  // contiguous: no copy
    value = x.value().view(first * view.inner, shape);
  } else {
    value = Tensor(x.context(), shape);
    detail::copy_runs(x.value(), first * view.inner, view.count * view.inner, value, 0, count * view.inner,
                      view.outer, count * view.inner);
  }
  return record("slice", {x}, std::move(value),
                [=, total = view.count](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {pad(g, axis, first, total - first - count)};
                });
}

/// Zero padding along an axis: `before` entries in front and `after` at the end.
inline Var pad(const Var& x, std::size_t axis, std::size_t before, std::size_t after) {
  if (before == 0 && after == 0) return x;
  const detail::AxisView view("pad", x.shape(), axis);
  Shape shape = x.shape();
  require(!__builtin_add_overflow(shape[axis], before, &shape[axis]) &&
              !__builtin_add_overflow(shape[axis], after, &shape[axis]),
          "pad: ", before, " and ", after, " entries around axis ", axis, " of ", x.shape(), " are too many");
  const std::size_t run = view.count * view.inner, out_run = shape[axis] * view.inner;
  Tensor value(x.context(), shape);
  x.context().launch("layout", "pad_runs",
                     LaunchGrid::items(view.outer * detail::vectors(x.context(), out_run)), x.value(), value,
                     view.outer, run, out_run, before * view.inner);
  return record("pad", {x}, std::move(value),
                [=, count = view.count](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {slice(g, axis, before, count)};
                });
}

/// Concatenates tensors along an axis. Throws Error if there are none or the other axes differ in size.
inline Var concatenate(const std::vector<Var>& parts, std::size_t axis) {
  require(!parts.empty(), "concatenate: no tensors given, expected at least one");
  Shape shape = parts[0].shape();
  require(axis < shape.size(), "concatenate: shape ", shape, " has no axis ", axis);
  shape[axis] = 0;
  for (const Var& part : parts) {
    Shape rest = part.shape();
    require(rest.size() == shape.size(), "concatenate: ranks differ");
    shape[axis] += rest[axis];
    rest[axis] = shape[axis];
    require(rest == shape, "concatenate: ", part.shape(), " does not fit the others along axis ", axis);
  }
  Tensor value(parts[0].context(), shape);
  const detail::AxisView whole("concatenate", shape, axis);
  std::vector<detail::CopyPart> copies;
  std::size_t first = 0;
  for (const Var& part : parts) {
    copies.push_back({part.value(), first * whole.inner});
    first += part.dim(axis);
  }
  detail::copy_parts(copies, value, whole.outer, whole.count * whole.inner);
  return record("concat", parts, std::move(value),
                [axis](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  std::vector<Var> gradients;
                  std::size_t at = 0;
                  for (std::size_t i = 0; i < self.inputs.size(); ++i) {
                    const std::size_t count = self.inputs[i].dim(axis);
                    gradients.push_back(needs[i] ? slice(g, axis, at, count) : Var());
                    at += count;
                  }
                  return gradients;
                });
}

/// Parameters of shift_frames(): out[t, b, :] = x[t + first + sign*offset[b], b, :], or `outside` if there is
/// no such frame.
struct FrameShift {
  int first = 0, sign = 1;
  double outside = 0;  ///< value of frames that do not exist
};

/// Shifts each sample's frames by its own offset: x [T, B, C], offset [B] -> [frames_out, B, C]. Used for
/// DVGAN's input shift and final cut (Lin & Amer, sec. 4). Throws Error unless there is one offset per
/// sample, or if a frame number does not fit an int.
inline Var shift_frames(const Var& x, const Indices& offset, std::size_t frames_out,
                        const FrameShift& shift = {}) {
  require(x.value().rank() == 3 && offset.size() == x.dim(1), "shift_frames: ", offset.size(),
          " offsets for motion ", x.shape());
  const std::size_t frames_in = x.dim(0), batch = x.dim(1), channels = x.dim(2);
  detail::check_frames("shift_frames", frames_in);
  detail::check_frames("shift_frames", frames_out);
  const long long room = std::numeric_limits<cl_int>::max() - static_cast<long long>(frames_out) -
                         std::abs(static_cast<long long>(shift.first));
  offset.check_range("shift_frames", -room, room);
  Tensor value(x.context(), {frames_out, batch, channels});
  x.context().launch("layout", "shift_frames",
                     LaunchGrid::items(frames_out * batch * detail::vectors(x.context(), channels)),
                     x.value(), offset, value, frames_in, frames_out, batch, channels,
                     static_cast<cl_int>(shift.first), static_cast<cl_int>(shift.sign),
                     KernelReal{shift.outside});
  return record("shift_frames", {x}, std::move(value),
                [=](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {shift_frames(g, offset, frames_in, {.first = -shift.first, .sign = -shift.sign})};
                });
}

inline Var pair_means_adjoint(const Var& g, std::size_t frames);

/// Means of neighbouring frames, first the odd pairs (2t-1, 2t), t = 0 .. T/2, then the even pairs (2t,
/// 2t+1), t < T/2, with zero for frames outside: [T, B, C] -> [2*(T/2)+1, B, C]. The even pairs are DVGAN's
/// `Down`; conv_down needs both.
inline Var pair_means(const Var& x) {
  const std::size_t slab = detail::frame_size("pair_means", x), frames = x.dim(0);
  detail::check_frames("pair_means", frames);
  Shape shape = x.shape();
  shape[0] = 2 * (frames / 2) + 1;
  Tensor value(x.context(), shape);
  x.context().launch("layout", "pair_means", LaunchGrid::items(shape[0] * detail::vectors(x.context(), slab)),
                     x.value(), value, frames, slab);
  return record("pair_means", {x}, std::move(value),
                [frames](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {pair_means_adjoint(g, frames)};
                });
}

/// The adjoint of pair_means: [2*(T/2)+1, B, C] -> [T, B, C] with T = `frames`. Throws Error for another
/// number of pairs.
inline Var pair_means_adjoint(const Var& g, std::size_t frames) {
  Shape shape = g.shape();
  const std::size_t slab = detail::frame_size("pair_means_adjoint", g);
  detail::check_frames("pair_means_adjoint", frames);
  require(shape[0] == 2 * (frames / 2) + 1, "pair_means_adjoint: pairs ", shape, " of ", frames,
          " frames, expected ", 2 * (frames / 2) + 1);
  shape[0] = frames;
  Tensor value(g.context(), shape);
  g.context().launch("layout", "pair_means_adjoint",
                     LaunchGrid::items(frames * detail::vectors(g.context(), slab)), g.value(), value, frames,
                     slab);
  return record("pair_means_adjoint", {g}, std::move(value),
                [](const Node&, const Var& u, const Needs&) -> std::vector<Var> { return {pair_means(u)}; });
}

inline Var scatter_add_rows(const Var& x, const Indices& index, std::size_t rows);

/// Rows of a table by index: [V, C], n indices -> [n, C]. Throws Error for an index outside of
/// 0 .. V - 1.
inline Var gather_rows(const Var& table, const Indices& index) {
  require(table.value().rank() == 2, "gather_rows: a table ", table.shape(), ", expected [rows, channels]");
  const std::size_t rows = table.dim(0), channels = table.dim(1);
  index.check_range("gather_rows", 0, static_cast<long long>(rows) - 1);
  Tensor value(table.context(), {index.size(), channels});
  table.context().launch("layout", "gather_rows",
                         LaunchGrid::items(index.size() * detail::vectors(table.context(), channels)),
                         table.value(), index, value, index.size(), channels);
  return record("gather_rows", {table}, std::move(value),
                [=](const Node&, const Var& g, const Needs&) -> std::vector<Var> {
                  return {scatter_add_rows(g, index, rows)};
                });
}

/// The adjoint of gather_rows: sums rows with the same index, in order, so that reruns are bit-equal. [n, C]
/// -> [rows, C]. Throws Error unless there is one index per row of x, in 0 .. rows - 1.
inline Var scatter_add_rows(const Var& x, const Indices& index, std::size_t rows) {
  require(x.value().rank() == 2 && x.dim(0) == index.size(), "scatter_add_rows: ", index.size(),
          " indices for rows ", x.shape());
  index.check_range("scatter_add_rows", 0, static_cast<long long>(rows) - 1);
  const std::size_t channels = x.dim(1);
  Tensor value(x.context(), {rows, channels});
  x.context().launch("layout", "scatter_add_rows",
                     LaunchGrid::items(rows * detail::vectors(x.context(), channels)), x.value(), index,
                     value, x.dim(0), rows, channels);
  return record(
      "scatter_add_rows", {x}, std::move(value),
      [=](const Node&, const Var& g, const Needs&) -> std::vector<Var> { return {gather_rows(g, index)}; });
}

}  // namespace motiongan
