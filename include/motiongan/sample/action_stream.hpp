// Streaming generation with an attention model: characters whose class may change, one second at a time.
#pragma once
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "motiongan/data/action_prior.hpp"
#include "motiongan/models/action_gan.hpp"
#include "motiongan/networks/attention_rollout.hpp"

namespace motiongan {

/// A character of an ActionStream.
struct ActionCharacterOptions {
  const ActionPrior* prior = nullptr;  ///< its first T frames; only read by add()
  std::size_t label = 0;               ///< index of its class, see PositionFormat::class_index()
  std::uint64_t seed = 1;              ///< seed of the noise, if the model takes noise
  std::uint32_t sample = 0;            ///< selects the noise within a seed
};

/// Any number of characters, added and removed at any time, each with its own prior, class, noise and place
/// in the world. The model makes T frames (one second) from the previous T. A character's motion does not
/// depend on the others in the stream, bit for bit with gemm()'s native engine. It does depend on where steps
/// are cut shorter than T, because the model then continues from the frames kept.
///
/// If the format has root channels, root steps and turns are integrated from the end of the prior, so that
/// characters travel; otherwise they stay where the prior ended.
///
///     ActionStream stream(model);
///     const auto id = stream.add({.prior = &prior, .label = model.format().class_index("walk")});
///     stream.step();             // one second for all characters
///     draw(stream.clip(id));     // T frames of world-space positions
///     stream.set_class(id, "run");
class ActionStream {
 public:
  /// Names a character; not used again once it was removed.
  using Id = std::size_t;

  /// Works with the attention generator and the LSTM baseline. The weights are read at construction; the
  /// model must outlive the stream. At most `most_at_once` characters share a batch. Throws Error if it is 0.
  explicit ActionStream(const ActionGan& model, std::size_t most_at_once = 256)
      : model_(model), format_(model.format()), most_at_once_(most_at_once) {
    require(most_at_once > 0, "most_at_once is 0, expected at least 1");
    if (!model.is_baseline()) rollout_.emplace(model.generator());
  }
  ActionStream(const ActionStream&) = delete;
  ActionStream& operator=(const ActionStream&) = delete;

  /// The number of characters.
  std::size_t size() const { return characters_.size(); }
  const ActionGan& model() const { return model_; }
  const motion::PositionFormat& format() const { return format_; }

  /// Adds a character; it moves with the next step. Throws Error without a prior of T frames and for an
  /// unknown class.
  Id add(const ActionCharacterOptions& options) {
    require(options.prior != nullptr, "a character needs a prior: ", format_.frames,
            " frames of motion to continue (see prior_from)");
    const ActionPrior& prior = *options.prior;
    require(prior.poses.size() == format_.frames * format_.dof() && !prior.places.empty(), "the prior ",
            prior.id, " has ", prior.poses.size(), " values, expected ", format_.frames, " frames of ",
            format_.dof());
    check_class(options.label);
    characters_.emplace(next_id_, Character{.id = prior.id,
                                            .skeleton = prior.skeleton,
                                            .window = prior.poses,
                                            .label = options.label,
                                            .seed = options.seed,
                                            .sample = options.sample,
                                            .track = prior.places.back()});
    return next_id_++;
  }
  /// Adds them all. If one throws, none is added.
  std::vector<Id> add(std::span<const ActionCharacterOptions> options) {
    std::vector<Id> ids;
    try {
      for (const ActionCharacterOptions& o : options) ids.push_back(add(o));
    } catch (...) {
      for (const Id id : ids) remove(id);
      throw;
    }
    return ids;
  }

  /// Removes a character. Throws Error for an unknown id, as every function that takes an id.
  void remove(Id id) {
    character(id);
    characters_.erase(id);
  }

  /// Changes the class, from the next step. Throws Error for an unknown class.
  void set_class(Id id, std::size_t label) {
    check_class(label);
    character(id).label = label;
  }
  /// Changes the class, by its name, from the next step. Throws Error for an unknown class.
  void set_class(Id id, std::string_view name) { character(id).label = format_.class_index(name); }
  /// The name of its class.
  const std::string& class_of(Id id) const { return format_.classes[character(id).label]; }

  /// Position and heading of its root after the last step; assign to it to move the character.
  motion::RootTrack& track(Id id) { return character(id).track; }
  const motion::RootTrack& track(Id id) const { return character(id).track; }

  /// Advances all characters by T frames (one second), or by the first `frames` of them (1 .. T; 0: all T).
  /// Throws Error if frames is above T.
  void step(std::size_t frames = 0) {
    std::vector<Character*> all;
    for (auto& entry : characters_) all.push_back(&entry.second);
    move_all(all, frames);
  }
  /// The same for these characters alone; the others stay as they are. Throws Error, before any moves, for an
  /// unknown id or one given twice.
  void step(std::span<const Id> ids, std::size_t frames = 0) {
    std::map<Id, Character*> some;
    for (const Id id : ids)
      require(some.emplace(id, &character(id)).second, "character ", id, " is to be moved twice in a step");
    std::vector<Character*> all;
    for (const auto& [id, moved] : some) all.push_back(moved);
    move_all(all, frames);
  }

