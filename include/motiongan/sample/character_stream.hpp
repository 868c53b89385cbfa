// Characters of any model that makes motion piece by piece, one frame at a time, as in a game loop.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "motiongan/motion/position_rotations.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/sample/action_stream.hpp"
#include "motiongan/sample/motion_stream.hpp"

namespace motiongan {

/// How a character of a CharacterStream begins.
struct CharacterStart {
  std::string prompt;        ///< a text, or the name of a class
  std::uint64_t seed = 1;    ///< seed of the noise, if the model takes noise
  std::uint32_t sample = 0;  ///< selects the noise within a seed
  /// Motion to continue from its last frame, at any frame rate; only read by add(). A model of classes needs
  /// a second of it, unless it keeps such seconds itself (ActionGan::starts()).
  const motion::Motion* prior = nullptr;
  /// Where it starts: ground position and heading. With a prior, that of the prior's last frame. Unset: the
  /// prior's own place, or the origin. See CharacterOptions::at for what the forms of a root make of it.
  std::optional<motion::RootTrack> at = {};
};

/// Any number of characters, of a model of texts with an RNN generator or of a model of classes, advanced one
/// frame at a time. They are the characters of MotionStream and ActionStream, and independent of each other.
///
/// A model of classes makes T frames (one second) at once. They are kept and handed out one by one; a
/// character's next second is made in the step in which its frames have run out, together with those of all
/// others for which that holds. Characters added together therefore make such a step longer than the others.
/// Rotations are found by motion_from_positions(), with zero twist relative to the prior's last frame.
///
///     CharacterStream stream(model);
///     const auto id = stream.add({.prompt = "walk"});
///     stream.step();                                     // one frame for all characters
///     draw(stream.rotations(id), stream.positions(id));  // of each joint, relative to its parent
///     stream.set_prompt(id, "run");
class CharacterStream {
 public:
  /// Names a character; not used again once it was removed.
  using Id = std::size_t;

  /// Throws Error for a model with a CNN generator. The weights are read at construction.
  explicit CharacterStream(const Dvgan& model)
      : stream_(std::in_place_type<MotionStream>, model), skeleton_(skeleton_of(model)) {}
  /// The weights are read at construction; the model must outlive the stream.
  explicit CharacterStream(const ActionGan& model)
      : stream_(std::in_place_type<ActionStream>, model), skeleton_(skeleton_of(model)) {}

  /// The skeleton of the characters of a model, see skeleton().
  static motion::Skeleton skeleton_of(const Dvgan& model) { return model.format().skeleton(); }
  static motion::Skeleton skeleton_of(const ActionGan& model) {
    const motion::PositionFormat& format = model.format();
    return motion::with_bvh_channels(
        motion::depth_first({"", format.skeleton(), format.rate, 0, {}}).skeleton);
  }

  /// The number of characters.
  std::size_t size() const { return characters_.size(); }
  /// Frames per second.
  double rate() const { return actions() ? actions()->format().rate : texts()->rate(); }
  /// Whether prompts are names of classes, and characters continue a prior.
  bool has_classes() const { return actions() != nullptr; }
  /// The model's skeleton. A character with a prior has the prior's bone lengths instead. Its joints are in
  /// the order of a BVH file, depth first, also if those of a model of classes are not.
  const motion::Skeleton& skeleton() const { return skeleton_; }
  /// The ids of all characters, in the order in which they were added.
  const std::vector<Id>& ids() const { return ids_; }
  /// Whether it was added and not removed.
  bool contains(Id id) const { return characters_.contains(id); }

  /// Adds a character; it moves with the next step. Throws Error for a text without words, an unknown class,
  /// and a prior that is missing, too short or of another skeleton. Unknown words are accepted.
  Id add(const CharacterStart& start) { return add(std::span(&start, 1)).front(); }

  /// Adds them all, which costs little more than adding one. If one throws, none is added.
  std::vector<Id> add(std::span<const CharacterStart> starts) {
    std::vector<Id> added = actions() ? add_actions(starts) : add_texts(starts);
    ids_.insert(ids_.end(), added.begin(), added.end());
    return added;
  }

