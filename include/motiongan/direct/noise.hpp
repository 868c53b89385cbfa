// The noise of a motion as a variable: what is changed to direct it.
#pragma once
#include <vector>

#include "motiongan/models/dvgan.hpp"

namespace motiongan {

namespace detail {

/// Vectors [vectors, k] that turn and keep the length that they were drawn with, so that a generator goes on
/// seeing what it was trained on: in many dimensions normal vectors differ in direction, and hardly in
/// length.
class TurningVectors {
 public:
  TurningVectors() = default;
  explicit TurningVectors(const Var& drawn)
      : drawn_(drawn.detach()),
        lengths_(sqrt(reshape(sum(square(drawn_), 1), {drawn_.dim(0), 1}) + 1e-12).detach()),
        variable_(Var::leaf(drawn.value())) {}

  /// For an optimizer, which changes their lengths too; that does not count.
  Var& variable() { return variable_; }

  Var value() const {
    const Var length = sqrt(reshape(sum(square(variable_), 1), {variable_.dim(0), 1}) + 1e-12);
    return variable_ * broadcast_to(lengths_ / length, variable_.shape());
  }

  /// How far they have turned, [1]: the sum over vectors of 1 - cosine.
  Var turned_away() const {
    const Var together = drawn_ * value() / broadcast_to(square(lengths_), drawn_.shape());
    return affine(sum(together), -1, static_cast<double>(drawn_.dim(0)));
  }

 private:
  Var drawn_, lengths_;  // [vectors, k], [vectors, 1]
  Var variable_;
};

}  // namespace detail

/// The noise of a batch of motions in one variable, [vectors, k]: for a CNN generator every vector of every
/// level, for an RNN generator every frame's. Vectors keep the length that they were drawn with.
class NoiseVariable {
 public:
  /// Draws it as Dvgan::generate does, for samples key.first_sample and following. With `given` frames
  /// [n, B, dof], an RNN generator continues them, to `frames` in all; without, it continues its warm-up, of
  /// which the noise does not change.
  NoiseVariable(const Dvgan& model, Sentences text, const RandomKey& key, std::size_t frames, Var given = {})
      : model_(model), text_(std::move(text)), given_(std::move(given)) {
    const Context& context = model.context();
    const std::size_t batch = text_.batch, k = model.options().hidden;
    const NoGrad values_only;
    std::vector<Var> levels;
    if (model.is_recurrent()) {
      const std::size_t warm_up = given_.empty() ? model.rnn().warm_up() : 0;
      const Var z = model.rnn().noise(context, key, batch, warm_up + frames);
      if (warm_up > 0) {
        before_ = slice(z, 0, 0, warm_up);
        given_ = model.rnn()(text_, before_);
      }
      levels = {slice(z, 0, warm_up, frames)};
    } else {
      require(frames == model.format().frames && given_.empty(), "a CNN generator makes its ",
              model.format().frames, " frames at once, not ", frames);
      cut_ = model.cnn().cuts(context, key, batch);
      levels = model.cnn().noise(context, key, batch, cut_);
    }
    std::vector<Var> rows;
    for (const Var& z : levels) {
      level_frames_.push_back(z.dim(0));
      rows.push_back(reshape(z, {z.dim(0) * batch, k}));
    }
    noise_ = detail::TurningVectors(concatenate(rows, 0));
  }

  /// For an optimizer.
  std::vector<NamedParameter> parameters() { return {{"noise", &noise_.variable()}}; }

  /// Normalised motion [frames, B, dof] of the noise as it is.
  Var motion() const {
    const Var z = noise_.value();
    const std::size_t k = z.dim(1);
    std::vector<Var> levels;
    for (std::size_t at = 0; const std::size_t frames : level_frames_) {
      levels.push_back(reshape(slice(z, 0, at, frames * text_.batch), {frames, text_.batch, k}));
      at += frames * text_.batch;
    }
    if (!model_.is_recurrent()) return model_.cnn()(text_, levels, cut_);
    if (before_.empty()) return model_.rnn()(text_, levels.front(), {}, given_);
    const std::size_t warm_up = before_.dim(0);
    const Var whole = model_.rnn()(text_, concatenate({before_, levels.front()}, 0), {}, given_);
    return slice(whole, 0, warm_up, whole.dim(0) - warm_up);
  }

  /// How far the noise has turned from where it was drawn, [1].
  Var turned_away() const { return noise_.turned_away(); }

 private:
  const Dvgan& model_;
  Sentences text_;
  Var given_, before_;  // what an RNN generator continues; the noise of its warm-up
  Indices cut_;
  std::vector<std::size_t> level_frames_;
  detail::TurningVectors noise_;
};

}  // namespace motiongan
