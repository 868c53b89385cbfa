// Convolution along time as a sum of matrix products with shifted frames, and its gradient with respect to
// the weights: one product per tap.
#pragma once
#include <algorithm>
#include <numeric>
#include <vector>

#include "motiongan/core/gemm.hpp"

namespace motiongan {

/// Frame offset of every tap.
using Offsets = std::vector<int>;

/// The opposite offsets: a convolution with them is the gradient with respect to the input.
inline Offsets operator-(Offsets offsets) {
  for (int& offset : offsets) offset = -offset;
  return offsets;
}

namespace detail {

/// Indices of taps, in the order of the weights.
using Taps = std::vector<std::size_t>;

/// Rows of one frame: the product of all axes but the first and the last.
inline std::size_t frame_rows(const Tensor& x) {
  std::size_t rows = 1;
  for (std::size_t i = 1; i + 1 < x.rank(); ++i) rows *= x.dim(i);
  return rows;
}

/// y[t] = sum_s x[t + offset_s] * op(W_s) for t < frames_out; see conv1d().
struct Convolution {
  const Tensor &x, &w;
  const Offsets& offsets;
  std::size_t frames_out;
  bool transposed;

  std::size_t in() const { return x.shape().back(); }
  std::size_t out() const { return w.dim(transposed ? 2 : 1); }
  std::size_t rows() const { return frame_rows(x); }
  std::size_t tap_size() const { return w.dim(1) * w.dim(2); }
};

/// + bias + residual, then ReLU.
struct Epilogue {
  Tensor bias, residual;
  bool relu = false;
  bool empty() const { return bias.empty() && residual.empty() && !relu; }
};

/// Frames [first, last) of a result.
struct FrameRange {
  std::size_t first, last;
};

/// A range of output frames for which the same taps lie inside x.
struct TapRange {
  FrameRange frames;
  Taps taps;
};

/// Splits output frames wherever one of `taps` enters or leaves the frames of x.
inline std::vector<TapRange> tap_ranges(const Offsets& offsets, const Taps& taps, std::size_t frames_in,
                                        const FrameRange& frames) {
  const auto in = static_cast<long>(frames_in), first = static_cast<long>(frames.first),
             last = static_cast<long>(frames.last);
  std::vector<long> bounds{first, last};
  for (std::size_t s : taps) {
    bounds.push_back(std::clamp(-static_cast<long>(offsets[s]), first, last));
    bounds.push_back(std::clamp(in - offsets[s], first, last));
  }
  std::sort(bounds.begin(), bounds.end());
  std::vector<TapRange> ranges;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
    if (bounds[i] == bounds[i + 1]) continue;
    TapRange range{{static_cast<std::size_t>(bounds[i]), static_cast<std::size_t>(bounds[i + 1])}, {}};
    for (std::size_t s : taps)
      if (bounds[i] + offsets[s] >= 0 && bounds[i] + offsets[s] < in) range.taps.push_back(s);
    ranges.push_back(std::move(range));
  }
  return ranges;
}

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

/// Computes frames of y from `taps`, without those that lie outside of x.
inline void conv1d_direct(const Convolution& c, const Taps& taps, const FrameRange& frames,
                          const Epilogue& epilogue, const Tensor& y) {
  const Context& context = c.x.context();
  const std::size_t in = c.in(), out = c.out(), rows = c.rows(), tap_size = c.tap_size();
  constexpr std::size_t most = 4;  // segments per gemm() call
  GemmCall weights{.n = out, .k = in, .b = c.w};
  weights.b_ld = c.w.dim(2), weights.b_transposed = !c.transposed;
  const bool all = taps.size() == c.offsets.size();
  const Tensor packed =
      all ? pack_taps(context, weights, taps.size(), tap_size, c.frames_out * rows) : Tensor();
  const std::size_t packed_size = packed.empty() ? 0 : packed.size() / taps.size();
  for (const TapRange& range : tap_ranges(c.offsets, taps, c.x.dim(0), frames)) {
    std::size_t done = 0;
    do {
      GemmCall call = weights;
      call.segments = std::min(most, range.taps.size() - done);
      call.m = (range.frames.last - range.frames.first) * rows;
      call.k = call.segments == 0 ? 0 : in;
      call.a = c.x;
      call.c = y;
      call.a_ld = in;
      call.c_ld = out;
      for (std::size_t i = 0; i < call.segments; ++i) {
        const std::size_t tap = range.taps[done + i];
        call.a_offset[i] =
            static_cast<std::size_t>(static_cast<long>(range.frames.first) + c.offsets[tap]) * rows * in;
        call.b_offset[i] = tap * tap_size;
      }
      const std::size_t first_tap = call.segments == 0 ? 0 : range.taps[done];
      if (!packed.empty() && call.segments > 0 &&
          range.taps[done + call.segments - 1] - first_tap + 1 == call.segments)
        call.b_panels = packed.view(first_tap * packed_size, {call.segments * packed_size});
      call.segments = std::max<std::size_t>(call.segments, 1);
      call.c_offset = range.frames.first * rows * out;
      call.accumulate = done > 0;
      done += call.segments;
      if (done >= range.taps.size()) {
        call.bias = epilogue.bias;
        call.residual = epilogue.residual;
        call.residual_offset = call.c_offset;
        call.residual_ld = out;
        call.relu = epilogue.relu;
      }
      gemm(context, call);
    } while (done < range.taps.size());
  }
}

/// Writes W_s[i, j] = sum over frames t and rows of p[t, i] * q[t + offset_s, j] into w [taps, P, Q] for each
/// of `taps`.
inline void conv1d_weight_direct(const Tensor& p, const Tensor& q, const Offsets& offsets, const Taps& taps,
                                 const Tensor& w) {
  const std::size_t p_frames = p.dim(0), q_frames = q.dim(0), m = p.shape().back(), n = q.shape().back(),
                    rows = frame_rows(p);
  for (std::size_t s : taps) {
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
}

}  // namespace detail
}  // namespace motiongan
