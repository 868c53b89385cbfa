// Distances between the windows of a collection and hypotheses, computed on the device.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "motiongan/core/gemm.hpp"
#include "motiongan/core/rows.hpp"
#include "motiongan/search/distance.hpp"

namespace motiongan {

/// Distance at the best shift, and that shift in frames, of every window and hypothesis.
struct WindowDistances {
  std::size_t hypotheses = 0;
  std::vector<float> distance;      ///< [windows, hypotheses]
  std::vector<std::int32_t> shift;  ///< [windows, hypotheses]
};

/// Options of SearchWindows.
struct SearchWindowsOptions {
  std::size_t chunk = 0;                          ///< windows per batch; 0: as many as fit 16 MB of spectra
  std::size_t keep_bytes = std::size_t{1} << 30;  ///< keep spectra for later queries if they fit in this
};

/// The windows of a collection, prepared for queries on the device.
///
/// search_distance() needs, for every window, hypothesis and shift s, the sum over frames and dimensions of
/// window[t + s] hypothesis[t]: a cross-correlation, computed as a product of Fourier spectra. Windows are
/// zero-padded to N + N / 2 frames, so that no shift up to N / 2 wraps around. For N = 32 a pair costs 25
/// complex products per dimension instead of 1024 products of frames: a tenth of the arithmetic. Squares are
/// summed separately, and the few relative dimensions are multiplied shift by shift. Sums have a fixed order:
/// equal calls give equal bits, whatever the chunk. In float, a distance near 0 has an error of up to about
/// 1e-3, because it is the difference of large sums.
class SearchWindows {
 public:
  /// `frames` holds the frames of all clips and must outlive this object; `starts` are the first frames of
  /// the windows, as ascending indices into it. Throws Error if a window does not lie within the frames.
  SearchWindows(const Context& context, const motion::MotionFormat& format, const SearchFrames& frames,
                std::vector<std::size_t> starts, const SearchWindowsOptions& options = {})
      : context_(context),
        format_(format),
        layout_(format),
        frames_(&frames),
        starts_(std::move(starts)),
        length_(format.frames + search_reach(format.frames)),
        frequencies_(length_ / 2 + 1) {
    const std::size_t rows = frames.plain.size() / layout_.columns(), window_bytes = spectrum() * 4;
    for (std::size_t i = 0; i < starts_.size(); ++i)
      require(starts_[i] + format.frames <= rows && (i == 0 || starts_[i] >= starts_[i - 1]), "window ", i,
              " starts at frame ", starts_[i], " of ", rows, " and has ", format.frames,
              " frames; expected windows in ascending order that lie within the frames");
    chunk_ =
        options.chunk > 0 ? options.chunk : std::max<std::size_t>(1, (std::size_t{16} << 20) / window_bytes);
    keeps_ = starts_.size() * window_bytes <= options.keep_bytes;
    make_tables();
  }

  std::size_t size() const { return starts_.size(); }

  /// Distances to hypotheses, normalised poses [N, dof] each. Throws Error if there are none or one has
  /// another size.
  WindowDistances operator()(const std::vector<std::vector<float>>& hypotheses) const {
    require(!hypotheses.empty(), "a search needs at least one hypothesis");
    const Query query = prepare(hypotheses);
    WindowDistances out{hypotheses.size(), {}, {}};
    out.distance.resize(size() * hypotheses.size());
    out.shift.resize(out.distance.size());
    for (std::size_t first = 0, c = 0; first < size(); first += chunk_, ++c) {
      if (keeps_ && c == chunks_.size()) chunks_.push_back(load(first));
      score(keeps_ ? chunks_[c] : load(first), first, query, out);
    }
    return out;
  }

  /// Bytes of spectra kept on the device after the first query.
  std::size_t kept_bytes() const { return keeps_ ? starts_.size() * spectrum() * context_.real_size() : 0; }

 private:
  struct Chunk {
    std::size_t windows;
    Indices starts;
    Tensor spectra;  ///< [frequencies, windows, 2 columns]
    Tensor own;      ///< [windows, reach + 1, 4], squares over the overlap, turns
    Tensor track;    ///< [frames, track]
  };
  struct Query {
    std::size_t hypotheses, lanes;
    Tensor spectra;  ///< [frequencies, 2 columns, 2 lanes]
    Tensor squares;  ///< [reach + 1, 2, lanes]
    Tensor track;    ///< [reach + 1, frames, track, lanes], relative to frame s
    Tensor sums;     ///< [reach + 1, 2, track, lanes], of track over the overlap
  };

