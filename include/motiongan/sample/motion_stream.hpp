// Streaming generation with DVGAN's RNN generator: characters advanced frame by frame, as in a game loop.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/resampler.hpp"

namespace motiongan {

/// Identifies a character while it is in its stream.
using CharacterId = StreamId;

/// How a character of a MotionStream begins.
struct CharacterOptions {
  std::string text;          ///< its description
  std::uint64_t seed = 1;    ///< seed of the noise
  std::uint32_t sample = 0;  ///< selects the noise within a seed
  /// Motion to continue from its last frame, at any frame rate. Only read by add().
  const motion::Motion* prior = nullptr;
  /// Start position and heading of a character without a prior. With RootRotation::velocity and support the
  /// first frame is placed there; with the other forms, the origin of their root positions, which is close to
  /// the first frame. RootRotation::expmap ignores the yaw.
  motion::RootTrack at = {};
};

/// Any number of characters, each with its own text, noise and place in the world, advanced together. A
/// character's motion does not depend on the others in the stream or on the number of frames per step: it is
/// that of Dvgan::generate for the same text, seed and sample. step() allocates nothing on the device once it
/// has made that number of frames for that number of characters.
///
/// Characters can run indefinitely. With RootRotation::velocity and support no value grows over time; with
/// the other forms, position (and yaw) are relative to the start and leave the range of the training windows
/// when a character walks far.
///
///     MotionStream stream(model);
///     const CharacterId id = stream.add({.text = "walk"});
///     stream.step();                              // one frame for all characters
///     draw(stream.motion(id));                    // a motion of one frame, in world space
///     stream.set_text(id, "run");
class MotionStream {
 public:
  /// Throws Error for a model with a CNN generator. The weights are read at construction.
  explicit MotionStream(const Dvgan& model) : format_(model.format()), stream_(model.rnn()) {}
  MotionStream(const MotionStream&) = delete;
  MotionStream& operator=(const MotionStream&) = delete;

  /// The number of characters.
  std::size_t size() const { return stream_.size(); }
  double rate() const { return format_.rate; }  ///< frames per second
  const motion::MotionFormat& format() const { return format_; }
  /// The model's skeleton. A character with a prior has the prior's bone lengths instead.
  const motion::Skeleton& skeleton() const { return format_.skeleton(); }

  /// Adds a character; it moves with the next step. Throws Error for a text without words and for a prior
  /// that has no frames or another skeleton, naming the joints. Words not in the training captions are
  /// treated as unknown.
  CharacterId add(const CharacterOptions& options) { return add(std::vector{options}).front(); }

  /// Adds them all, which costs little more than adding one. If one throws, none is added.
  std::vector<CharacterId> add(const std::vector<CharacterOptions>& options) {
    std::vector<Newcomer> newcomers;
    for (const CharacterOptions& o : options) {
      // Characters with the same prior share its encoding.
      const auto same = std::find_if(newcomers.begin(), newcomers.end(), [&](const Newcomer& n) {
        return o.prior != nullptr && n.prior == o.prior;
      });
      Newcomer n = same != newcomers.end() ? *same : newcomer(o);
      n.start = {format_.vocabulary.encode(o.text), o.seed, o.sample};
      newcomers.push_back(std::move(n));
    }
    std::map<std::size_t, std::vector<std::size_t>> by_length;  // the stream adds priors of equal length
    for (std::size_t i = 0; i < newcomers.size(); ++i)
      by_length[newcomers[i].poses->size() / format_.dof()].push_back(i);
    std::vector<CharacterId> ids(options.size());
    std::vector<CharacterId> added;
    try {
      for (const auto& [frames, members] : by_length) {
        const std::vector<CharacterId> some = add_group(newcomers, members, frames);
        added.insert(added.end(), some.begin(), some.end());
        for (std::size_t i = 0; i < members.size(); ++i) {
          ids[members[i]] = some[i];
          characters_.emplace(some[i], std::move(newcomers[members[i]].character));
        }
      }
    } catch (...) {
      for (const CharacterId id : added) remove(id);
      throw;
    }
    return ids;
  }

  /// Removes a character. Throws Error for an unknown id, as every function that takes an id.
  void remove(CharacterId id) {
    stream_.remove(id);
    characters_.erase(id);
  }

  /// Changes the text. One frame is always computed ahead, so the next frame still follows the old text.
  /// Throws Error for a text without words.
  void set_text(CharacterId id, const std::string& text) {
    stream_.set_sentence(id, format_.vocabulary.encode(text));
  }

