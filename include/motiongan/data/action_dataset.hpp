// Labelled clips as joint positions, with priors and futures for training (Malek-Podjaski & Deligianni).
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "motiongan/data/action_labels.hpp"
#include "motiongan/data/action_options.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/data/labelled_motion.hpp"
#include "motiongan/data/position_format.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/position_clip.hpp"

namespace motiongan::motion {

struct ActionPrior;

/// One clip at the data set's rate.
struct ActionClip {
  std::string id;
  std::string subject;            ///< empty unless the options need subjects
  std::size_t label = 0;          ///< index into format.classes
  std::size_t frames = 0;         ///< at the rate of the data set
  std::vector<float> poses;       ///< [frames, kept dof], normalised
  Skeleton skeleton;              ///< with the clip's own bone lengths
  std::vector<RootTrack> places;  ///< [frames], the root's track
};

/// Labelled clips of joint positions, and everything needed to convert poses back to positions.
///
/// Clips without a label are left out and counted; clips shorter than 2T frames are skipped. Clips are
/// resampled to `rate`: rotations by slerp, positions linearly. Unless the split is by subject, each class is
/// split separately, so that both parts have clips of every class with at least two. The normalizer is fitted
/// to the training clips. Classes are sorted by name.
class ActionDataset {
 public:
  PositionFormat format;  ///< skeleton of the first clip used
  ActionDatasetOptions options;
  std::vector<ActionClip> train;             ///< in file order
  std::vector<ActionClip> test;              ///< held out, in file order
  std::vector<SkippedClip> skipped;          ///< clips that are too short
  std::vector<SkippedClip> bad;              ///< files that could not be read, with clips.skip_bad
  std::vector<SkippedClip> other_skeletons;  ///< clips left out by clips.skeleton_of
  std::vector<std::string> notes;  ///< what was corrected or ignored in the clips used, one sentence each
  std::size_t unlabelled = 0;      ///< clips without a label
  std::size_t other_classes = 0;   ///< clips whose class is not in options.classes
  std::size_t dropped_frames = 0;  ///< T-pose frames removed from the starts of clips

  /// Loads all motion files (find_motion_files) in a folder and its subfolders, or one file. Throws Error for
  /// an empty folder, unreadable files, different joints, no source of labels or several, no labelled clip,
  /// no clip that is long enough, a class without a training clip, and an unknown subject or class in the
  /// options.
  static ActionDataset from_folder(const std::filesystem::path& folder_or_file,
                                   const ActionDatasetOptions& options);

  /// The same from motions in memory. If the options name no source of labels, a motion's first caption is
  /// its label; a motion without captions has none.
  static ActionDataset from_motions(const std::vector<LabelledMotion>& motions,
                                    const ActionDatasetOptions& options = {});

  /// The same from positions in memory; `labels` are by clip id.
  static ActionDataset from_positions(const std::vector<PositionClip>& clips, const ActionLabels& labels,
                                      const ActionDatasetOptions& options = {});

  /// Number of windows of 2T frames in the clip: one may start at any frame below it.
  std::size_t starts(const ActionClip& clip) const {
    return clip.frames >= 2 * format.frames ? clip.frames - 2 * format.frames + 1 : 0;
  }

  /// The whole clip as positions in the world.
  PositionClip clip(const ActionClip& clip) const;

  /// The T frames of a clip from `first_frame` on, for a model to continue. Throws Error if the clip ends
  /// before them.
  ActionPrior prior(const ActionClip& clip, std::size_t first_frame = 0) const;

  /// Writes the split, one clip per line: `train <TAB> id <TAB> class` (or `test`), and the subject if known.
  void write_split(const std::filesystem::path& path) const {
    std::string text = concat("# split of ", train.size() + test.size(), " clips, seed ", options.split_seed,
                              ", training share ", options.train_share, "\n");
    const auto append = [&](const char* part, const std::vector<ActionClip>& clips) {
      for (const ActionClip& clip : clips)
        text += concat(part, "\t", clip.id, "\t", format.classes[clip.label],
                       clip.subject.empty() ? "" : "\t" + clip.subject, "\n");
    };
    append("train", train);
    append("test", test);
    write_text_atomically(path, text);
  }
};

}  // namespace motiongan::motion

#include "motiongan/data/action_dataset_build.hpp"
#include "motiongan/data/action_prior.hpp"
