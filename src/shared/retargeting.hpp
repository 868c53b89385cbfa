// Putting what a verb reads or makes on another skeleton.
#pragma once
#include <optional>

#include "motiongan/motion/retarget.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

struct Retargeting {
  std::string skeleton;       ///< a motion file; empty: none
  std::string map, save_map;  ///< files; empty: none

  bool on() const { return !skeleton.empty(); }
};

/// Adds --map and --save-map.
void add_map_options(CLI::App& verb, Retargeting& retargeting);

/// Adds --skeleton, and these.
void add_skeleton_options(CLI::App& verb, Retargeting& retargeting);

/// The skeleton that motions are put on.
class TargetBody {
 public:
  /// Reads the file, if there is one. Throws Error if it cannot be read.
  explicit TargetBody(const Retargeting& options);

  /// The motion on this skeleton, or as it is if there is none. For the first motion of a skeleton, prints
  /// how the joints are matched.
  motion::Motion put(const motion::Motion& motion);

  /// The same for a piece of a motion, which is not moved up or down for its feet to stand on the floor.
  motion::Motion put_piece(const motion::Motion& piece);

 private:
  const motion::Retargeter& retargeter_of(const motion::Motion& motion);
  void begin(const motion::Motion& motion);

  Retargeting options_;
  motion::Motion body_;
  std::optional<motion::Retargeter> retargeter_;
  motion::Skeleton from_;
};

}  // namespace motiongan::command
