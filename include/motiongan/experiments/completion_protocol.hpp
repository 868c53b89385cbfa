// The protocol of the completion error (Lin & Amer, Table 3), that of the motion-prediction papers (Martinez,
// Black & Romero 2017; see docs/evaluation.md).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/normalizer.hpp"
#include "motiongan/experiments/numpy_random.hpp"
#include "motiongan/formats/expmap_text.hpp"
#include "motiongan/metrics/euler_error.hpp"

namespace motiongan {

/// The constants of the protocol. Frames are counted after taking every second frame of the files.
struct CompletionProtocol {
  static constexpr std::size_t prefix = 50;  ///< frames given
  static constexpr std::size_t future = 25;  ///< frames to predict
  static constexpr std::size_t tests = 8;    ///< tests of each action
  /// The seed of the protocol's windows.
  static constexpr std::uint32_t seed = 1234567890;
  /// The predicted frames (from 0) at which errors are measured, and their times in the literature:
  /// milliseconds at 25 Hz.
  static constexpr std::array<std::size_t, 6> measured{1, 3, 7, 9, 13, 24};
  /// The columns of the papers' tables.
  static constexpr std::array<int, 6> milliseconds{80, 160, 320, 400, 560, 1000};
};

/// Errors at CompletionProtocol::measured; NaN where not measured.
using CompletionErrors = std::array<double, CompletionProtocol::measured.size()>;

/// Every second frame of a file, normalised.
struct CompletionClip {
  std::string id;
  std::size_t label = 0;  ///< its action, an index into CompletionData::classes()
  std::size_t frames = 0;
  std::vector<float> poses;  ///< [frames, dof]
};

/// A test: a prefix from a test file and the frames that follow it.
struct CompletionTest {
  std::size_t action = 0;     ///< index into CompletionData::actions()
  std::size_t label = 0;      ///< the same action as an index into CompletionData::classes()
  std::string file;           ///< id of the clip
  std::size_t start = 0;      ///< first frame of the prefix, after taking every second frame
  std::vector<float> prefix;  ///< [50, dof], normalised
  std::vector<double> truth;  ///< [75, columns], exponential maps: the prefix and the 25 frames after it
};

/// The training clips and the tests of a collection of exponential-map text.
///
/// Models may be trained on more actions than are tested.
///
/// Mean and standard deviation are over all rows of the training files, before every second one is taken.
/// Channels with a standard deviation below 1e-4 are dropped; they are restored as their mean in ground truth
/// and predictions alike.
class CompletionData {
 public:
  /// Throws Error if a test file is too short for the protocol, or if every channel is constant.
  explicit CompletionData(const motion::ExpmapCollection& files)
      : layout_(files.layout), columns_(files.columns), actions_(files.actions), classes_(files.classes) {
    require(columns_ > 6, "the files have ", columns_,
            " numbers per line, expected more than 6 (the first six are not measured)");
    std::vector<double> rows;
    for (const motion::ExpmapClip& clip : files.train)
      rows.insert(rows.end(), clip.text.values.begin(), clip.text.values.end());
    normalizer_ = motion::Normalizer::fit(rows, columns_);
    require(dof() > 0,
            "no column of the training files has a standard deviation of 1e-4 or more: nothing moves");
    for (const motion::ExpmapClip& clip : files.train) {
      const std::vector<double> poses = every_second(clip.text);
      train_.push_back({clip.id, label_of(clip.action), poses.size() / columns_,
                        normalizer_.normalize<float>(std::span(poses))});
    }
    for (std::size_t a = 0; a < actions_.size(); ++a) draw_tests(files, a);
  }

  motion::ExpmapLayout layout() const { return layout_; }
  const std::vector<std::string>& actions() const { return actions_; }  ///< the actions that are tested
  const std::vector<std::string>& classes() const { return classes_; }  ///< the actions of the training clips
  /// Fitted to the training clips.
  const motion::Normalizer& normalizer() const { return normalizer_; }
  std::size_t columns() const { return columns_; }              ///< numbers per line of the files
  std::size_t dof() const { return normalizer_.kept_dof(); }    ///< channels of a model's pose
  double rate() const { return motion::rate_of(layout_) / 2; }  ///< frame rate of the models, Hz
  /// The training clips.
  const std::vector<CompletionClip>& train() const { return train_; }
  const std::vector<CompletionTest>& tests() const { return tests_; }  ///< eight of each action, in order

  /// The number of training clips of a tested action.
  std::size_t train_count(std::size_t action) const {
    const std::size_t label = label_of(actions_.at(action));
    return static_cast<std::size_t>(std::count_if(train_.begin(), train_.end(),
                                                  [&](const CompletionClip& c) { return c.label == label; }));
  }

  /// The true time of measured frame `m`, in milliseconds after the prefix: 80 to 1000 at Human3.6M's 25 Hz,
  /// but 33 to 417 for the CMU text, whose rate is 60 Hz.
  double true_milliseconds(std::size_t m) const {
    return 1000 * static_cast<double>(CompletionProtocol::measured.at(m) + 1) / rate();
  }