  /// The frames of the last step as normalised poses [frames, dof]; valid until the next step. Throws Error
  /// for a character added since.
  std::span<const float> poses(Id id) const {
    const Character& c = character(id);
    require(c.made > 0, "character ", id, " has not moved since it was added; call step()");
    return std::span(c.window).last(c.made * format_.dof());
  }

  /// The same as world-space positions, with the skeleton of its prior. Throws Error for a character added
  /// since.
  motion::PositionClip clip(Id id) const {
    const Character& c = character(id);
    motion::RootTrack track = c.before;
    return {c.id, c.skeleton, format_.rate, c.made, format_.decode(poses(id), &track)};
  }

 private:
  struct Character {
    std::string id;
    motion::Skeleton skeleton;
    std::vector<float> window;  // the last T frames, [T, dof]
    std::size_t label = 0;
    std::uint64_t seed = 1;
    std::uint32_t sample = 0, steps = 0;
    motion::RootTrack track = {}, before = {};  // after and before the last step
    std::size_t made = 0;                       // frames of the last step
  };

  void check_class(std::size_t label) const {
    require(label < format_.classes.size(), "class number ", label, " is out of range, the model has ",
            format_.classes.size(), " classes");
  }
  const Character& character(Id id) const {
    const auto found = characters_.find(id);
    require(found != characters_.end(), "there is no character ", id, " in the stream");
    return found->second;
  }
  Character& character(Id id) { return const_cast<Character&>(std::as_const(*this).character(id)); }

  /// The future [T, B, dof] of the prior [T, B, dof].
  Tensor make(const Tensor& prior, const Tensor& classes, const Tensor& noise) {
    if (rollout_) return rollout_->step(prior, classes, noise);
    const NoGrad values_only;
    return model_.baseline()(Var::constant(prior), Var::constant(classes), format_.frames).value();
  }

  /// Moves the characters in batches of at most most_at_once_.
  void move_all(std::span<Character* const> all, std::size_t frames) {
    if (frames == 0) frames = format_.frames;
    require(frames <= format_.frames, "frames is ", frames, ", expected at most ", format_.frames,
            ", the number the model makes per step");
    for (std::size_t at = 0; at < all.size(); at += most_at_once_)
      move_on(all.subspan(at, std::min(most_at_once_, all.size() - at)), frames);
  }

  void move_on(std::span<Character* const> batch, std::size_t frames) {
    const Context& context = model_.context();
    const std::size_t count = batch.size(), dof = format_.dof(), all = format_.frames;
    std::vector<float> priors(all * count * dof);
    std::vector<std::size_t> labels;
    std::vector<cl_int> keys;
    for (std::size_t b = 0; b < count; ++b) {
      const Character& c = *batch[b];
      for (std::size_t f = 0; f < all; ++f)
        std::copy_n(&c.window[f * dof], dof, &priors[(f * count + b) * dof]);
      labels.push_back(c.label);
      keys.insert(keys.end(), {static_cast<cl_int>(static_cast<std::uint32_t>(c.seed)),
                               static_cast<cl_int>(static_cast<std::uint32_t>(c.seed >> 32)),
                               static_cast<cl_int>(c.sample), static_cast<cl_int>(c.steps)});
    }
    Tensor noise;
    if (const std::size_t numbers = model_.options().noise_dim; numbers > 0) {
      Tensor each(context, {1, count, numbers});
      fill_normal_each(each, RandomStream::noise, 0, Indices(context, keys));
      noise = each.reshape({count, numbers});
    }
    const std::vector<float> made = make(Tensor::from(context, {all, count, dof}, priors),
                                         one_hot(context, labels, format_.classes.size()), noise)
                                        .to_host();
    for (std::size_t b = 0; b < count; ++b) {
      Character& c = *batch[b];
      c.window.erase(c.window.begin(), c.window.begin() + static_cast<std::ptrdiff_t>(frames * dof));
      for (std::size_t f = 0; f < frames; ++f) {
        const float* const row = &made[(f * count + b) * dof];
        c.window.insert(c.window.end(), row, row + dof);
      }
      c.made = frames;
      ++c.steps;
      c.before = c.track;
      format_.decode(std::span<const float>(c.window).last(frames * dof), &c.track);
    }
  }

  const ActionGan& model_;
  motion::PositionFormat format_;
  std::size_t most_at_once_;
  std::optional<AttentionRollout> rollout_;  // none for the baseline
  std::map<Id, Character> characters_;
  Id next_id_ = 0;
};

}  // namespace motiongan
