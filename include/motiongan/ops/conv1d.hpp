// Convolution along time as a sum of matrix products with shifted frames; a linear layer is the case of one
// tap.
//
//   y[t] = sum_s x[t + offset_s] * op(W_s),   frames outside x are zero
//
// In a time-major tensor [T, B, C], frame t is a block of B rows, so each term is one product over whole
// frames and no patches are copied (no im2col). The operations are closed under differentiation: the gradient
// with respect to x is the same sum with negated offsets and the other op; that with respect to W is
// conv1d_weight, whose own gradients are convolutions again.
#pragma once
#include "motiongan/core/gemm.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

/// Frame offset of every tap.
using Offsets = std::vector<int>;

inline Offsets operator-(Offsets offsets) {
  for (int& offset : offsets) offset = -offset;
  return offsets;
}

namespace detail {

/// A range of output frames [first, last) for which the same taps lie inside x.
struct TapRange {
  std::size_t first, last;
  std::vector<std::size_t> taps;
};

/// Splits the output frames 0 .. frames_out - 1 wherever a tap enters or leaves x.
inline std::vector<TapRange> tap_ranges(const Offsets& offsets, std::size_t frames_in,
                                        std::size_t frames_out) {
  const auto in = static_cast<long>(frames_in), out = static_cast<long>(frames_out);
  std::vector<long> bounds{0, out};
  for (int offset : offsets) {
    bounds.push_back(std::clamp(-static_cast<long>(offset), 0L, out));
    bounds.push_back(std::clamp(in - offset, 0L, out));
  }
  std::sort(bounds.begin(), bounds.end());
  std::vector<TapRange> ranges;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
    if (bounds[i] == bounds[i + 1]) continue;
    TapRange range{static_cast<std::size_t>(bounds[i]), static_cast<std::size_t>(bounds[i + 1]), {}};
    for (std::size_t s = 0; s < offsets.size(); ++s)
      if (bounds[i] + offsets[s] >= 0 && bounds[i] + offsets[s] < in) range.taps.push_back(s);
    ranges.push_back(std::move(range));
  }
  return ranges;
}

/// + bias + residual, then ReLU.
struct Epilogue {
  Tensor bias, residual;
  bool relu = false;
};

/// The weights of all taps packed by pack_b(), [taps * panels, in, columns]; empty if packing costs more than
/// it saves. `call` holds what is the same for all ranges.
inline Tensor pack_taps(const Context& context, GemmCall call, std::size_t taps_count, std::size_t tap_size,
                        std::size_t rows) {
  const std::size_t columns = 2 * context.vector_width(), last = call.n % columns;
  // A packed panel is always multiplied at full width.
  const bool narrow = last > 0 && last <= columns / 2 && call.n < 4 * columns;
  if (rows < 256 || taps_count == 0 || taps_count > 4 || call.k < 16 || call.n == 0 || narrow) return {};
  if (call.b_transposed && last == 0) {  // the panels of the taps are consecutive
    call.n *= taps_count;
    return pack_b(context, call);
  }
  call.segments = taps_count;
  for (std::size_t s = 0; s < taps_count; ++s) call.b_offset[s] = s * tap_size;
  return pack_b(context, call);
}

/// Rows of one frame: the product of all axes but the first and the last.
inline std::size_t frame_rows(const Tensor& x) {
  return element_count({x.shape().begin() + 1, x.shape().end() - 1});
}

