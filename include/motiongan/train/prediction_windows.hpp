// Batches of windows for training the motion-completion baselines, gathered on the device.
#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "motiongan/core/random.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/train/clip_buffer.hpp"

namespace motiongan {

/// Training data of the motion-completion baselines.
struct PredictionData {
  std::size_t dof = 0;                        ///< channels of a pose
  std::vector<std::vector<float>> sequences;  ///< normalised poses, each [frames, dof]
  std::vector<std::size_t> actions;           ///< action of each sequence, [sequences]
  std::size_t action_count = 0;               ///< Y

  std::size_t frames(std::size_t sequence) const { return sequences.at(sequence).size() / dof; }

  /// Throws Error, naming the sequence, if sizes, actions or values are not valid.
  void check() const {
    require(dof > 0 && action_count > 0, "prediction data: dof is ", dof, " and action_count is ",
            action_count, ", expected at least 1 of each");
    require(!sequences.empty() && actions.size() == sequences.size(), "prediction data: ", sequences.size(),
            " sequences with ", actions.size(),
            " actions, expected at least one sequence and one action per sequence");
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      require(sequences[s].size() % dof == 0, "prediction data: sequence ", s, " has ", sequences[s].size(),
              " values, expected a multiple of dof (", dof, ")");
      require(actions[s] < action_count, "prediction data: sequence ", s, " has action ", actions[s],
              ", expected less than ", action_count);
      for (const float x : sequences[s])
        require(std::isfinite(x), "prediction data: sequence ", s, " contains ", x,
                ", expected finite values");
    }
  }

  /// Writes a tab-separated table of the sequences: sequence, action, frames.
  void write_split(const std::filesystem::path& path) const {
    std::string text = "sequence\taction\tframes\n";
    for (std::size_t s = 0; s < sequences.size(); ++s)
      text += concat(s, "\t", actions[s], "\t", frames(s), "\n");
    io::AtomicFile file(path);
    file.write(text);
    file.commit();
  }
};

/// A batch: windows [frames, B, dof] and their actions, one-hot [B, Y].
struct PredictionBatch {
  Tensor windows, actions;
};

/// Draws windows from sequences that are kept in one device buffer. A batch depends only on (seed, step), so
/// a resumed run draws the same batches as an uninterrupted one.
class PredictionSampler {
 public:
  /// Sequences shorter than `frames` are left out. Throws Error if none is long enough or the data is
  /// invalid.
  PredictionSampler(const Context& context, const PredictionData& data, std::size_t frames)
      : context_(context), frames_(frames), action_count_(data.action_count) {
    data.check();
    std::size_t longest = 0;
    std::vector<std::span<const float>> poses;
    for (std::size_t s = 0; s < data.sequences.size(); ++s) {
      longest = std::max(longest, data.frames(s));
      if (data.frames(s) < frames) continue;
      sequences_.push_back({data.frames(s) - frames + 1, data.actions[s]});
      poses.emplace_back(data.sequences[s]);
    }
    require(!sequences_.empty(), "no sequence has ", frames, " frames (the longest has ", longest,
            "); reduce prefix or future");
    buffer_ = ClipBuffer(context, data.dof, poses);
  }

  /// Draws `size` windows: a uniform sequence, then a uniform start frame. They are samples
  /// `first` and following of the step.
  PredictionBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size,
                       std::size_t first = 0) const {
    const RandomKey key{.seed = seed, .stream = RandomStream::windows, .step = step};
    std::vector<cl_int> rows;
    std::vector<std::size_t> actions;
    for (auto b = static_cast<std::uint32_t>(first); b < first + size; ++b) {
      const std::size_t index = random_below(key, b, sequences_.size());
      const Sequence& sequence = sequences_[index];
      rows.push_back(buffer_.row(index, random_below(key, b, sequence.starts, 1)));
      actions.push_back(sequence.action);
    }
    return {buffer_.gather(rows, frames_), one_hot(context_, actions, action_count_)};
  }

 private:
  struct Sequence {
    std::size_t starts, action;
  };

  Context context_;
  std::size_t frames_, action_count_;
  std::vector<Sequence> sequences_;
  ClipBuffer buffer_;
};

}  // namespace motiongan
