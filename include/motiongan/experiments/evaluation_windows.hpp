// The choice of test windows that action models are evaluated on.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/random.hpp"
#include "motiongan/data/action_dataset.hpp"

namespace motiongan {

/// A prior of T frames in a test clip, and the frames that follow it there.
struct EvaluationWindow {
  std::size_t clip = 0;   ///< index into data.test
  std::size_t start = 0;  ///< the prior's first frame
  std::size_t label = 0;  ///< index of its class
};

/// The windows of an evaluation, and what they were chosen from.
struct EvaluationWindows {
  std::size_t future = 0;  ///< real frames after each prior
  std::vector<EvaluationWindow> windows;
  std::size_t clips = 0;                     ///< number of test clips
  std::size_t long_clips = 0;                ///< those with at least T + future frames; others give no window
  std::vector<std::size_t> per_class;        ///< number of windows of each class
  std::vector<std::size_t> clips_per_class;  ///< number of clips that they come from
};

/// Chooses at most `count` distinct windows of T + `future` frames from the test clips. It cycles through the
/// classes, and through the clips of each class, so that neither a frequent class nor a long clip dominates
/// the result. The choice depends only on the data set and the seed. Throws Error if no test clip is long
/// enough, or if `count` or `future` is 0.
inline EvaluationWindows choose_windows(const motion::ActionDataset& data, std::size_t future,
                                        std::size_t count, std::uint64_t seed = 1) {
  require(future > 0 && count > 0, "windows is ", count, " and frames is ", future,
          ", expected at least 1 of each");
  const std::size_t classes = data.format.classes.size(), length = data.format.frames + future;
  EvaluationWindows out;
  out.future = future;
  out.clips = data.test.size();
  out.per_class.assign(classes, 0);
  out.clips_per_class.assign(classes, 0);
  std::vector<std::vector<std::size_t>> clips(classes);  // long enough, in the order of their turns
  std::size_t longest = 0;
  for (std::size_t i = 0; i < data.test.size(); ++i) {
    longest = std::max(longest, data.test[i].frames);
    if (data.test[i].frames < length) continue;
    clips[data.test[i].label].push_back(i);
    ++out.long_clips;
  }
  require(out.long_clips > 0, "none of ", data.test.size(), " test clips lasts ", length,
          " frames (a prior of ", data.format.frames, " and ", future, " after it); the longest has ",
          longest, "; compare fewer frames, or keep longer clips for testing");
  for (std::size_t c = 0; c < classes; ++c) {
    const RandomKey key{.seed = seed, .stream = RandomStream::seeding, .step = static_cast<std::uint32_t>(c)};
    for (std::size_t i = clips[c].size(); i > 1; --i)
      std::swap(clips[c][i - 1], clips[c][random_below(key, static_cast<std::uint32_t>(i), i)]);
  }

  std::vector<std::set<std::size_t>> taken(data.test.size());  // starts of each clip
  std::vector<std::size_t> turn(classes, 0);
  std::vector<EvaluationWindow> chosen;
  for (bool any = true; any && chosen.size() < count;) {
    any = false;
    for (std::size_t c = 0; c < classes && chosen.size() < count; ++c) {
      for (std::size_t tries = 0; tries < clips[c].size(); ++tries) {
        const std::size_t i = clips[c][turn[c]++ % clips[c].size()];
        const std::size_t starts = data.test[i].frames - length + 1;
        if (taken[i].size() == starts) continue;
        const RandomKey key{
            .seed = seed, .stream = RandomStream::windows, .step = static_cast<std::uint32_t>(c)};
        std::size_t start = random_below(key, static_cast<std::uint32_t>(turn[c]), starts);
        while (taken[i].contains(start)) start = (start + 1) % starts;
        out.clips_per_class[c] += taken[i].empty();
        taken[i].insert(start);
        chosen.push_back({i, start, c});
        ++out.per_class[c];
        any = true;
        break;
      }
    }
  }
  out.windows = std::move(chosen);
  return out;
}

}  // namespace motiongan
