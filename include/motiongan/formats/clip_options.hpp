// How clips are read: axes, units, frame rate, first frame, and what to do with files that do not fit.
#pragma once
#include <filesystem>
#include <optional>

#include "motiongan/core/fields.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/first_frame.hpp"

namespace motiongan::motion {

/// Options of reading motion files, the same wherever clips are read.
struct ClipOptions {
  std::optional<UpAxis> up{};  ///< the files' up axis; not set: detected, else y. z is turned to y
  double unit_metres = 0;      ///< metres per unit of the files; 0: unknown
  double scale = 1;            ///< lengths are multiplied by this
  double fps = 0;              ///< frames per second of the files; 0: what each file says
  FirstFrame first_frame = FirstFrame::automatic;  ///< whether a pose before the motion is dropped
  std::filesystem::path bones{};  ///< bone list of CSV and NPY, ASF of AMC; empty: found next to each
  bool skip_bad = false;          ///< go on without files that cannot be read
  bool normalise_height = false;  ///< scale the clips of a data set to their median body height
  /// Use only the clips of a folder that have the skeleton of this file.
  std::filesystem::path skeleton_of{};

  /// The options of one file.
  void list_reading(FieldList& list) {
    list.add(up, {.key = "up",
                  .help = "the clips' up axis; z is turned to y [from the rest pose and travel, else y]"});
    list.add(scale, {.key = "scale", .help = "multiply all lengths by this", .range = Range::above(0)});
    list.add(fps, {.key = "fps",
                   .help = "the clips' frames per second, if the files are wrong or do not say [as in the "
                           "files]",
                   .range = Range::at_least(0)});
    list.add(first_frame,
             {.key = "first_frame",
              .help = "auto: drop a T-pose that precedes the motion; keep; drop: the first frame"});
    list.add(
        bones,
        {.key = "bones",
         .help =
             "lines `joint <TAB> parent` for CSV and NPY files [bones.tsv next to them]; the ASF file of AMC "
             "files",
         .type = "FILE"});
  }

  void list_fields(FieldList& list) {
    list_reading(list);
    list.add(unit_metres, {.key = "unit_metres",
                           .help = "metres per unit of the clips, kept with the model [by body height]",
                           .range = Range::at_least(0)});
    list.add(skip_bad, {.key = "skip_bad", .help = "go on without files that cannot be read"});
    list.add(normalise_height, {.key = "normalise_height",
                                .help = "scale clips to their median body height, for bodies of different "
                                        "size or unit"});
    list.add(skeleton_of, {.key = "skeleton_of",
                           .help = "use only the clips that have the skeleton of this file",
                           .type = "FILE"});
  }
};

}  // namespace motiongan::motion