  std::size_t reach() const { return search_reach(format_.frames); }
  std::size_t spectrum() const { return frequencies_ * 2 * layout_.columns(); }

  double angle(std::size_t f, std::size_t t) const {
    return 2 * std::numbers::pi * static_cast<double>(f * t % length_) / static_cast<double>(length_);
  }

  void make_tables() {
    const std::size_t frames = format_.frames, groups = (frequencies_ + 3) / 4;
    std::vector<double> table(groups * frames * 8), turns((reach() + 1) * frequencies_ * 2);
    for (std::size_t f = 0; f < frequencies_; ++f) {
      for (std::size_t t = 0; t < frames; ++t) {
        table[(f / 4 * frames + t) * 8 + f % 4] = std::cos(angle(f, t));
        table[(f / 4 * frames + t) * 8 + 4 + f % 4] = -std::sin(angle(f, t));
      }
      for (std::size_t s = 0; s <= reach(); ++s) {
        turns[(s * frequencies_ + f) * 2] = std::cos(angle(f, s));
        turns[(s * frequencies_ + f) * 2 + 1] = std::sin(angle(f, s));
      }
    }
    table_ = Tensor::from(context_, {groups, frames, 8}, table);
    turns_ = Tensor::from(context_, {reach() + 1, frequencies_, 2}, turns);
  }

  /// Uploads the windows from `first` and computes their spectra.
  Chunk load(std::size_t first) const {
    const std::size_t count = std::min(chunk_, size() - first), columns = layout_.columns();
    const std::size_t dims = layout_.track.size(), row = starts_[first];
    const std::size_t rows = starts_[first + count - 1] + format_.frames - row;
    std::vector<cl_int> starts;
    for (std::size_t i = 0; i < count; ++i) starts.push_back(static_cast<cl_int>(starts_[first + i] - row));
    const auto part = [&](const std::vector<float>& of, std::size_t width) {
      return std::span<const float>(of).subspan(row * width, rows * width);
    };
    const Tensor plain = Tensor::from(context_, {rows, columns}, part(frames_->plain, columns));
    const Tensor squares(context_, {rows});
    Chunk chunk{count, Indices(context_, starts), Tensor(context_, {frequencies_, count, 2 * columns}),
                Tensor(context_, {count, reach() + 1, 4}), squares};
    if (dims > 0) chunk.track = Tensor::from(context_, {rows, dims}, part(frames_->track, dims));
    detail::launch_rows(context_, "squares_of_rows", rows, columns, plain, squares, rows, columns);
    const LaunchGrid overlaps =
        context_.wide() ? LaunchGrid::items(count * (reach() + 1)) : LaunchGrid::groups(count);
    context_.launch("search", "search_overlaps", overlaps, squares, chunk.track, chunk.starts, chunk.own,
                    count, format_.frames, reach(), dims, std::size_t{layout_.turned},
                    KernelReal{layout_.yaw_scale});
    const std::size_t pieces = (columns + context_.vector_width() - 1) / context_.vector_width();
    context_.launch("search", "search_spectra", LaunchGrid::items(count * pieces), plain, chunk.starts,
                    table_, chunk.spectra, count, format_.frames, columns, frequencies_);
    return chunk;
  }

