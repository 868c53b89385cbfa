// Which taps of a convolution are computed in Winograd's form, and how: three launches for a value, three and
// a batch of products for the gradient of the weights.
#pragma once
#include "motiongan/ops/conv1d_direct.hpp"
#include "motiongan/ops/winograd.hpp"

namespace motiongan::detail {

/// Two or three taps that read neighbouring frames.
struct TapRun {
  Taps taps;                 ///< by ascending offset; their indices are equally far apart
  int offset;                ///< of the first of them
  FrameRange frames;         ///< the frames of y for which a tap lies inside x
  const WinogradForm* form;  ///< how they are computed
  std::size_t tiles() const { return form->tiles(frames.last - frames.first); }
};

/// The taps of a convolution, those to be computed in Winograd's form apart from the others.
struct TapPlan {
  std::vector<TapRun> runs;
  Taps others;

  /// Leaves no runs.
  void join() {
    for (const TapRun& run : runs) others.insert(others.end(), run.taps.begin(), run.taps.end());
    runs.clear();
    std::sort(others.begin(), others.end());
  }
};

/// What is computed of a convolution.
enum class ConvolutionPart { value, weight_gradient };

/// The cheapest form for the run, or none if it saves too few products.
inline const WinogradForm* choose_form(const TapRun& run, std::size_t frames_in, ConvolutionPart part) {
  std::size_t direct = 0;
  for (std::size_t i = 0; i < run.taps.size(); ++i) {
    const long offset = run.offset + static_cast<long>(i);
    const long first = std::max(static_cast<long>(run.frames.first), -offset),
               last = std::min(static_cast<long>(run.frames.last), static_cast<long>(frames_in) - offset);
    if (last > first) direct += static_cast<std::size_t>(last - first);
  }
  const WinogradForm* best = nullptr;
  // The rest goes to the transforms; those of the gradient's result do not shrink with the frames.
  double least = (part == ConvolutionPart::value ? 0.85 : 0.58) * static_cast<double>(direct);
  for (const WinogradForm& form : winograd_forms()) {
    const auto products = static_cast<double>(form.points * form.tiles(run.frames.last - run.frames.first));
    if (form.taps != run.taps.size() || products >= least) continue;
    least = products;
    best = &form;
  }
  return best;
}

/// The taps of c, for its value or its gradient by w. Neither the batch nor the values matter: a sample is
/// the same, bit for bit, alone and in any batch.
inline TapPlan plan_taps(const Convolution& c, ConvolutionPart part) {
  const Offsets& offsets = c.offsets;
  const std::size_t frames_in = c.x.dim(0), frames_out = c.frames_out;
  TapPlan plan;
  plan.others.resize(offsets.size());
  std::iota(plan.others.begin(), plan.others.end(), std::size_t{0});
  // With fewer channels, the transforms cost more than the products that they save (measured).
  const std::size_t enough_channels = part == ConvolutionPart::value ? 64 : 96;
  if (std::min(c.in(), c.out()) < enough_channels || frames_in == 0 || frames_out == 0 || c.rows() == 0 ||
      !packs_weights(c.x.context()))
    return plan;
  Taps order;
  order.swap(plan.others);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return offsets[a] < offsets[b]; });
  const auto neighbours = [&](std::size_t i) {  // that order[i] and order[i + 1] read neighbouring frames
    return i + 1 < order.size() && offsets[order[i + 1]] == offsets[order[i]] + 1;
  };
  for (std::size_t i = 0; i < order.size();) {
    std::size_t left = 1;
    while (neighbours(i + left - 1)) ++left;
    const std::size_t count = left == 4 ? 2 : std::min<std::size_t>(left, 3);
    TapRun run{{order.begin() + static_cast<long>(i), order.begin() + static_cast<long>(i + count)},
               offsets[order[i]],
               {},
               nullptr};
    const auto at = [&](long frame) {
      return static_cast<std::size_t>(std::clamp(frame, 0L, static_cast<long>(frames_out)));
    };
    run.frames = {at(1L - run.offset - static_cast<long>(count)),
                  at(static_cast<long>(frames_in) - run.offset)};
    const bool regular = count == 2 || (count == 3 && run.taps[1] - run.taps[0] == run.taps[2] - run.taps[1]);
    if (regular && run.frames.first < run.frames.last) run.form = choose_form(run, frames_in, part);
    if (run.form)
      plan.runs.push_back(std::move(run));
    else
      plan.others.insert(plan.others.end(), run.taps.begin(), run.taps.end());
    i += count;
  }
  std::sort(plan.others.begin(), plan.others.end());
  return plan;
}

