// Batches of windows of pose sequences, drawn on the device from sequences that stay there.
#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "motiongan/core/random.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/ops/cross_entropy.hpp"
#include "motiongan/train/clip_buffer.hpp"

namespace motiongan {

/// What predictors are trained on.
struct PredictionData {
  std::size_t dof = 0;
  std::vector<std::vector<float>> sequences;  ///< normalised poses, each [frames, dof]
  std::vector<std::size_t> actions;           ///< of each sequence
  std::size_t action_count = 0;

  std::size_t frames(std::size_t sequence) const { return sequences.at(sequence).size() / dof; }

  /// Error, naming the sequence, for data that cannot be.
  void check() const {
    require(dof > 0 && action_count > 0, "prediction data: ", dof, " numbers a pose and ", action_count,
            " actions, expected at least 1 of each");
    require(!sequences.empty() && actions.size() == sequences.size(), "prediction data: ", sequences.size(),
            " sequences with ", actions.size(), " actions, expected an action for each, and at least one");
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      require(sequences[s].size() % dof == 0, "prediction data: sequence ", s, " has ", sequences[s].size(),
              " numbers, no whole poses of ", dof);
      require(actions[s] < action_count, "prediction data: sequence ", s, " has action ", actions[s],
              ", expected less than ", action_count);
      for (const float x : sequences[s])
        require(std::isfinite(x), "prediction data: sequence ", s, " holds ", x,
                "; every number must be finite");
    }
  }

  /// What a run was trained on, as a table: sequence, action, frames.
  void write_split(const std::filesystem::path& path) const {
    std::string text = "sequence\taction\tframes\n";
    for (std::size_t s = 0; s < sequences.size(); ++s)
      text += concat(s, "\t", actions[s], "\t", frames(s), "\n");
    io::AtomicFile file(path);
    file.write(text);
    file.commit();
  }
};

/// A batch: windows [frames, B, dof] and the actions of their sequences, one-hot [B, Y].
struct PredictionBatch {
  Tensor windows, actions;
};

/// All sequences in one device buffer. A batch is a function of (seed, step) alone, so a resumed run draws
/// what an unbroken one would have drawn.
class PredictionSampler {
 public:
  /// Sequences shorter than `frames` are not drawn from; Error where no other is left.
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
            "): prefix and future together must fit");
    buffer_ = ClipBuffer(context, data.dof, poses);
  }

  /// `size` windows: the sequence uniform, then its start.
  PredictionBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size) const {
    const RandomKey key{.seed = seed, .stream = RandomStream::windows, .step = step};
    std::vector<cl_int> rows;
    std::vector<std::size_t> actions;
    for (std::uint32_t b = 0; b < size; ++b) {
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