  /// Removes a character. Throws Error for an unknown id, as every function that takes an id.
  void remove(Id id) {
    character(id);
    std::visit([&](auto& stream) { stream.remove(id); }, stream_);
    characters_.erase(id);
    std::erase(ids_, id);
  }

  /// Changes the text, from the frame after the next one; or the class, from the character's next second: up
  /// to T frames later, see frames_left(). Throws Error for a text without words or an unknown class.
  void set_prompt(Id id, const std::string& prompt) {
    character(id);
    if (actions())
      actions()->set_class(id, prompt);
    else
      texts()->set_text(id, prompt);
  }

  /// How many frames of the character are made already and will come with the next steps.
  std::size_t frames_left(Id id) const {
    const Character& c = character(id);
    return c.made.frames == 0 ? 0 : c.made.frames - 1 - c.frame;
  }

  /// Advances all characters by one frame. Throws Error if a model of classes makes numbers that are not
  /// finite; the character then stays at its last frame.
  void step() {
    std::vector<Id> due;  // those whose frames have run out
    std::vector<Character*> others;
    for (auto& [id, c] : characters_) {
      if (c.frame + 1 < c.made.frames)
        others.push_back(&c);
      else
        due.push_back(id);
    }
    if (!actions())
      texts()->step();
    else if (!due.empty())
      actions()->step(due);
    for (const Id id : due) renew(id, characters_.at(id));
    for (Character* const c : others) ++c->frame;
  }

  /// Local rotations of the character's frame of the last step, [joints]; valid until the next change of the
  /// stream. Throws Error for a character added since, as all that follow.
  std::span<const motion::Quat> rotations(Id id) const {
    const Character& c = moved(id);
    return frame_of(c.made.rotations, c);
  }
  /// Joint positions relative to the parents, in the unit of the model's clips, [joints]; the root's is its
  /// place in the world.
  std::span<const motion::Vec3> positions(Id id) const {
    const Character& c = moved(id);
    return frame_of(c.made.positions, c);
  }
  /// World positions of the joints, [joints]. They are computed when first asked for.
  std::span<const motion::Vec3> global_positions(Id id) {
    moved(id);
    Character& c = characters_.at(id);
    if (c.global.empty()) c.global = motion::joint_positions(c.made);
    return frame_of(c.global, c);
  }
  /// The frame as a motion of one frame, with the character's own skeleton.
  motion::Motion motion(Id id) const {
    const Character& c = moved(id);
    return motion::slice(c.made, c.frame, 1);
  }

 private:
  struct Character {
    motion::Motion made = {};                  // the frames made last
    std::vector<motion::Vec3> global = {};     // world positions of all of them; empty: not computed
    std::size_t frame = 0;                     // of `made`, that of the last step
    std::vector<motion::Quat> reference = {};  // zero twist, for a model of classes
  };

  const ActionStream* actions() const { return std::get_if<ActionStream>(&stream_); }
  ActionStream* actions() { return std::get_if<ActionStream>(&stream_); }
  const MotionStream* texts() const { return std::get_if<MotionStream>(&stream_); }
  MotionStream* texts() { return std::get_if<MotionStream>(&stream_); }

  const Character& character(Id id) const {
    const auto found = characters_.find(id);
    require(found != characters_.end(), "there is no character ", id,
            " in the stream; it may have been removed");
    return found->second;
  }
  const Character& moved(Id id) const {
    const Character& c = character(id);
    require(c.made.frames > 0, "character ", id, " has not moved since it was added; call step()");
    return c;
  }

  template <class T>
  std::span<const T> frame_of(const std::vector<T>& values, const Character& c) const {
    return std::span(values).subspan(c.frame * skeleton_.size(), skeleton_.size());
  }

  /// The prior with the root `joint` at `to` in its last frame.
  static motion::Motion ending_at(const motion::Motion& prior, std::size_t joint,
                                  const motion::RootTrack& to) {
    const motion::Motion last = motion::slice(prior, prior.frames - 1, 1);
    const motion::Motion moved = motion::placed_at(motion::join(last, prior), joint, to, true);
    return motion::slice(moved, 1, prior.frames);
  }