inline Tensor conv1d_value(const Tensor& x, const Tensor& w, const Offsets& offsets, std::size_t frames_out,
                           bool transposed, const Epilogue& epilogue) {
  const std::size_t frames_in = x.dim(0), in = x.shape().back(), rows = frame_rows(x);
  const std::size_t out = transposed ? w.dim(2) : w.dim(1), tap_size = w.dim(1) * w.dim(2);
  Shape shape = x.shape();
  shape.front() = frames_out;
  shape.back() = out;
  Tensor y(x.context(), shape);
  constexpr std::size_t most = 4;  // segments per gemm() call
  GemmCall weights{.n = out, .k = in, .b = w};
  weights.b_ld = w.dim(2), weights.b_transposed = !transposed;
  const Tensor packed = pack_taps(x.context(), weights, offsets.size(), tap_size, frames_out * rows);
  const std::size_t packed_size = packed.empty() ? 0 : packed.size() / offsets.size();
  for (const TapRange& range : tap_ranges(offsets, frames_in, frames_out)) {
    std::size_t done = 0;
    do {
      GemmCall call;
      call.segments = std::min(most, range.taps.size() - done);
      call.m = (range.last - range.first) * rows;
      call.n = out;
      call.k = call.segments == 0 ? 0 : in;
      call.a = x;
      call.b = w;
      call.c = y;
      call.a_ld = in;
      call.b_ld = w.dim(2);
      call.c_ld = out;
      call.b_transposed = !transposed;
      for (std::size_t i = 0; i < call.segments; ++i) {
        const std::size_t tap = range.taps[done + i];
        call.a_offset[i] =
            static_cast<std::size_t>(static_cast<long>(range.first) + offsets[tap]) * rows * in;
        call.b_offset[i] = tap * tap_size;
      }
      const std::size_t first_tap = call.segments == 0 ? 0 : range.taps[done];
      if (!packed.empty() && call.segments > 0 &&
          range.taps[done + call.segments - 1] - first_tap + 1 == call.segments)
        call.b_panels = packed.view(first_tap * packed_size, {call.segments * packed_size});
      call.segments = std::max<std::size_t>(call.segments, 1);
      call.c_offset = range.first * rows * out;
      call.accumulate = done > 0;
      done += call.segments;
      if (done >= range.taps.size()) {
        call.bias = epilogue.bias;
        call.residual = epilogue.residual;
        call.residual_offset = call.c_offset;
        call.residual_ld = out;
        call.relu = epilogue.relu;
      }
      gemm(x.context(), call);
    } while (done < range.taps.size());
  }
  return y;
}

/// W_s[i, j] = sum over frames t and rows of p[t, i] * q[t + offset_s, j]: [taps, P, Q].
inline Tensor conv1d_weight_value(const Tensor& p, const Tensor& q, const Offsets& offsets) {
  const std::size_t p_frames = p.dim(0), q_frames = q.dim(0), m = p.shape().back(), n = q.shape().back(),
                    rows = frame_rows(p);
  Tensor w(p.context(), {offsets.size(), m, n});
  for (std::size_t s = 0; s < offsets.size(); ++s) {
    const long first = std::max(0L, -static_cast<long>(offsets[s]));
    const long last = std::min(static_cast<long>(p_frames), static_cast<long>(q_frames) - offsets[s]);
    const std::size_t frames = last > first ? static_cast<std::size_t>(last - first) : 0;
    GemmCall call;
    call.m = m;
    call.n = n;
    call.k = frames * rows;
    call.a = p;
    call.b = q;
    call.c = w;
    call.a_ld = m;
    call.b_ld = call.c_ld = n;
    call.a_transposed = true;
    if (frames > 0) {
      call.a_offset[0] = static_cast<std::size_t>(first) * rows * m;
      call.b_offset[0] = static_cast<std::size_t>(first + offsets[s]) * rows * n;
    }
    call.c_offset = s * m * n;
    gemm(p.context(), call);
  }
  return w;
}

}  // namespace detail

inline Var conv1d_weight(const Var& p, const Var& q, const Offsets& offsets);

/// Optional bias, residual and ReLU after a convolution or a linear layer.
struct Conv1dEpilogue {
  Var bias = {};      ///< [out]
  Var residual = {};  ///< of the result's shape
  bool relu = false;
};