  /// Prepares the hypotheses for the device. Lanes past the last hypothesis are zero.
  Query prepare(const std::vector<std::vector<float>>& hypotheses) const {
    const std::size_t frames = format_.frames, columns = layout_.columns(), dims = layout_.track.size();
    const std::size_t width = context_.vector_width();
    const std::size_t lanes = (hypotheses.size() + width - 1) / width * width;
    std::vector<double> spectra(spectrum() * 2 * lanes), squares((reach() + 1) * 2 * lanes);
    std::vector<double> track((reach() + 1) * frames * dims * lanes), sums((reach() + 1) * 2 * dims * lanes);
    std::vector<double> cosine(length_), sine(length_);
    for (std::size_t i = 0; i < length_; ++i)
      cosine[i] = std::cos(angle(1, i)), sine[i] = std::sin(angle(1, i));
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      require(hypotheses[h].size() == frames * format_.dof(), "hypothesis ", h, " has ", hypotheses[h].size(),
              " values, expected ", frames, " x ", format_.dof());
      SearchFrames split;
      split.add(layout_, hypotheses[h]);
      for (std::size_t f = 0; f < frequencies_; ++f) {
        // Inverse transform: all frequencies but 0 and, for an even length, the last represent a conjugate
        // pair.
        const bool once = f == 0 || 2 * f == length_;
        const double weight = (once ? 1.0 : 2.0) / static_cast<double>(length_);
        for (std::size_t k = 0; k < columns; ++k) {
          double real = 0, imaginary = 0;
          for (std::size_t t = 0, turn = 0; t < frames; ++t) {
            const double value = split.plain[t * columns + k];
            real += value * cosine[turn];
            imaginary -= value * sine[turn];
            turn = turn + f < length_ ? turn + f : turn + f - length_;
          }
          // Window times conjugate hypothesis: the rows are the window's real and imaginary parts.
          double* const at = &spectra[(f * 2 * columns + k) * 2 * lanes + h];
          at[0] = weight * real, at[lanes] = -weight * imaginary;
          at[columns * 2 * lanes] = weight * imaginary, at[columns * 2 * lanes + lanes] = weight * real;
        }
      }
      for (std::size_t s = 0; s <= reach(); ++s)
        for (const std::size_t early : {std::size_t{0}, std::size_t{1}}) {
          // At shift s the hypothesis's first N - s frames overlap, at -s those from frame s.
          const std::size_t from = early * s, at = s * 2 + early;
          const std::vector<float> part = split.window(format_, layout_, from, frames - s);
          for (const float value : part)
            squares[at * lanes + h] += static_cast<double>(value) * static_cast<double>(value);
          for (std::size_t t = 0; t < frames - s; ++t)
            for (std::size_t d = 0; d < dims; ++d) {
              const double value = part[t * format_.dof() + layout_.track[d]];
              sums[(at * dims + d) * lanes + h] += value;
              if (early == 1 || s == 0) track[((from * frames + t) * dims + d) * lanes + h] = value;
            }
        }
    }
    Query query{hypotheses.size(),
                lanes,
                Tensor::from(context_, {frequencies_, 2 * columns, 2 * lanes}, spectra),
                Tensor::from(context_, {reach() + 1, 2, lanes}, squares),
                {},
                {}};
    query.track =
        dims > 0 ? Tensor::from(context_, {reach() + 1, frames, dims, lanes}, track) : query.squares;
    query.sums = dims > 0 ? Tensor::from(context_, {reach() + 1, 2, dims, lanes}, sums) : query.squares;
    return query;
  }

  void score(const Chunk& chunk, std::size_t first, const Query& query, WindowDistances& out) const {
    const std::size_t lanes = query.lanes, columns = layout_.columns();
    const Tensor products(context_, {chunk.windows, frequencies_, 2, lanes});
    const Tensor nearest(context_, {chunk.windows, lanes}), shifts(context_, {chunk.windows, lanes});
    GemmCall product{.m = chunk.windows, .n = 2 * lanes, .k = 2 * columns};
    product.a = chunk.spectra, product.b = query.spectra, product.c = products;
    product.a_ld = 2 * columns, product.b_ld = 2 * lanes, product.c_ld = frequencies_ * 2 * lanes;
    product.batch = frequencies_;
    product.a_batch_stride = chunk.windows * 2 * columns, product.b_batch_stride = 2 * columns * 2 * lanes;
    product.c_batch_stride = 2 * lanes;
    gemm(context_, product);
    const std::size_t teams = chunk.windows * lanes / context_.vector_width();
    context_.launch("search", "search_nearest",
                    context_.wide() ? context_.groups(teams) : LaunchGrid::items(teams), products, chunk.own,
                    chunk.track, chunk.starts, turns_, query.squares, query.track, query.sums, nearest,
                    shifts, chunk.windows, format_.frames, frequencies_, reach(), lanes, format_.dof(),
                    layout_.track.size(), std::size_t{layout_.turned});
    const std::vector<float> distance = nearest.to_host<float>(), shift = shifts.to_host<float>();
    for (std::size_t w = 0; w < chunk.windows; ++w)
      for (std::size_t h = 0; h < query.hypotheses; ++h) {
        const std::size_t to = (first + w) * query.hypotheses + h;
        out.distance[to] = std::sqrt(distance[w * lanes + h]);
        out.shift[to] = static_cast<std::int32_t>(shift[w * lanes + h]);
      }
  }

  Context context_;
  motion::MotionFormat format_;
  SearchLayout layout_;
  const SearchFrames* frames_;
  std::vector<std::size_t> starts_;
  std::size_t length_, frequencies_, chunk_ = 0;
  bool keeps_ = false;
  Tensor table_, turns_;
  mutable std::vector<Chunk> chunks_;  ///< filled by the first query
};

}  // namespace motiongan
