// Splitting labelled clips into training and test parts, by class or by subject.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/split.hpp"

namespace motiongan::motion {

/// What determines the part a clip is in.
struct SplitClip {
  std::size_t label = 0;  ///< index of its class
  std::string subject;    ///< who moves; empty: not known
};

/// Splits each class separately (split_clips): whether each clip is for training, [clips]. A class of one
/// clip is for training.
inline std::vector<bool> split_by_class(const std::vector<SplitClip>& clips, std::size_t classes,
                                        double train_share, std::uint64_t seed) {
  std::vector<bool> is_train(clips.size(), false);
  for (std::size_t c = 0; c < classes; ++c) {
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < clips.size(); ++i)
      if (clips[i].label == c) members.push_back(i);
    // A new seed for each class, so that classes of the same size are split differently.
    const std::vector<bool> part = split_clips(members.size(), train_share, splitmix64(seed));
    for (std::size_t m = 0; m < members.size(); ++m) is_train[members[m]] = part[m];
  }
  return is_train;
}

namespace action_split_detail {

/// The subset of `counts`, taken in `order`, whose sum is nearest to `target`, [counts]. With two or more
/// counts, neither none nor all.
inline std::vector<bool> nearest_sum(const std::vector<std::size_t>& counts,
                                     const std::vector<std::size_t>& order, double target) {
  std::size_t total = 0;
  for (const std::size_t n : counts) total += n;
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> last(total + 1, none);  // last count in a sum; none if not reached
  for (const std::size_t i : order)
    for (std::size_t sum = total; sum >= counts[i]; --sum)
      if (last[sum] == none && (sum == counts[i] || last[sum - counts[i]] != none)) last[sum] = i;
  std::size_t best = total;
  for (std::size_t sum = 1; sum < total; ++sum) {
    const auto away = [&](std::size_t s) { return std::abs(static_cast<double>(s) - target); };
    if (last[sum] != none && (best == total || away(sum) < away(best))) best = sum;
  }
  std::vector<bool> taken(counts.size(), counts.size() == 1);
  for (std::size_t sum = best; sum > 0 && counts.size() > 1; sum -= counts[last[sum]])
    taken[last[sum]] = true;
  return taken;
}

}  // namespace action_split_detail

/// Splits by whole subjects: whether each clip is for training, [clips]. Subjects are shuffled by the seed
/// and chosen so that the fraction of training clips is as near to `train_share` as whole subjects allow. Of
/// up to 200 shuffles, the first is taken that gives both parts clips of every class, else the first that
/// gives the training part the most classes. Throws Error unless 0 < train_share <= 1.
inline std::vector<bool> split_by_subject(const std::vector<SplitClip>& clips, std::size_t classes,
                                          double train_share, std::uint64_t seed) {
  require(train_share > 0 && train_share <= 1, "train_share is ", train_share,
          ", expected more than 0 and at most 1");
  std::map<std::string, std::size_t> numbers;  // in the order of the names
  for (const SplitClip& clip : clips) numbers.emplace(clip.subject, 0);
  std::size_t count = 0;
  for (auto& [name, number] : numbers) number = count++;
  std::vector<std::size_t> sizes(count), order(count);
  for (const SplitClip& clip : clips) ++sizes[numbers[clip.subject]];
  for (std::size_t s = 0; s < count; ++s) order[s] = s;

  std::vector<bool> best;
  std::size_t most = 0;
  for (int attempt = 0; attempt < 200 && most <= 2 * classes * classes + classes; ++attempt) {
    for (std::size_t i = count; i > 1; --i)
      std::swap(order[i - 1], order[static_cast<std::size_t>(splitmix64(seed) % i)]);
    const std::vector<bool> taken =
        action_split_detail::nearest_sum(sizes, order, train_share * static_cast<double>(clips.size()));
    std::vector<bool> is_train(clips.size()), in_train(classes), in_test(classes);
    for (std::size_t i = 0; i < clips.size(); ++i) {
      is_train[i] = taken[numbers[clips[i].subject]];
      (is_train[i] ? in_train : in_test)[clips[i].label] = true;
    }
    // Classes in the training part take precedence.
    const auto trained = static_cast<std::size_t>(std::count(in_train.begin(), in_train.end(), true));
    const auto tested = static_cast<std::size_t>(std::count(in_test.begin(), in_test.end(), true));
    const std::size_t worth = 1 + 2 * classes * trained + tested;
    if (worth > most) {
      most = worth;
      best = is_train;
    }
  }
  return best;
}

/// Holds out the clips of `test_subjects`; all others are for training, [clips]. Throws Error for a subject
/// without clips, and if no clip is left for training.
inline std::vector<bool> split_off_subjects(const std::vector<SplitClip>& clips,
                                            const std::vector<std::string>& test_subjects) {
  std::map<std::string, std::size_t> known;
  for (const SplitClip& clip : clips) ++known[clip.subject];
  std::string list;
  for (const auto& [name, uses] : known)
    list += concat(list.empty() ? "" : ", ", name, " (", uses, " clips)");
  for (const std::string& subject : test_subjects)
    require(known.contains(subject), "the test subject '", subject,
            "' has no clip; the subjects are: ", list);
  std::vector<bool> is_train;
  for (const SplitClip& clip : clips)
    is_train.push_back(std::find(test_subjects.begin(), test_subjects.end(), clip.subject) ==
                       test_subjects.end());
  require(std::find(is_train.begin(), is_train.end(), true) != is_train.end(),
          "all clips are of test subjects, expected some to train on; the subjects are: ", list);
  return is_train;
}

}  // namespace motiongan::motion
