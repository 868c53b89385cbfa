// Streaming generation: many motions of one RNN generator, frame by frame.
#pragma once
#include <map>

#include "motiongan/networks/rnn_generator.hpp"

namespace motiongan {

/// The text and noise of a motion in a stream. The noise depends on seed and sample only.
struct StreamStart {
  std::vector<int> sentence;  ///< word indices
  std::uint64_t seed = 1;     ///< seed of the noise
  std::uint32_t sample = 0;   ///< selects the noise within a seed
};

/// Identifies a motion while it is in the stream.
using StreamId = std::size_t;

/// Holds the states of any number of motions on the device and advances them together. A motion does not
/// depend on the others in the stream, bit for bit with gemm()'s native engine, and its frames are those that
/// the generator makes in one call for the same noise, without a prior from frame RnnGenerator::warm_up() on.
///
/// step() allocates nothing once the stream has made that number of frames for that number of motions. The
/// weights are read at construction: make a new stream after a training step. They are kept in 16 bits if
/// RnnGenerator::bfloat16() rounded them.
class RnnStream {
 public:
  explicit RnnStream(const RnnGenerator& generator)
      : generator_(generator), context_(generator.decode().weight.context()) {
    const NoGrad values_only;
    folded_ = generator.fold();
    layers_ = detail::RolloutLayers(context_, folded_.rollout, generator.in_16_bits());
    k_ = generator.options().hidden;
    dof_ = generator.options().dof;
  }

  /// Motions in the stream.
  std::size_t size() const { return ids_.size(); }
  std::size_t dof() const { return dof_; }

  /// Adds motions, with or without a prior. `prior` is [prior_frames, n, dof], normalised, with n either the
  /// number of motions or 1 (shared by all). The next step returns their first frame (that after the warm-up,
  /// which is made here), or the frame that follows the prior. Throws Error for a prior of another size or an
  /// empty sentence.
  std::vector<StreamId> add(const std::vector<StreamStart>& starts, std::span<const float> prior = {},
                            std::size_t prior_frames = 0) {
    const NoGrad values_only;
    const std::size_t count = starts.size(), before = size();
    if (count == 0) return {};
    require(prior.size() == prior_frames * dof_ || prior.size() == prior_frames * count * dof_, "a prior of ",
            prior_frames, " frames has ", prior.size(), " values, expected ", prior_frames * dof_, " or ",
            prior_frames * count * dof_);
    std::vector<std::vector<int>> sentences;
    for (const StreamStart& start : starts) sentences.push_back(start.sentence);
    const Tensor h_txt = encode(sentences);
    std::vector<cl_int> keys;
    for (const StreamStart& start : starts) append_key(keys, start, 0);
    const std::size_t passed = prior_frames > 0 ? prior_frames : generator_.warm_up();
    const Tensor z(context_, {passed + 1, count, k_});
    fill_normal_each(z, RandomStream::noise, 0, Indices(context_, keys));
    reserve(before + count);
    detail::copy_runs(h_txt, 0, k_, h_txt_, before * k_, k_, count, k_);
    const Var text = Var::constant(h_txt), noise = Var::constant(z);
    const Tensor given = prior_frames > 0 ? repeated(prior, prior_frames, count)
                                          : generator_.first_pose(text, slice(noise, 0, 0, 1)).value();
    if (passed == 0)
      begin(given, before, count);
    else
      continue_from(given, text, noise, before);
    std::vector<StreamId> added;
    for (std::size_t i = 0; i < count; ++i) {
      added.push_back(next_id_);
      row_of_[next_id_] = before + i;
      ids_.push_back(next_id_++);
      append_key(keys_, starts[i], static_cast<std::int64_t>(passed) - static_cast<std::int64_t>(tick_));
    }
    changed();
    return added;
  }