/// The weights of `taps` at the form's points, packed: [points * panels, in, columns]. w is [taps, out, in]
/// or, with `transposed`, [taps, in, out].
inline Tensor winograd_weights(const Tensor& w, bool transposed, const Taps& taps, const WinogradForm& form) {
  const Context& context = w.context();
  const std::size_t out = w.dim(transposed ? 2 : 1), in = w.dim(transposed ? 1 : 2), ld = w.dim(2);
  const std::size_t columns = 2 * context.vector_width(), panels = (out + columns - 1) / columns;
  const auto index = [&](std::size_t i) { return taps[std::min(i, taps.size() - 1)]; };
  const auto tap = [&](std::size_t i) { return w.offset() + index(i) * w.dim(1) * ld; };
  constexpr std::size_t block = 64;  // PACK_BLOCK in cl/winograd.cl
  const PackKey key{2, out, in, transposed, form.frames, taps.size(), index(0), index(1), index(2)};
  return packed_once(w, key, [&] {
    Tensor u(context, {form.points * panels, in, columns});
    context.launch("winograd", "winograd_pack", LaunchGrid::groups(panels, (in + block - 1) / block),
                   w.buffer(), tap(0), tap(1), tap(2), taps.size(), transposed ? ld : 1, transposed ? 1 : ld,
                   out, in, form.weights, form.points, u);
    return u;
  });
}

/// The frames of x that the run reads, mixed: [points, tiles * rows of a frame, in]. x is [frames, rows, in].
inline Tensor winograd_frames(const Tensor& x, const TapRun& run) {
  const WinogradForm& form = *run.form;
  const std::size_t rows = frame_rows(x), in = x.shape().back();
  Tensor v(x.context(), {form.points, run.tiles() * rows, in});
  mix_frames(x, x.dim(0), rows * in,
             {form.input, form.points, form.points, run.tiles(), form.frames,
              static_cast<long>(run.frames.first) + run.offset},
             {v, 0});
  return v;
}

/// Computes the run's frames of y: overwrites or, with `accumulate`, adds.
inline void conv1d_winograd(const Convolution& c, const TapRun& run, bool accumulate,
                            const Epilogue& epilogue, const Tensor& y) {
  const std::size_t first = run.frames.first * c.rows() * c.out();
  winograd_multiply(winograd_frames(c.x, run), winograd_weights(c.w, c.transposed, run.taps, *run.form),
                    {.form = *run.form,
                     .frames = run.frames.last - run.frames.first,
                     .batch = c.rows(),
                     .out = c.out(),
                     .accumulate = accumulate,
                     .bias = epilogue.bias,
                     .residual = epilogue.residual,
                     .residual_offset = first,
                     .relu = epilogue.relu},
                    {y, first});
}

/// Writes W_s as conv1d_weight_direct() does, for the taps of the run; sets the weights between them to 0.
inline void conv1d_weight_winograd(const Tensor& p, const Tensor& q, const TapRun& run, const Tensor& w) {
  const Context& context = p.context();
  const WinogradForm& form = *run.form;
  const std::size_t m = p.shape().back(), n = q.shape().back(), batch = frame_rows(p), tiles = run.tiles(),
                    rows = tiles * batch;
  const Tensor pv(context, {form.points, rows, m}), qv = winograd_frames(q, run),
                                                    products(context, {form.points, m, n});
  const MixMatrix of_p = form.output.transposed(), of_weights = form.weights.transposed();
  mix_frames(p, p.dim(0), batch * m,
             {of_p, form.points, form.frames, tiles, form.frames, static_cast<long>(run.frames.first)},
             {pv, 0});
  GemmCall call{.m = m, .n = n, .k = rows, .a = pv, .b = qv, .c = products};
  call.a_ld = m, call.b_ld = call.c_ld = n;
  call.a_transposed = true;
  call.batch = form.points;
  call.a_batch_stride = rows * m, call.b_batch_stride = rows * n, call.c_batch_stride = m * n;
  gemm(context, call);
  // The taps ascend or descend with their offsets.
  const bool ascending = run.taps.front() < run.taps.back();
  const std::size_t lowest = ascending ? run.taps.front() : run.taps.back(), count = run.taps.size();
  MixMatrix back;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t a = 0; a < form.points; ++a) back(i, a) = of_weights(ascending ? i : count - 1 - i, a);
  mix_frames(products, form.points, m * n,
             {.matrix = back,
              .points = count,
              .width = form.points,
              .tiles = 1,
              .step = (run.taps.front() + run.taps.back() - 2 * lowest) / (count - 1)},
             {w, lowest * m * n});
}

}  // namespace motiongan::detail