  std::vector<Id> add_texts(std::span<const CharacterStart> starts) {
    std::map<std::size_t, motion::Motion> moved;  // priors that start elsewhere, by character
    std::vector<CharacterOptions> options;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const CharacterStart& s = starts[i];
      options.push_back({s.prompt, s.seed, s.sample, s.prior, s.at.value_or(motion::RootTrack{})});
      if (s.prior == nullptr || !s.at || s.prior->frames == 0) continue;
      texts()->format().require_skeleton(s.prior->skeleton, "the prior");
      options.back().prior = &(moved[i] = ending_at(*s.prior, texts()->format().layout.root(), *s.at));
    }
    std::vector<Id> ids = texts()->add(options);
    for (const Id id : ids) characters_.emplace(id, Character{});
    return ids;
  }

  std::vector<Id> add_actions(std::span<const CharacterStart> starts) {
    struct Given {
      ActionPrior prior;
      Character character;
    };
    std::map<const motion::Motion*, Given> given;  // characters with the same prior share it
    std::vector<ActionCharacterOptions> options;
    std::vector<Character> characters;
    for (const CharacterStart& s : starts) {
      const std::size_t label = actions()->format().class_index(s.prompt);
      if (s.prior == nullptr) {
        const ActionStart* const own = actions()->model().start(label, s.sample);
        require(own != nullptr, "a character of a model of classes needs a prior: ", seconds_needed(),
                " of motion to continue; this model keeps none of its own");
        options.push_back({&own->prior, label, s.seed, s.sample});
        characters.push_back({.reference = own->rotations});
        continue;
      }
      if (!given.contains(s.prior)) {
        Given& g = given[s.prior];
        g.prior = last_second(*s.prior, g.character.reference);
      }
      options.push_back({&given.at(s.prior).prior, label, s.seed, s.sample});
      characters.push_back(given.at(s.prior).character);
    }
    std::vector<Id> ids = actions()->add(options);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      characters_.emplace(ids[i], std::move(characters[i]));
      if (!starts[i].at) continue;
      motion::RootTrack& track = actions()->track(ids[i]);
      track.x = starts[i].at->x, track.z = starts[i].at->z, track.yaw = starts[i].at->yaw;
    }
    return ids;
  }

  std::string seconds_needed() const {
    const motion::PositionFormat& format = actions()->format();
    return concat(format.frames, " frames at ", format.rate, " per second");
  }

  /// The prior's last T frames, and the local rotations of the last one.
  ActionPrior last_second(const motion::Motion& prior, std::vector<motion::Quat>& reference) const {
    const motion::PositionFormat& format = actions()->format();
    motion::Motion at_rate = prior;
    if (std::abs(prior.rate / format.rate - 1) > 1e-6) at_rate = motion::resample_to_end(prior, format.rate);
    at_rate.rate = format.rate;
    require(at_rate.frames >= format.frames, "the prior has ", at_rate.frames, " frames at ", format.rate,
            " per second, expected at least ", format.frames, ": give a longer clip");
    const motion::PositionClip clip = motion::clip_for(at_rate, format, "of the character");
    const motion::Motion folded =
        motion::fold_into_root(at_rate, prior.skeleton.find(format.skeleton().joints.front().name));
    ActionPrior out = prior_from(clip, format, clip.frames - format.frames);
    reference.assign(folded.rotations.end() - static_cast<std::ptrdiff_t>(clip.skeleton.size()),
                     folded.rotations.end());
    return out;
  }

  /// Takes the frames of the character that its stream made last.
  void renew(Id id, Character& c) {
    motion::Motion made =
        actions() ? motion::motion_from_positions(actions()->clip(id), c.reference) : texts()->motion(id);
    // q and -q are the same rotation: each joint goes on with the sign that it had, for those who
    // interpolate.
    if (actions() && c.made.frames > 0)
      for (std::size_t j = 0; j < skeleton_.size(); ++j)
        if (dot(made.rotation(0, j), c.made.rotation(c.made.frames - 1, j)) < 0)
          for (std::size_t f = 0; f < made.frames; ++f) {
            motion::Quat& q = made.rotation(f, j);
            q = {-q.w, -q.x, -q.y, -q.z};
          }
    c.made = std::move(made);
    c.global.clear();
    c.frame = 0;
  }

  std::variant<MotionStream, ActionStream> stream_;
  motion::Skeleton skeleton_;
  std::map<Id, Character> characters_;
  std::vector<Id> ids_;
};

}  // namespace motiongan