  /// Removes a motion; the others are not affected. Throws Error for an unknown id.
  void remove(StreamId id) {
    const std::size_t row = row_of(id), last = size() - 1;
    if (row != last) {  // the last row takes its place
      const auto move = [&](const Tensor& t, std::size_t first, std::size_t run) {
        detail::copy_runs(t, first + last * run, run, t, first + row * run, run, 1, run);
      };
      move(rows_, 0, width());
      move(rows_, slab(), width());
      for (const Tensor* t : {&c0_, &c1_, &h_txt_}) move(*t, 0, k_);
      std::copy_n(keys_.end() - 4, 4, keys_.begin() + static_cast<std::ptrdiff_t>(4 * row));
      ids_[row] = ids_[last];
      row_of_[ids_[row]] = row;
    }
    row_of_.erase(id);
    ids_.pop_back();
    keys_.resize(4 * last);
    changed();
  }

  /// Removes all motions.
  void clear() {
    row_of_.clear();
    ids_.clear();
    keys_.clear();
    ready_ = 0;
  }

  /// Changes the text, from the frame after the next one: one frame is always computed ahead. Throws Error
  /// for an unknown id or an empty sentence.
  void set_sentence(StreamId id, const std::vector<int>& sentence) {
    const NoGrad values_only;
    const std::size_t row = row_of(id);
    detail::copy_runs(encode({sentence}), 0, k_, h_txt_, row * k_, k_, 1, k_);
    ready_ = 0;
  }

  /// The motion's row in step()'s result; remove() moves the last row. Throws Error for an unknown id.
  std::size_t row_of(StreamId id) const {
    const auto found = row_of_.find(id);
    require(found != row_of_.end(), "the stream has no motion with id ", id, "; it may have been removed");
    return found->second;
  }
  /// The motion in row `row` of what step() gives.
  StreamId id_of(std::size_t row) const { return ids_.at(row); }

  /// The next frames of all motions, as normalised poses [frames, size(), dof]; valid until the next call.
  std::span<const float> step(std::size_t frames = 1) {
    const std::size_t batch = size(), total = frames * batch * dof_;
    if (total == 0) return {};
    if (made_.empty() || made_.size() < total) {
      made_ = Tensor(context_, {total});
      host_.resize(total);
      host_double_.resize(context_.precision() == Precision::f64 ? total : 0);
    }
    for (std::size_t f = 0; f < frames; ++f) {
      detail::copy_runs(rows_, half_ * slab(), width(), made_, f * batch * dof_, dof_, batch, dof_);
      advance();
    }
    if (context_.precision() == Precision::f64) {
      context_.read(made_.buffer(), 0, host_double_.data(), total * sizeof(double));
      std::copy_n(host_double_.begin(), total, host_.begin());
    } else {
      context_.read(made_.buffer(), 0, host_.data(), total * sizeof(float));
    }
    return {host_.data(), total};
  }

 private:
  std::size_t width() const { return dof_ + 2 * k_; }
  std::size_t slab() const { return capacity_ * width(); }

  /// The prior as [frames, count, dof], repeated if it is shared.
  Tensor repeated(std::span<const float> prior, std::size_t frames, std::size_t count) const {
    if (prior.size() == frames * count * dof_) return Tensor::from(context_, {frames, count, dof_}, prior);
    std::vector<float> all;
    for (std::size_t t = 0; t < frames; ++t)
      for (std::size_t b = 0; b < count; ++b)
        all.insert(all.end(), prior.begin() + static_cast<std::ptrdiff_t>(t * dof_),
                   prior.begin() + static_cast<std::ptrdiff_t>((t + 1) * dof_));
    return Tensor::from(context_, {frames, count, dof_}, all);
  }

  /// Sets `count` rows from `row` to their first pose [1, count, dof] and zero LSTM states.
  void begin(const Tensor& pose, std::size_t row, std::size_t count) {
    const auto clear = [&](const Tensor& t, std::size_t first, std::size_t run) {
      detail::fill(t.view(first + row * run, {count * run}), 0);
    };
    clear(rows_, 0, width());
    clear(rows_, slab(), width());
    clear(c0_, 0, k_);
    clear(c1_, 0, k_);
    detail::copy_runs(pose, 0, dof_, rows_, half_ * slab() + row * width(), width(), count, dof_);
  }

