// Completion error (Table 3): what is given, what is to be predicted, and how the two are compared, as the
// motion-prediction papers do it (SPEC section 7).
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
#include "motiongan/metrics/euler_error.hpp"
#include "motiongan/experiments/numpy_random.hpp"
#include "motiongan/formats/expmap_text.hpp"
#include "motiongan/data/normalizer.hpp"

namespace motiongan {

/// The numbers of the protocol. Frames are those of the files' every second one.
struct CompletionProtocol {
  static constexpr std::size_t prefix = 50;  ///< frames given
  static constexpr std::size_t future = 25;  ///< frames to predict
  static constexpr std::size_t tests = 8;    ///< of each action
  static constexpr std::uint32_t seed = 1234567890;
  /// Where errors are read, and what the literature calls it: milliseconds at 25 frames per second.
  static constexpr std::array<std::size_t, 6> measured{1, 3, 7, 9, 13, 24};
  static constexpr std::array<int, 6> milliseconds{80, 160, 320, 400, 560, 1000};
};

/// Errors at CompletionProtocol::measured; NaN where there is none.
using CompletionErrors = std::array<double, CompletionProtocol::measured.size()>;

/// A file's every second frame, normalised.
struct CompletionClip {
  std::string id;
  std::size_t label = 0;  ///< its action, of CompletionData::classes()
  std::size_t frames = 0;
  std::vector<float> poses;  ///< [frames, dof]
};

/// A piece of a test file: what is given of it and what follows.
struct CompletionTest {
  std::size_t action = 0;     ///< of CompletionData::actions()
  std::size_t label = 0;      ///< the same action, of CompletionData::classes()
  std::string file;           ///< id of the clip
  std::size_t start = 0;      ///< first frame given, of the file's every second ones
  std::vector<float> prefix;  ///< [50, dof], normalised
  std::vector<double> truth;  ///< [75, columns], exponential maps: the prefix and the 25 frames after it
};

/// The training clips and the tests of a collection.
///
/// Models may be trained on more actions than are tested.
///
/// Mean and deviation are those of all rows of the training files, before every second one is taken;
/// dimensions that deviate by less than 1e-4 are dropped, and are their mean in truth and predictions alike.
class CompletionData {
 public:
  /// Error if a test file is too short for the protocol, or nothing moves.
  explicit CompletionData(const motion::ExpmapCollection& files)
      : layout_(files.layout), columns_(files.columns), actions_(files.actions), classes_(files.classes) {
    require(columns_ > 6, "the files have ", columns_,
            " numbers a line; the first six are not measured, expected more");
    std::vector<double> rows;
    for (const motion::ExpmapClip& clip : files.train)
      rows.insert(rows.end(), clip.text.values.begin(), clip.text.values.end());
    normalizer_ = motion::Normalizer::fit(rows, columns_);
    require(dof() > 0, "no number of the training files changes by 1e-4 or more: nothing moves");
    for (const motion::ExpmapClip& clip : files.train) {
      const std::vector<double> poses = every_second(clip.text);
      train_.push_back({clip.id, label_of(clip.action), poses.size() / columns_,
                        normalizer_.normalize<float>(std::span(poses))});
    }
    for (std::size_t a = 0; a < actions_.size(); ++a) draw_tests(files, a);
  }

  motion::ExpmapLayout layout() const { return layout_; }
  const std::vector<std::string>& actions() const { return actions_; }  ///< tested
  const std::vector<std::string>& classes() const { return classes_; }  ///< that models tell apart
  const motion::Normalizer& normalizer() const { return normalizer_; }
  std::size_t columns() const { return columns_; }              ///< numbers of a line
  std::size_t dof() const { return normalizer_.kept_dof(); }    ///< numbers of a frame that models see
  double rate() const { return motion::rate_of(layout_) / 2; }  ///< frames per second that models see
  const std::vector<CompletionClip>& train() const { return train_; }
  const std::vector<CompletionTest>& tests() const { return tests_; }  ///< eight of each action, in order

  /// The number of training clips of a tested action.
  std::size_t train_count(std::size_t action) const {
    const std::size_t label = label_of(actions_.at(action));
    return static_cast<std::size_t>(std::count_if(train_.begin(), train_.end(),
                                                  [&](const CompletionClip& c) { return c.label == label; }));
  }

  /// Milliseconds after the prefix at which measured frame `m` really stands: 80 to 1000 at 25 frames per
  /// second, less than half as much for CMU files, which have 60.
  double true_milliseconds(std::size_t m) const {
    return 1000 * static_cast<double>(CompletionProtocol::measured.at(m) + 1) / rate();
  }

  /// Errors of a prediction [25, dof], normalised. Both are turned into Euler angles; the root's (the first
  /// six numbers) are left out, and angles that deviate by 1e-4 or less in the truth: over the 25 frames to
  /// predict for Human3.6M, over all 75 for CMU.
  CompletionErrors errors(const CompletionTest& test, std::span<const float> prediction) const {
    using P = CompletionProtocol;
    require(prediction.size() == P::future * dof(), "a prediction has ", prediction.size(),
            " numbers, expected ", P::future, " frames x ", dof());
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

  /// The eight tests of an action, by its own fresh generator: Human3.6M's two files in turn.
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
      // 100 frames are kept free after a Human3.6M prefix, whatever is predicted.
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

/// Errors of each test, averaged over the tests of each action, [actions].
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

/// Errors by action of holding the last frame that is given: zero velocity, the baseline that is hard to
/// beat.
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
