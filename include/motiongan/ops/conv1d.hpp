// Convolution along time; a linear layer is the case of one tap.
//
//   y[t] = sum_s x[t + offset_s] * op(W_s),   frames outside x are zero
//
// In a time-major tensor [T, B, C], frame t is a block of B rows, so each term is one product over whole
// frames and no patches are copied (no im2col); two or three taps of neighbouring frames are computed with
// fewer products in Winograd's form. The operations are closed under differentiation: the gradient
// with respect to x is the same sum with negated offsets and the other op; that with respect to W is
// conv1d_weight, whose own gradients are convolutions again.
#pragma once
#include "motiongan/ops/conv1d_winograd.hpp"
#include "motiongan/ops/layout.hpp"

namespace motiongan {

namespace detail {

inline Tensor conv1d_value(const Tensor& x, const Tensor& w, const Offsets& offsets, std::size_t frames_out,
                           bool transposed, const Epilogue& epilogue) {
  const Convolution c{x, w, offsets, frames_out, transposed};
  Shape shape = x.shape();
  shape.front() = frames_out;
  shape.back() = c.out();
  Tensor y(x.context(), shape);
  TapPlan plan = plan_taps(c, ConvolutionPart::value);
  // The last pass over a frame finishes it: no epilogue if that is not the same pass for all frames.
  const auto covers_all = [&](const TapRun& run) {
    return run.frames.first == 0 && run.frames.last == frames_out;
  };
  if (!epilogue.empty() && !std::all_of(plan.runs.begin(), plan.runs.end(), covers_all)) plan.join();
  if (plan.runs.empty()) {
    conv1d_direct(c, plan.others, {0, frames_out}, epilogue, y);
    return y;
  }
  // First the other taps, except where there are none and the first run overwrites.
  const FrameRange& first = plan.runs.front().frames;
  bool accumulate = false;
  for (const TapRange& range : tap_ranges(offsets, plan.others, x.dim(0), first))
    accumulate = accumulate || !range.taps.empty();
  if (accumulate) {
    conv1d_direct(c, plan.others, {0, frames_out}, {}, y);
  } else {
    conv1d_direct(c, plan.others, {0, first.first}, {}, y);
    conv1d_direct(c, plan.others, {first.last, frames_out}, {}, y);
  }
  for (const TapRun& run : plan.runs) {
    conv1d_winograd(c, run, accumulate, &run == &plan.runs.back() ? epilogue : Epilogue(), y);
    accumulate = true;
  }
  return y;
}

/// W_s[i, j] = sum over frames t and rows of p[t, i] * q[t + offset_s, j]: [taps, P, Q].
inline Tensor conv1d_weight_value(const Tensor& p, const Tensor& q, const Offsets& offsets) {
  Tensor w(p.context(), {offsets.size(), p.shape().back(), q.shape().back()});
  const TapPlan plan = plan_taps({q, w, offsets, p.dim(0), false}, ConvolutionPart::weight_gradient);
  for (const TapRun& run : plan.runs) conv1d_weight_winograd(p, q, run, w);
  conv1d_weight_direct(p, q, offsets, plan.others, w);
  return w;
}

}  // namespace detail

inline Var conv1d_weight(const Var& p, const Var& q, const Offsets& offsets);

/// Optional bias, residual and ReLU after a convolution or a linear layer.
struct Conv1dEpilogue {
  Var bias = {};      ///< [out]
  Var residual = {};  ///< of the result's shape
  bool relu = false;  ///< set negative elements to 0 at last
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