  /// Advances all characters by a number of frames. Throws Error for 0 frames.
  void step(std::size_t frames = 1) {
    require(frames > 0, "frames is 0, expected at least 1");
    const std::span<const float> made = stream_.step(frames);  // [frames, size, dof]
    const std::size_t dof = format_.dof(), rows = size();
    poses_.resize(made.size());
    frames_ = frames;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t f = 0; f < frames; ++f)
        std::copy_n(made.begin() + static_cast<std::ptrdiff_t>((f * rows + row) * dof), dof,
                    poses_.begin() + static_cast<std::ptrdiff_t>((row * frames + f) * dof));
      Character& c = characters_.at(stream_.id_of(row));
      c.row = row;
      c.track = c.next_track;
      if (!format_.layout.has_steps()) continue;
      const std::vector<double> made_poses = format_.normalizer.denormalize(row_poses(row));
      const motion::PoseLayout& layout = layout_of(c);
      for (std::size_t f = 0; f < frames; ++f)
        layout.follow(std::span(made_poses).subspan(f * layout.dof(), layout.dof()), c.next_track);
    }
  }

  /// The frames of the last step in world space, at rate(). Throws Error for a character added since.
  motion::Motion motion(CharacterId id) const {
    const Character& c = character(id);
    motion::RootTrack track = c.track;
    const std::vector<double> poses = format_.normalizer.denormalize(this->poses(id));
    motion::Motion made = layout_of(c).decode(poses, frames_, rate(), &track);
    const std::size_t root = format_.layout.root();
    const bool moves = format_.layout.root_position();
    if (c.body) made.skeleton = c.body->skeleton;
    for (std::size_t f = 0; f < made.frames; ++f) {
      if (moves || !c.body) c.origin.place(made.position(f, root));
      if (c.origin.turn != 0)
        made.rotation(f, root) = multiply(motion::axis_rotation(1, c.origin.turn), made.rotation(f, root));
    }
    return made;
  }

  /// The same as normalised poses, [frames of the last step, dof]; valid until the next step.
  std::span<const float> poses(CharacterId id) const {
    const Character& c = character(id);
    require(c.row.has_value(), "character ", id, " has not moved since it was added; call step()");
    return row_poses(*c.row);
  }

 private:
  /// Places a motion, whose root positions are relative to an origin, in the world.
  struct Origin {
    double turn = 0, from_x = 0, from_z = 0, x = 0, z = 0;

    void place(motion::Vec3& p) const {
      p[0] -= from_x;
      p[2] -= from_z;
      if (turn != 0) motion::turn_ground(p[0], p[2], turn);
      p[0] += x;
      p[2] += z;
    }
  };

  /// The skeleton of a prior. `layout` has its joint positions in the last frame as offsets: joints that
  /// poses do not move keep them.
  struct Body {
    motion::Skeleton skeleton;
    motion::PoseLayout layout;
  };

  struct Character {
    motion::RootTrack track, next_track;  // before the frames of the last step, and after them
    Origin origin;
    std::shared_ptr<const Body> body;  // null: the model's skeleton
    std::optional<std::size_t> row;    // in poses_
  };

  struct Newcomer {
    const motion::Motion* prior;
    std::shared_ptr<const std::vector<float>> poses;  // of the prior, [frames, dof]
    Character character;
    StreamStart start;
  };

  const Character& character(CharacterId id) const {
    stream_.row_of(id);  // throws for an unknown id
    return characters_.at(id);
  }

  Newcomer newcomer(const CharacterOptions& o) const {
    const motion::PoseLayout& layout = format_.layout;
    Newcomer n{o.prior, std::make_shared<const std::vector<float>>(), {}, {}};
    Character& c = n.character;
    if (o.prior == nullptr) {
      if (layout.has_steps()) c.next_track = o.at;
      if (!layout.has_steps() || !layout.root_position()) c.origin.x = o.at.x, c.origin.z = o.at.z;
      if (layout.has_yaw() && !layout.has_steps()) c.origin.turn = o.at.yaw;
      return n;
    }
    require(o.prior->frames > 0, "the prior has no frames, expected at least 1");
    format_.require_skeleton(o.prior->skeleton, "the prior");
    motion::Motion prior = *o.prior;
    if (std::abs(prior.rate / rate() - 1) > 1e-6) prior = motion::resample_to_end(prior, rate());
    prior.rate = rate();
    std::vector<float> poses = format_.encode_window(prior);
    for (std::size_t i = 0; i < poses.size(); ++i)
      require(std::isfinite(poses[i]), "frame ", i / format_.dof(),
              " of the prior has a value that is not finite");
    motion::Skeleton held = prior.skeleton;
    for (std::size_t j = 0; j < held.size(); ++j) held.joints[j].offset = prior.position(prior.frames - 1, j);
    c.body = std::make_shared<const Body>(Body{prior.skeleton, layout.of_body(std::move(held))});
    if (layout.has_steps()) {
      c.next_track = layout.track_of(prior, prior.frames - 1);
    } else {
      const motion::RootTrack to = layout.track_of(prior, 0),
                              from = layout.track_of(format_.to_motion(std::span(poses).first(format_.dof())),
                                                     0);
      c.origin = {layout.has_yaw() ? to.yaw - from.yaw : 0, from.x, from.z, to.x, to.z};
    }
    n.poses = std::make_shared<const std::vector<float>>(std::move(poses));
    return n;
  }

  /// Adds those of `newcomers` in `members`, whose priors have `frames` frames each.
  std::vector<CharacterId> add_group(const std::vector<Newcomer>& newcomers,
                                     const std::vector<std::size_t>& members, std::size_t frames) {
    const std::size_t dof = format_.dof();
    std::vector<StreamStart> starts;
    std::vector<float> priors;  // [frames, members, dof]
    for (const std::size_t i : members) starts.push_back(newcomers[i].start);
    for (std::size_t f = 0; f < frames; ++f)
      for (const std::size_t i : members) {
        const auto first = newcomers[i].poses->begin() + static_cast<std::ptrdiff_t>(f * dof);
        priors.insert(priors.end(), first, first + static_cast<std::ptrdiff_t>(dof));
      }
    return stream_.add(starts, priors, frames);
  }

  /// The poses of a row of the last step, [frames, dof].
  std::span<const float> row_poses(std::size_t row) const {
    const std::size_t size = frames_ * format_.dof();
    return {poses_.data() + row * size, size};
  }

  const motion::PoseLayout& layout_of(const Character& c) const {
    return c.body ? c.body->layout : format_.layout;
  }

  motion::MotionFormat format_;
  RnnStream stream_;
  std::map<CharacterId, Character> characters_;
  std::size_t frames_ = 0;
  std::vector<float> poses_;  // of the last step, [characters, frames, dof]
};

}  // namespace motiongan