  /// The errors of a normalised prediction [25, dof], in radians: Euclidean distance between Euler angles.
  /// Left out are the root (the first six columns) and angles whose standard deviation in the ground truth is
  /// 1e-4 or less, over the 25 frames to predict for Human3.6M and over all 75 for CMU. Throws Error if the
  /// size is wrong.
  CompletionErrors errors(const CompletionTest& test, std::span<const float> prediction) const {
    using P = CompletionProtocol;
    require(prediction.size() == P::future * dof(), "a prediction has ", prediction.size(),
            " values, expected ", P::future, " frames x ", dof(), " dof");
    const std::vector<double> predicted = normalizer_.denormalize(prediction);
    const std::size_t before = layout_ == motion::ExpmapLayout::cmu ? P::prefix : 0;
    std::vector<double> truth, made;
    for (std::size_t f = P::prefix - before; f < P::prefix + P::future; ++f) {
      const double* const true_row = test.truth.data() + f * columns_;
      truth.insert(truth.end(), true_row + 6, true_row + columns_);
      const double* const row = f < P::prefix ? true_row : predicted.data() + (f - P::prefix) * columns_;
      made.insert(made.end(), row + 6, row + columns_);
    }
    const std::vector<double> all = euler_errors(truth, made, before + P::future);
    CompletionErrors out{};
    for (std::size_t m = 0; m < out.size(); ++m) out[m] = all[before + P::measured[m]];
    return out;
  }

 private:
  std::size_t label_of(const std::string& action) const {
    return static_cast<std::size_t>(std::find(classes_.begin(), classes_.end(), action) - classes_.begin());
  }

  std::vector<double> every_second(const motion::ExpmapText& text) const {
    std::vector<double> out;
    for (std::size_t f = 0; f < text.frames; f += 2)
      out.insert(out.end(), text.values.begin() + static_cast<std::ptrdiff_t>(f * columns_),
                 text.values.begin() + static_cast<std::ptrdiff_t>((f + 1) * columns_));
    return out;
  }

  /// Draws the eight tests of an action with a newly seeded generator, alternating between its files.
  void draw_tests(const motion::ExpmapCollection& files, std::size_t action) {
    using P = CompletionProtocol;
    const bool cmu = layout_ == motion::ExpmapLayout::cmu;
    std::vector<const motion::ExpmapClip*> clips;
    std::vector<std::vector<double>> poses;
    for (const motion::ExpmapClip& clip : files.test) {
      if (clip.action != actions_[action]) continue;
      clips.push_back(&clip);
      poses.push_back(every_second(clip.text));
    }
    require(!clips.empty(), "the action '", actions_[action], "' has no test files");
    NumpyRandom random(P::seed);
    for (std::size_t i = 0; i < P::tests; ++i) {
      const std::size_t c = i % clips.size(), frames = poses[c].size() / columns_;
      // The protocol leaves 100 frames after a Human3.6M prefix, however many are predicted.
      const std::size_t low = cmu ? 0 : 16, room = cmu ? P::prefix + P::future : P::prefix + 100;
      require(frames > low + room, clips[c]->path.string(), " has ", clips[c]->text.frames,
              " frames, expected at least ", 2 * (low + room) + 1, " to draw tests from");
      const auto start = static_cast<std::size_t>(
          random.randint(static_cast<std::int64_t>(low), static_cast<std::int64_t>(frames - room)));
      const std::span<const double> piece =
          std::span(poses[c]).subspan(start * columns_, (P::prefix + P::future) * columns_);
      const auto seen = normalizer_.normalize<double>(piece);
      CompletionTest test{action, label_of(actions_[action]), clips[c]->id, start, {}, {}};
      test.prefix.assign(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(P::prefix * dof()));
      test.truth = normalizer_.denormalize(std::span(seen));
      tests_.push_back(std::move(test));
    }
  }

  motion::ExpmapLayout layout_;
  std::size_t columns_ = 0;
  std::vector<std::string> actions_, classes_;
  motion::Normalizer normalizer_;
  std::vector<CompletionClip> train_;
  std::vector<CompletionTest> tests_;
};

/// Averages the errors [tests] over the tests of each action: [actions]. Throws Error if the size is wrong.
inline std::vector<CompletionErrors> mean_by_action(const CompletionData& data,
                                                    std::span<const CompletionErrors> errors) {
  require(errors.size() == data.tests().size(), "found errors of ", errors.size(), " tests, expected ",
          data.tests().size());
  std::vector<CompletionErrors> out(data.actions().size(), CompletionErrors{});
  for (std::size_t t = 0; t < errors.size(); ++t)
    for (std::size_t m = 0; m < errors[t].size(); ++m)
      out[data.tests()[t].action][m] += errors[t][m] / static_cast<double>(CompletionProtocol::tests);
  return out;
}

/// The errors by action of the zero-velocity baseline, which holds the last frame of the prefix.
inline std::vector<CompletionErrors> zero_velocity_errors(const CompletionData& data) {
  std::vector<CompletionErrors> all;
  for (const CompletionTest& test : data.tests()) {
    const std::span<const float> last = std::span(test.prefix).last(data.dof());
    std::vector<float> held;
    for (std::size_t f = 0; f < CompletionProtocol::future; ++f)
      held.insert(held.end(), last.begin(), last.end());
    all.push_back(data.errors(test, held));
  }
  return mean_by_action(data, all);
}

}  // namespace motiongan
