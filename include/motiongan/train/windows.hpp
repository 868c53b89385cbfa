// Batches of training windows, drawn on the device from clips that stay there.
#pragma once
#include "motiongan/core/random.hpp"
#include "motiongan/data/dataset.hpp"
#include "motiongan/nn/text_encoder.hpp"

namespace motiongan {

/// Real motion with its captions: [N, B, M] and B sentences.
struct CaptionedBatch {
  Tensor motion;
  Sentences text;
  std::vector<std::size_t> clips;  ///< of the data set's training clips, which one each window is of
};

/// All training clips in one device buffer. A batch is a function of (seed, step) alone, so a resumed run
/// draws what an unbroken one would have drawn.
class WindowSampler {
 public:
  WindowSampler(const Context& context, const motion::Dataset& data)
      : context_(context),
        frames_(data.format.frames),
        stride_(data.stride),
        vocabulary_(data.format.vocabulary.size()) {
    require(!data.train.empty(), "the data set has no training clips");
    const std::size_t dof = data.format.dof();
    std::size_t rows = 0;
    for (const motion::DatasetClip& clip : data.train) {
      clips_.push_back({rows, data.starts(clip), clip.sentences});
      rows += clip.frames;
    }
    poses_ = Tensor(context, {rows, dof});
    std::size_t at = 0;
    for (const motion::DatasetClip& clip : data.train) {
      poses_.view(at * dof, {clip.frames, dof}).write(std::span<const float>(clip.poses));
      at += clip.frames;
    }
    std::vector<cl_int> relative;
    for (bool is_relative : data.format.relative_mask()) relative.push_back(is_relative);
    relative_ = Indices(context, relative);
    turning_ = data.format.turning().value_or(motion::MotionFormat::Turning{dof, dof, dof, 0});
  }

  /// `size` windows: a clip, one of its captions and a start for each sample, all uniform.
  CaptionedBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size) const {
    const RandomKey windows{.seed = seed, .stream = RandomStream::windows, .step = step},
        captions = windows.with(RandomStream::captions);
    std::vector<cl_int> rows;
    std::vector<std::vector<int>> sentences;
    std::vector<std::size_t> drawn;
    for (std::uint32_t b = 0; b < size; ++b) {
      drawn.push_back(random_below(windows, b, clips_.size()));
      const Clip& clip = clips_[drawn.back()];
      rows.push_back(static_cast<cl_int>(clip.first_row + random_below(windows, b, clip.starts, 1)));
      sentences.push_back(clip.sentences[random_below(captions, b, clip.sentences.size())]);
    }
    const std::size_t dof = poses_.dim(1);
    CaptionedBatch batch{Tensor(context_, {frames_, size, dof}), Sentences(context_, sentences, vocabulary_),
                std::move(drawn)};
    context_.launch("layout", "gather_windows", LaunchGrid::items(frames_ * size), poses_, Indices(context_, rows),
                    relative_, batch.motion, frames_, size, dof, stride_, turning_.x, turning_.z,
                    turning_.yaw, KernelReal{turning_.yaw_scale});
    return batch;
  }

 private:
  struct Clip {
    std::size_t first_row, starts;
    std::vector<std::vector<int>> sentences;
  };

  Context context_;
  std::size_t frames_, stride_, vocabulary_;
  std::vector<Clip> clips_;
  Tensor poses_;  // [all frames, dof]
  Indices relative_;
  motion::MotionFormat::Turning turning_{};  // yaw = dof: windows are not turned
};

}  // namespace motiongan