  /// Sets `count` rows from `row` to frame n of what begins with `given` [1 to n, count, dof]; z is
  /// [n + 1, count, k].
  void continue_from(const Tensor& given, const Var& h_txt, const Var& z, std::size_t row) {
    const std::size_t n = z.dim(0) - 1, count = given.dim(1);
    const Var plots = generator_.plot_gates(folded_, h_txt, slice(z, 0, 1, n));
    const detail::RolloutTrace trace = detail::rollout_forward(given, plots.value(), folded_.rollout, false);
    const detail::RolloutShape& from = trace.shape;
    const std::size_t now = half_ * slab() + row * width(), next = (1 - half_) * slab() + row * width();
    detail::copy_runs(trace.rows, from.pose_at(n), from.width(), rows_, now, width(), count, dof_ + k_);
    detail::copy_runs(trace.rows, from.h1_at(n), from.width(), rows_, next + dof_ + k_, width(), count, k_);
    detail::copy_runs(trace.c0, from.state_at(n), k_, c0_, row * k_, k_, count, k_);
    detail::copy_runs(trace.c1, from.state_at(n), k_, c1_, row * k_, k_, count, k_);
  }

  static void append_key(std::vector<cl_int>& keys, const StreamStart& start, std::int64_t frame) {
    for (const std::uint32_t word :
         {static_cast<std::uint32_t>(start.seed), static_cast<std::uint32_t>(start.seed >> 32), start.sample,
          static_cast<std::uint32_t>(frame)})
      keys.push_back(static_cast<cl_int>(word));
  }

  Tensor encode(const std::vector<std::vector<int>>& sentences) const {
    // A sentence shared by several motions is encoded once.
    std::vector<std::vector<int>> distinct;
    std::vector<cl_int> which;
    for (const auto& sentence : sentences) {
      const auto found = std::find(distinct.begin(), distinct.end(), sentence);
      which.push_back(static_cast<cl_int>(found - distinct.begin()));
      if (found == distinct.end()) distinct.push_back(sentence);
    }
    const Var each =
        generator_.text_encoder()(Sentences(context_, distinct, generator_.options().vocabulary));
    return gather_rows(each, Indices(context_, which)).value();
  }

  /// Grows the buffers to at least `count` motions and keeps their contents.
  void reserve(std::size_t count) {
    if (count <= capacity_) return;
    const std::size_t larger = std::max(count, capacity_ + capacity_ / 2);
    const auto grow = [&](Tensor& t, std::size_t halves, std::size_t run) {
      Tensor bigger(context_, {halves, larger, run});
      for (std::size_t h = 0; h < halves && size() > 0; ++h)
        detail::copy_runs(t, h * capacity_ * run, run, bigger, h * larger * run, run, size(), run);
      t = bigger;
    };
    grow(rows_, 2, width());
    for (Tensor* t : {&c0_, &c1_, &h_txt_}) grow(*t, 1, k_);
    capacity_ = larger;
    // Plots are computed several frames ahead: a product of a few rows takes hardly longer than one of one
    // row.
    ahead_ = std::clamp<std::size_t>(1024 / capacity_, 1, 16);
    z_ = Tensor(context_, {ahead_, capacity_, k_});
    hidden_ = Tensor(context_, {ahead_, capacity_, k_});
    plots_ = Tensor(context_, {ahead_, capacity_, 4 * k_});
    gates_ = Tensor(context_, {capacity_, 4 * k_});
    device_keys_ = Indices(context_, 4 * capacity_);
    prepare();
  }

  /// Sets up the matrix products of a step, except for the offsets that change from step to step.
  void prepare() {
    const RolloutWeights& w = folded_.rollout;
    const auto product = [&](const Tensor& a, std::size_t a_ld, const Tensor& b, std::size_t n, std::size_t k,
                             const Tensor& c, std::size_t c_ld) {
      GemmCall call{.n = n, .k = k, .a = a, .b = b, .c = c, .a_ld = a_ld, .b_ld = k, .c_ld = c_ld};
      call.b_transposed = true;
      call.b_in_16_bits = generator_.in_16_bits();
      return call;
    };
    noise_ = product(z_, k_, generator_.plot().noise.weight.value(), k_, k_, hidden_, k_);
    noise_.bias = generator_.plot().noise.bias.value();
    plot_ = product(hidden_, k_, folded_.plot.value(), 4 * k_, k_, plots_, 4 * k_);
    plot_.bias = folded_.plot_bias.value();
    move_ = product(rows_, width(), w.diff.value(), dof_, k_, rows_, width());
    move_.bias = w.diff_bias.value();
    move_.residual = rows_, move_.residual_ld = width();
    for (auto [call, panels] :
         {std::pair{&noise_, &panels_[0]}, {&plot_, &panels_[1]}, {&move_, &panels_[2]}}) {
      if (panels->empty()) *panels = pack_b(context_, *call);
      call->b_panels = *panels;
    }
  }