/// y[t] = sum_s x[t + offset_s] * op(W_s) + bias + residual, then ReLU if extras.relu. x is [T, ..., in]; W
/// is [taps, out, in] (op transposes) or, with `transposed`, [taps, in, out]; y is [frames_out, ..., out].
/// Throws Error if the weights do not fit the taps or the input. Frames before or after x count as zero.
inline Var conv1d(const Var& x, const Var& w, const Offsets& offsets, std::size_t frames_out,
                  bool transposed = false, const Conv1dEpilogue& extras = {}) {
  require(w.value().rank() == 3 && w.dim(0) == offsets.size(), "conv1d: weights ", w.shape(), " for ",
          offsets.size(), " taps");
  require(x.value().rank() >= 2 && x.shape().back() == w.dim(transposed ? 1 : 2), "conv1d: input ", x.shape(),
          " does not fit weights ", w.shape());
  detail::Epilogue epilogue;
  if (!extras.bias.empty()) epilogue.bias = extras.bias.value();
  if (!extras.residual.empty()) epilogue.residual = extras.residual.value();
  epilogue.relu = extras.relu;
  Tensor y = detail::conv1d_value(x.value(), w.value(), offsets, frames_out, transposed, epilogue);
  const bool relu = extras.relu;
  return record("conv1d", {x, w, extras.bias, extras.residual}, std::move(y),
                [=](const Node& self, const Var& g, const Needs& needs) -> std::vector<Var> {
                  const Var &xi = self.inputs[0], &wi = self.inputs[1];
                  const Var masked = relu ? detail::leaky_relu_grad(g, self.value, 0) : g;
                  Var by_x, by_w, by_bias;
                  if (needs[0]) by_x = conv1d(masked, wi, -offsets, xi.dim(0), !transposed);
                  if (needs[1])
                    by_w =
                        transposed ? conv1d_weight(xi, masked, -offsets) : conv1d_weight(masked, xi, offsets);
                  if (needs[2])
                    by_bias = detail::sum_axis(masked, 1, detail::last_axis("conv1d", masked.shape()).outer,
                                               masked.shape().back(), 1, self.inputs[2].shape());
                  return {by_x, by_w, by_bias, masked};
                });
}

/// x W^T + bias + residual on the last axis, then ReLU if epilogue.relu: [..., in] -> [..., out]. `w` is
/// [out, in] or, from a convolution with one tap, [1, out, in].
inline Var linear(const Var& x, const Var& w, const Conv1dEpilogue& epilogue = {}) {
  require(x.value().rank() >= 2, "linear: input ", x.shape(), ", expected rows [..., in]");
  const Var one_tap = w.value().rank() == 2 ? reshape(w, {1, w.dim(0), w.dim(1)}) : w;
  return conv1d(x, one_tap, {0}, x.dim(0), false, epilogue);
}

/// W_s[i, j] = sum over frames t and rows of p[t, i] * q[t + offset_s, j], the gradient of conv1d with
/// respect to its weights: [T, ..., P], [T', ..., Q] -> [taps, P, Q].
inline Var conv1d_weight(const Var& p, const Var& q, const Offsets& offsets) {
  require(p.value().rank() >= 2 && q.value().rank() >= 2 &&
              detail::frame_rows(p.value()) == detail::frame_rows(q.value()),
          "conv1d_weight: shapes ", p.shape(), " and ", q.shape(), ", expected as many rows in each frame");
  return record("conv1d_weight", {p, q}, detail::conv1d_weight_value(p.value(), q.value(), offsets),
                [offsets](const Node& self, const Var& u, const Needs& needs) -> std::vector<Var> {
                  const Var &pi = self.inputs[0], &qi = self.inputs[1];
                  return {needs[0] ? conv1d(qi, u, offsets, pi.dim(0)) : Var(),
                          needs[1] ? conv1d(pi, u, -offsets, qi.dim(0), true) : Var()};
                });
}

}  // namespace motiongan
