// What a page of `motiongan serve` shows: its characters, frame by frame, and what was seen of each.
#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "motiongan/motion/motion.hpp"
#include "motiongan/view/figure.hpp"
#include "serve/crowd.hpp"

namespace motiongan::command {

/// So much of each character can be downloaded.
inline constexpr double kept_seconds = 60;

class World {
 public:
  using Id = Crowd::Id;

  /// No characters yet; `rate` is that of the model, frames per second.
  World(std::unique_ptr<Crowd> crowd, double rate);

  std::size_t size() const { return seen_.size(); }

  /// As those of Crowd.
  Id add(const CrowdStart& start);
  void remove(Id id);
  void set_prompt(Id id, const std::string& prompt);

  bool has(Id id) const { return seen_.contains(id); }

  /// The characters: id, prompt and, once it has moved, its figure: how its nodes hang together.
  nlohmann::json list() const;

  /// `count` frames from number `from` on (unset: the next one), making those that do not exist; fewer if
  /// there are no characters. Frames older than a few seconds are gone: what is left of the asked range is
  /// returned. Little-endian: number of the first frame and number of frames (uint32), then for each frame
  /// its number of characters (uint32), and for each of those its id and number of nodes (uint32) and the
  /// places of the nodes (float32 [nodes, 3]). Throws Error if frames before `from` do not exist.
  std::string frames(std::optional<std::uint64_t> from, std::size_t count);

  std::uint64_t next() const { return next_; }  ///< number of the next frame to be made

  /// The most frames for which frames() can be asked at once: a second of them, and at least two.
  std::size_t most_frames() const;

  /// The last 60 seconds of a character. Throws Error if it has not moved yet.
  motion::Motion seen(Id id) const;

 private:
  struct Seen {
    std::string prompt;
    motion::Motion motion = {};  // at most a little more than what is kept
    view::Figure figure = {};    // of its last frame
  };

  void step();
  void keep(Seen& seen, const motion::Motion& frame) const;

  std::unique_ptr<Crowd> crowd_;
  double rate_;
  std::map<Id, Seen> seen_;
  std::uint64_t next_ = 0;          // number of the next frame
  std::deque<std::string> frames_;  // the last ones, as they are sent
};

}  // namespace motiongan::command
