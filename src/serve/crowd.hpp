// The characters of a page of `motiongan serve`, whatever kind of model moves them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "motiongan/models/action_gan.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/root_track.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::command {

struct CrowdStart {
  std::string prompt;  ///< a text, or the name of a class
  std::uint64_t seed = 1;
  std::uint32_t sample = 0;
  motion::RootTrack at = {};  ///< where it starts, in the model's unit
};

/// Characters that advance together, one frame at a time. Functions with an id throw Error for one that is
/// not there.
class Crowd {
 public:
  using Id = std::size_t;
  virtual ~Crowd() = default;

  /// Adds a character; it moves with the next step. Throws Error for a text without words or an unknown
  /// class.
  virtual Id add(const CrowdStart& start) = 0;
  virtual void remove(Id id) = 0;
  /// Throws Error as add() does; the character then goes on as before.
  virtual void set_prompt(Id id, const std::string& prompt) = 0;
  virtual void step() = 0;
  /// The frame of the last step, a motion of one frame.
  virtual motion::Motion motion(Id id) const = 0;
};

/// Characters of a model with an RNN generator. The model must outlive them; as below.
std::unique_ptr<Crowd> stream_crowd(const Dvgan& model);

/// Characters of a model of classes. Those of class c continue one of `priors[c]`, of which each class has at
/// least one; the sample says which. No priors: the model's own starts.
std::unique_ptr<Crowd> stream_crowd(const ActionGan& model,
                                    const std::vector<std::vector<motion::Motion>>& priors);

/// Characters of a model with a CNN generator, which makes a window of N frames at once. The next sample
/// begins where the last window ended, or where the character is when its text changes: in the same place and
/// heading, but in another pose.
std::unique_ptr<Crowd> window_crowd(const Dvgan& model);

}  // namespace motiongan::command
