// Batches of labelled windows for training the action models, gathered on the device.
#pragma once
#include "motiongan/core/random.hpp"
#include "motiongan/data/action_dataset.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/train/clip_buffer.hpp"

namespace motiongan {

/// A batch of real priors with the futures that follow them, [T, B, dof] each, and their classes.
struct ActionBatch {
  Tensor motion;                    ///< prior and future joined in time, [2T, B, dof]
  Tensor prior, future;             ///< views of motion
  std::vector<std::size_t> labels;  ///< [B]
  Tensor classes;                   ///< one-hot, [B, Y]
};

/// Draws windows from the clips of one part of a data set, which are kept in one device buffer. A batch
/// depends only on (seed, step), so a resumed run draws the same batches as an uninterrupted one.
class ActionSampler {
 public:
  /// `balanced`: draw the class first, so that classes with few clips are drawn as often as the others.
  /// Throws Error if there are no clips or a label is out of range.
  ActionSampler(const Context& context, const motion::ActionDataset& data,
                const std::vector<motion::ActionClip>& clips, bool balanced = true)
      : context_(context),
        frames_(data.format.frames),
        classes_(data.format.classes.size()),
        balanced_(balanced) {
    require(!clips.empty(), "there are no clips to draw windows from");
    std::vector<std::span<const float>> poses;
    std::vector<std::vector<std::size_t>> by_class(classes_);
    for (const motion::ActionClip& clip : clips) {
      require(clip.label < classes_, "clip '", clip.id, "' has label ", clip.label, ", expected less than ",
              classes_);
      by_class[clip.label].push_back(clips_.size());
      clips_.push_back({data.starts(clip), clip.label});
      poses.emplace_back(clip.poses);
    }
    for (auto& members : by_class)
      if (!members.empty()) by_class_.push_back(std::move(members));
    buffer_ = ClipBuffer(context, data.format.dof(), poses);
  }

  /// Draws `size` windows of 2T frames; class (if balanced), clip and start frame are uniform. They are
  /// samples `first` and following of the step.
  ActionBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size, std::size_t first = 0) const {
    const RandomKey key{.seed = seed, .stream = RandomStream::windows, .step = step};
    std::vector<cl_int> rows;
    ActionBatch batch;
    for (auto b = static_cast<std::uint32_t>(first); b < first + size; ++b) {
      std::size_t index = 0;
      if (balanced_) {
        const auto& members = by_class_[random_below(key, b, by_class_.size(), 2)];
        index = members[random_below(key, b, members.size())];
      } else {
        index = random_below(key, b, clips_.size());
      }
      const Clip& clip = clips_[index];
      rows.push_back(buffer_.row(index, random_below(key, b, clip.starts, 1)));
      batch.labels.push_back(clip.label);
    }
    const std::size_t dof = buffer_.dof();
    batch.motion = buffer_.gather(rows, 2 * frames_);
    batch.prior = batch.motion.view(0, {frames_, size, dof});
    batch.future = batch.motion.view(frames_ * size * dof, {frames_, size, dof});
    batch.classes = one_hot(context_, batch.labels, classes_);
    return batch;
  }

 private:
  struct Clip {
    std::size_t starts, label;
  };

  Context context_;
  std::size_t frames_, classes_;
  bool balanced_;
  std::vector<Clip> clips_;
  std::vector<std::vector<std::size_t>> by_class_;  // clips of each class that is not empty
  ClipBuffer buffer_;
};

}  // namespace motiongan