  /// Uploads the noise keys after motions were added or removed.
  void changed() {
    keys_.resize(4 * capacity_);
    device_keys_.write(keys_);
    keys_.resize(4 * size());
    ready_ = 0;
  }

  /// The plots' contribution to the first layer's gates, for the next `ahead_` frames of all motions.
  void make_plots() {
    const std::size_t batch = size(), rows = ahead_ * batch;
    fill_normal_each(z_.view(0, {ahead_, batch, k_}), RandomStream::noise,
                     static_cast<std::int32_t>(tick_ + 1), device_keys_);
    noise_.m = plot_.m = rows;
    gemm(context_, noise_);
    detail::add_broadcast_relu(hidden_, h_txt_, hidden_, 1, ahead_, batch * k_);
    gemm(context_, plot_);
    ready_ = ahead_;
  }

  /// Advances by one frame. The two halves of rows_ hold the states of this step and the next, in turn.
  void advance() {
    if (ready_ == 0) make_plots();
    const std::size_t batch = size(), now = half_ * slab(), next = (1 - half_) * slab();
    const detail::At next_h1{rows_, now + dof_ + k_};  // stored with the state of the following step
    layers_.first.step({.batch = batch,
                        .rows = {rows_, now},
                        .width = width(),
                        .extra = {plots_, (ahead_ - ready_) * batch * 4 * k_},
                        .extra_is_bias = false,
                        .c_before = {c0_, 0},
                        .h = {rows_, next + dof_},
                        .c = {c0_, 0},
                        .gates = {gates_, 0},
                        .keep_gates = false});
    layers_.second.step({.batch = batch,
                         .rows = {rows_, next + dof_},
                         .width = width(),
                         .extra = {folded_.rollout.bias1.value(), 0},
                         .extra_is_bias = true,
                         .c_before = {c1_, 0},
                         .h = next_h1,
                         .c = {c1_, 0},
                         .gates = {gates_, 0},
                         .keep_gates = false});
    move_.m = batch;
    move_.a_offset[0] = next_h1.first;
    move_.residual_offset = now;
    move_.c_offset = next;
    gemm(context_, move_);
    if (const double leak = folded_.rollout.leak; leak > 0)
      detail::add_poses(context_, rows_, now, next, batch, dof_, width(), -leak);
    half_ = 1 - half_;
    --ready_;
    ++tick_;
  }

  RnnGenerator generator_;
  Context context_;
  RnnGenerator::Folded folded_;
  detail::RolloutLayers layers_;
  std::size_t k_ = 0, dof_ = 0, capacity_ = 0, ahead_ = 1, ready_ = 0, half_ = 0;
  std::uint64_t tick_ = 0;  // frames made by the stream; a motion's own frame number is tick + keys[3]
  StreamId next_id_ = 0;
  std::vector<StreamId> ids_;  // by row
  std::map<StreamId, std::size_t> row_of_;
  std::vector<cl_int> keys_;  // [size, 4]
  Indices device_keys_;
  Tensor rows_;             // two halves [capacity, dof + 2k], laid out like two steps of a rollout
  Tensor c0_, c1_, h_txt_;  // [capacity, k]
  Tensor z_, hidden_, plots_, gates_, made_;
  GemmCall noise_, plot_, move_;
  std::array<Tensor, 3> panels_;  // packed weights of the products above
  std::vector<float> host_;
  std::vector<double> host_double_;
};

}  // namespace motiongan
