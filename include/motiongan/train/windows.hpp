// Batches of captioned windows for training DVGAN and the rankers, gathered on the device.
#pragma once
#include "motiongan/core/random.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/nn/text_encoder.hpp"
#include "motiongan/train/clip_buffer.hpp"

namespace motiongan {

/// A batch of real motion with its captions.
struct CaptionedBatch {
  Tensor motion;                   ///< [N, B, M], normalised
  Sentences text;                  ///< B captions
  std::vector<std::size_t> clips;  ///< [B], the training clip of each window
};

/// Draws windows from the training clips, or with DatasetOptions::balanced from their descriptions, which are
/// kept in one device buffer. A batch depends only on (seed, step), so a resumed run draws the same batches
/// as an uninterrupted one.
class WindowSampler {
 public:
  /// Throws Error if the data set has no training clips.
  WindowSampler(const Context& context, const motion::Dataset& data)
      : context_(context),
        frames_(data.format.frames),
        stride_(data.stride),
        vocabulary_(data.format.vocabulary.size()) {
    require(!data.train.empty(), "the data set has no training clips");
    std::vector<std::span<const float>> poses;
    for (const motion::DatasetClip& clip : data.train) {
      clips_.push_back({data.starts(clip), clip.sentences});
      poses.emplace_back(clip.poses);
    }
    if (data.options.balanced) {
      std::map<std::vector<int>, std::vector<std::size_t>> clips_of;
      for (std::size_t c = 0; c < clips_.size(); ++c)
        for (const std::vector<int>& sentence : clips_[c].sentences) clips_of[sentence].push_back(c);
      for (auto& [sentence, clips] : clips_of) described_.push_back({sentence, std::move(clips)});
    }
    const std::size_t dof = data.format.dof();
    WindowForm form{.x = dof, .z = dof, .yaw = dof};
    for (const bool is_relative : data.format.relative_mask()) form.relative.push_back(is_relative);
    if (const auto turning = data.format.turning())
      form.x = turning->x, form.z = turning->z, form.yaw = turning->yaw, form.yaw_scale = turning->yaw_scale;
    buffer_ = ClipBuffer(context, dof, poses, std::move(form));
  }

  /// Draws `size` windows: for each a clip, one of its captions and a start frame, all uniform. Balanced: a
  /// description, one of its clips and a start frame. They are samples `first` and following of the step.
  CaptionedBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size, std::size_t first = 0) const {
    std::vector<cl_int> rows;
    std::vector<std::vector<int>> sentences;
    std::vector<std::size_t> clips;
    for (auto b = static_cast<std::uint32_t>(first); b < first + size; ++b) {
      const Drawn one = drawn(seed, step, b);
      clips.push_back(one.clip);
      sentences.push_back(*one.sentence);
      rows.push_back(buffer_.row(one.clip, one.start));
    }
    return {buffer_.gather(rows, frames_, stride_), Sentences(context_, sentences, vocabulary_),
            std::move(clips)};
  }

  /// The training clips that draw() takes `size` windows from.
  std::vector<std::size_t> clips_of(std::uint64_t seed, std::uint32_t step, std::size_t size) const {
    std::vector<std::size_t> out;
    for (std::uint32_t b = 0; b < size; ++b) out.push_back(drawn(seed, step, b).clip);
    return out;
  }

 private:
  struct Clip {
    std::size_t starts;
    std::vector<std::vector<int>> sentences;
  };
  struct Description {
    std::vector<int> sentence;
    std::vector<std::size_t> clips;
  };

  struct Drawn {
    std::size_t clip, start;
    const std::vector<int>* sentence;
  };
  Drawn drawn(std::uint64_t seed, std::uint32_t step, std::uint32_t sample) const {
    const RandomKey windows{.seed = seed, .stream = RandomStream::windows, .step = step},
        captions = windows.with(RandomStream::captions);
    Drawn out{};
    if (described_.empty()) {
      out.clip = random_below(windows, sample, clips_.size());
      const auto& known = clips_[out.clip].sentences;
      out.sentence = &known[random_below(captions, sample, known.size())];
    } else {
      const Description& one = described_[random_below(captions, sample, described_.size())];
      out.clip = one.clips[random_below(windows, sample, one.clips.size())];
      out.sentence = &one.sentence;
    }
    out.start = random_below(windows, sample, clips_[out.clip].starts, 1);
    return out;
  }

  Context context_;
  std::size_t frames_, stride_, vocabulary_;
  std::vector<Clip> clips_;
  std::vector<Description> described_;  // if the data set is balanced
  ClipBuffer buffer_;
};

}  // namespace motiongan
