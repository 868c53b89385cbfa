// Captioned clips cut into windows for training.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_match.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/data/dataset_clip.hpp"
#include "motiongan/data/dataset_options.hpp"
#include "motiongan/data/labelled_motion.hpp"
#include "motiongan/data/motion_format.hpp"
#include "motiongan/formats/text_file.hpp"

namespace motiongan::motion {

/// A clip that was left out.
struct SkippedClip {
  std::string id;
  std::string reason;
};

/// Clips as windows of `frames` poses at `rate`, and everything needed to convert poses back to motion.
///
/// A window takes every stride-th frame of a clip, from any frame that leaves room for it. Dimensions in
/// `format.relative_dims` (the root's x, z and yaw) are stored divided by their deviation and become relative
/// when a window is drawn: value[start + i * stride] - value[start]. If the layout has a yaw, x and z are
/// then rotated back by the yaw of the window's first frame: every window starts at the origin facing the
/// same way, wherever it was recorded. All other dimensions are normalised by mean and deviation over all
/// frames of the training clips. With steps and turns nothing is relative: steps and turns are
/// differences over `stride` frames of the clip, the distance between a window's frames; those of a window's
/// first frame lead to it from the frame before the window.
class Dataset {
 public:
  MotionFormat format;  ///< skeleton of the first clip used, statistics and vocabulary of the training clips
  DatasetOptions options;
  std::vector<DatasetClip> train;            ///< in the order of their ids, then those derived from them
  std::vector<DatasetClip> test;             ///< held out, in the order of their ids
  std::vector<SkippedClip> skipped;          ///< clips that are too short
  std::vector<SkippedClip> bad;              ///< files that could not be read, with clips.skip_bad
  std::vector<SkippedClip> other_skeletons;  ///< clips left out by clips.skeleton_of
  std::vector<std::string> notes;      ///< what was corrected or ignored in the clips used, one sentence each
  std::size_t stride = 1;              ///< frames of a clip between two frames of a window
  std::size_t named = 0;               ///< clips captioned by their name
  std::size_t dropped_frames = 0;      ///< T-pose frames removed from the starts of clips
  std::size_t parts = 0;               ///< clips that are a captioned part of a file, id@begin-end
  std::size_t described_in_parts = 0;  ///< clips left out because the captions of their parts cover them
  CaptionReport captions;              ///< which captions matched no clip, and the reverse

  /// Loads all BVH files in a folder and its subfolders, in sorted order, or one file.
  ///
  /// Only clips of at least frames / rate seconds are used. A clip keeps its rate if that is a multiple of
  /// `rate`; otherwise it is resampled to the largest multiple of `rate` below it (to `rate` itself if it is
  /// slower). With clips of several rates, the smallest stride applies to all and the others are resampled.
  ///
  /// Captions are those of `options.captions`, matched by match_captions(), or of .txt files beside the clips
  /// (read_captions_beside()); a clip without a caption gets one from its name. A captioned part of a clip
  /// becomes a clip of its own, `walk@2.0-4.5`, on the same side of the split. A clip with captions of parts
  /// only is left out if they cover it, that is, if no stretch as long as a window lies outside them.
  ///
  /// Throws Error for an empty folder, unreadable files, captions that match no clip, different skeletons,
  /// and if no clip is long enough.
  static Dataset from_bvh(const std::filesystem::path& folder_or_file, const DatasetOptions& options = {});

  /// The same from motions in memory; `options.first_frame` does not apply. Captions in `options.captions`,
  /// if given, take precedence over those of the motions.
  static Dataset from_motions(const std::vector<LabelledMotion>& motions, const DatasetOptions& options = {});

  /// Number of windows in the clip: one may start at any frame below it. At least 1.
  std::size_t starts(const DatasetClip& clip) const {
    const std::size_t reach = (format.frames - 1) * stride;
    return clip.frames > reach ? clip.frames - reach : 0;
  }

  /// Writes the normalised window that starts at frame `start`, [format.frames, kept dof], into `out`. Throws
  /// Error if `start` is out of range or `out` has the wrong size.
  void window(const DatasetClip& clip, std::size_t start, std::span<float> out) const {
    const std::size_t dof = format.dof();
    require(start < starts(clip), "window start ", start, " of clip '", clip.id, "', expected less than ",
            starts(clip));
    require(out.size() == format.frames * dof, "a window has ", format.frames, " x ", dof,
            " numbers, found room for ", out.size());
    for (std::size_t i = 0; i < format.frames; ++i)
      for (std::size_t k = 0; k < dof; ++k) out[i * dof + k] = clip.poses[(start + i * stride) * dof + k];
    format.make_relative(out);
  }

  /// The motion of a window's poses, [format.frames, kept dof].
  Motion to_motion(std::span<const float> normalised_window) const {
    return format.to_motion(normalised_window);
  }

  /// Number of training clips that are not derived from others.
  std::size_t recorded() const {
    return static_cast<std::size_t>(
        std::count_if(train.begin(), train.end(), [](const DatasetClip& clip) { return !clip.derived; }));
  }

  /// Writes the split, one clip per line: `train <TAB> id` or `test <TAB> id`.
  void write_split(const std::filesystem::path& path) const {
    std::string text = concat("# split of ", recorded() + test.size(), " clips, seed ", options.split_seed,
                              ", training share ", options.train_share, "\n");
    for (const DatasetClip& clip : train)
      if (!clip.derived) text += "train\t" + clip.id + "\n";
    for (const DatasetClip& clip : test) text += "test\t" + clip.id + "\n";
    write_text_atomically(path, text);
  }
};

}  // namespace motiongan::motion

#include "motiongan/data/dataset_build.hpp"
