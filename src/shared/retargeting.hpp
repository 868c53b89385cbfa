// Putting what a verb reads or makes on another skeleton.
#pragma once
#include <optional>

#include "motiongan/formats/glb_character.hpp"
#include "motiongan/motion/retarget.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

struct Retargeting {
  std::string skeleton;       ///< a motion file; empty: none
  std::string map, save_map;  ///< files; empty: none
  bool end_sites = false;     ///< give joints without children an end site

  bool on() const { return !skeleton.empty(); }
};

/// Adds --map, --save-map and --end-sites.
void add_map_options(CLI::App& verb, Retargeting& retargeting);

/// Adds --skeleton, and these.
void add_skeleton_options(CLI::App& verb, Retargeting& retargeting);

/// The skeleton that motions are put on.
class TargetBody {
 public:
  /// Reads the file, if there is one. Throws Error if it cannot be read.
  /// Reports go to `report`.
  explicit TargetBody(const Retargeting& options, std::FILE* report = stdout);

  /// The character, if the file is a GLB file; null otherwise.
  const motion::GlbCharacter* character() const { return character_ ? &*character_ : nullptr; }

  /// Metres per unit of what put() returns; `model` is that of what it is given. 0: unknown.
  double unit_metres(double model) const { return options_.on() ? unit_metres_ : model; }

  /// The motion on this skeleton, or on its own if there is none. For the first motion of a skeleton, prints
  /// how the joints are matched.
  motion::Motion put(const motion::Motion& motion);

  /// The same for a motion that comes in pieces. The first one sets how far all of them are moved up or down
  /// for the feet to stand on the floor.
  motion::Motion put_piece(const motion::Motion& piece, std::optional<double>& rise);

 private:
  motion::Motion finished(motion::Motion motion) const;
  const motion::Retargeter& retargeter_of(const motion::Motion& motion);
  void begin(const motion::Motion& motion);

  Retargeting options_;
  std::FILE* report_;
  std::optional<motion::GlbCharacter> character_;
  motion::Motion body_;
  double unit_metres_ = 0;
  std::optional<motion::Retargeter> retargeter_;
  motion::Skeleton from_;
};

}  // namespace motiongan::command
