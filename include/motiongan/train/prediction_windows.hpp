// Batches of windows of pose sequences, drawn on the device from sequences that stay there.
#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "motiongan/core/random.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/ops/cross_entropy.hpp"

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
    std::size_t rows = 0, longest = 0;
    for (std::size_t s = 0; s < data.sequences.size(); ++s) {
      longest = std::max(longest, data.frames(s));
      if (data.frames(s) < frames) continue;
      sequences_.push_back({rows, data.frames(s) - frames + 1, data.actions[s]});
      rows += data.frames(s);
    }
    require(!sequences_.empty(), "no sequence has ", frames, " frames (the longest has ", longest,
            "): prefix and future together must fit");
    poses_ = Tensor(context, {rows, data.dof});
    std::size_t at = 0;
    for (std::size_t s = 0; s < data.sequences.size(); ++s) {
      if (data.frames(s) < frames) continue;
      poses_.view(at, {data.frames(s), data.dof}).write(std::span<const float>(data.sequences[s]));
      at += data.sequences[s].size();
    }
    relative_ = Indices(context, std::vector<cl_int>(data.dof, 0));
  }

  /// `size` windows: the sequence uniform, then its start.
  PredictionBatch draw(std::uint64_t seed, std::uint32_t step, std::size_t size) const {
    const RandomKey key{.seed = seed, .stream = RandomStream::windows, .step = step};
    std::vector<cl_int> rows;
    std::vector<std::size_t> actions;
    for (std::uint32_t b = 0; b < size; ++b) {
      const Sequence& sequence = sequences_[random_below(key, b, sequences_.size())];
      rows.push_back(static_cast<cl_int>(sequence.first_row + random_below(key, b, sequence.starts, 1)));
      actions.push_back(sequence.action);
    }
    const std::size_t dof = poses_.dim(1);
    PredictionBatch batch;
    batch.windows = Tensor(context_, {frames_, size, dof});
    context_.launch("layout", "gather_windows", LaunchGrid::items(frames_ * size), poses_, Indices(context_, rows),
                    relative_, batch.windows, frames_, size, dof, std::size_t{1}, dof, dof, dof, KernelReal{0});
    batch.actions = one_hot(context_, actions, action_count_);
    return batch;
  }

 private:
  struct Sequence {
    std::size_t first_row, starts, action;
  };

  Context context_;
  std::size_t frames_, action_count_;
  std::vector<Sequence> sequences_;
  Tensor poses_;      // [all frames, dof]
  Indices relative_;  // none is
};

}  // namespace motiongan
