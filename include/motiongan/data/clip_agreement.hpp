// Whether the clips of a data set belong together: readable files, one skeleton, one up axis, bodies of one
// size.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/motion/skeleton.hpp"
#include "motiongan/motion/skeleton_match.hpp"

namespace motiongan::motion {

/// Clips of one skeleton: indices of clips, ascending. The first stands for the group.
using SkeletonGroup = std::vector<std::size_t>;

/// Groups clips whose joints have the same names, parents and order, as a data set requires; channels and
/// bone lengths may differ. Largest group first; of equal ones, that of the earlier clip.
inline std::vector<SkeletonGroup> group_by_skeleton(std::span<const Skeleton* const> skeletons) {
  std::vector<SkeletonGroup> out;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const auto group = std::find_if(out.begin(), out.end(), [&](const SkeletonGroup& g) {
      return have_same_joints(*skeletons[g.front()], *skeletons[i]);
    });
    if (group != out.end())
      group->push_back(i);
    else
      out.push_back({i});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const SkeletonGroup& a, const SkeletonGroup& b) { return a.size() > b.size(); });
  return out;
}

/// What a data set compares between its clips.
struct ClipFacts {
  std::string id;
  const Skeleton* skeleton = nullptr;
  double height = 0;  ///< body_height; 0: unknown
  std::optional<UpAxis> up{};
  double unit_metres = 0;  ///< metres per unit, if the file says so; 0: unknown
};

namespace clip_agreement_detail {

/// The names of at most five clips.
inline std::string names_of(std::span<const ClipFacts> clips, std::span<const std::size_t> which) {
  std::string out;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, which.size()); ++i)
    out += (i > 0 ? ", '" : "'") + clips[which[i]].id + "'";
  if (which.size() > 5) out += concat(" and ", which.size() - 5, " more");
  return out;
}

inline std::string count_of(std::size_t n) { return concat(n, n == 1 ? " clip" : " clips"); }

}  // namespace clip_agreement_detail

/// Throws Error, listing the groups and how their joints differ, unless all clips have one skeleton.
inline void require_one_skeleton(std::span<const ClipFacts> clips) {
  std::vector<const Skeleton*> skeletons;
  for (const ClipFacts& clip : clips) skeletons.push_back(clip.skeleton);
  const std::vector<SkeletonGroup> groups = group_by_skeleton(skeletons);
  if (groups.size() < 2) return;
  const Skeleton& first = *skeletons[groups.front().front()];
  std::string list;
  for (const SkeletonGroup& group : groups) {
    const Skeleton& skeleton = *skeletons[group.front()];
    list += concat("\n  ", clip_agreement_detail::count_of(group.size()), " of ", skeleton.size(),
                   " joints: ", clip_agreement_detail::names_of(clips, group));
    if (&group != &groups.front())
      list += "; compared with the first: " + some_of(joint_differences(first, skeleton), 4);
  }
  throw Error("the clips have ", groups.size(), " different skeletons:", list,
              "\nA model is trained on one of them: keep the clips of one with --skeleton-of FILE "
              "(skeleton_of), or put all on one skeleton with `motiongan retarget` (Retargeter)");
}

/// Throws Error, naming the clips, if some have y up and others z. Returns z if any clip has z up.
inline UpAxis require_one_up_axis(std::span<const ClipFacts> clips) {
  std::vector<std::size_t> y, z;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (clips[i].up) (*clips[i].up == UpAxis::y ? y : z).push_back(i);
  namespace detail = clip_agreement_detail;
  if (!y.empty() && !z.empty())
    throw Error("the clips differ in their up axis: ", detail::count_of(y.size()), " with y up (",
                detail::names_of(clips, y), "), ", detail::count_of(z.size()), " with z up (",
                detail::names_of(clips, z),
                "). Give --up (up) if that is detected wrongly, or train on one kind");
  return z.empty() ? UpAxis::y : UpAxis::z;
}

/// The median of the known body heights; 0 if none is known.
inline double median_height(std::span<const ClipFacts> clips) {
  std::vector<double> known;
  for (const ClipFacts& clip : clips)
    if (clip.height > 0) known.push_back(clip.height);
  if (known.empty()) return 0;
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) / 2);
  std::nth_element(known.begin(), middle, known.end());
  return *middle;
}

/// Throws Error, naming the odd ones, if body heights differ from their median by a factor of more than 1.5.
inline void require_like_heights(std::span<const ClipFacts> clips) {
  const double median = median_height(clips);
  std::vector<std::size_t> odd;
  std::string heights;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const double height = clips[i].height;
    if (height <= 0 || (height <= 1.5 * median && median <= 1.5 * height)) continue;
    odd.push_back(i);
    if (odd.size() <= 5) heights += concat(odd.size() > 1 ? ", '" : "'", clips[i].id, "' ", height);
  }
  if (odd.size() > 5) heights += concat(" and ", odd.size() - 5, " more");
  require(odd.empty(), "the bodies differ too much in height: the median is ", median, " units, but ",
          heights,
          ". If their units differ, give --normalise-height (normalise_height) to scale all clips to the "
          "median, or convert these files with --scale");
}

/// Unit and up axis of clips that belong together: the unit as given, else as their files say, else by their
/// median body height.
inline ClipSpace space_of(std::span<const ClipFacts> clips, const ClipOptions& options) {
  ClipSpace out;
  // A given unit is that of the files, before options.scale.
  const double told = clips.empty() ? 0 : clips.front().unit_metres;
  const bool all_tell = told > 0 && std::all_of(clips.begin(), clips.end(), [&](const ClipFacts& clip) {
                          return clip.unit_metres == told;
                        });
  out.unit_metres = options.unit_metres > 0 ? options.unit_metres / options.scale
                    : all_tell              ? told
                                            : likely_unit_metres(median_height(clips));
  for (const ClipFacts& clip : clips)
    if (clip.up == UpAxis::z) out.clips_up = UpAxis::z;
  return out;
}

/// What has to change in each clip so that all are y up and, with options.normalise_height, of one height;
/// [clips]. Adds what was decided to `notes`. Throws Error if the clips do not belong together: different
/// skeletons, up axes or sizes.
inline std::vector<LoadChange> agreed_changes(std::span<const ClipFacts> clips, const ClipOptions& options,
                                              std::vector<std::string>& notes) {
  namespace detail = clip_agreement_detail;
  std::vector<LoadChange> out(clips.size());
  require_one_skeleton(clips);
  if (require_one_up_axis(clips) == UpAxis::z) {
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < clips.size(); ++i)
      if (!clips[i].up) out[i].up = UpAxis::z, ++unsure;
    notes.push_back(concat("z is up in these clips", options.up ? "" : ", by their rest pose and travel",
                           unsure > 0 ? concat(" (", detail::count_of(unsure), " followed the others)") : "",
                           "; they are turned to y up"));
  }
  if (!options.normalise_height) {
    require_like_heights(clips);
    return out;
  }
  const double median = median_height(clips);
  std::size_t scaled = 0;
  for (std::size_t i = 0; i < clips.size(); ++i)
    if (clips[i].height > 0 && std::abs(clips[i].height / median - 1) > 1e-6)
      out[i].scale = median / clips[i].height, ++scaled;
  notes.push_back(
      concat(detail::count_of(scaled), " scaled to the median body height of ", median, " units"));
  return out;
}

/// Throws Error listing all files that could not be read, unless `skip_bad`. `errors` [clips], empty where a
/// clip was read.
inline void require_all_read(std::span<const std::string> errors, bool skip_bad) {
  std::size_t bad = 0;
  std::string list;
  for (const std::string& error : errors)
    if (!error.empty()) ++bad, list += "\n  " + error;
  if (bad == 0 || (skip_bad && bad < errors.size())) return;
  if (bad == 1 && errors.size() == 1) throw Error(list.substr(3));
  throw Error(bad, " of ", errors.size(), " files cannot be read:", list,
              skip_bad ? "" : "\nRepair or remove them, or go on without them with --skip-bad (skip_bad)");
}

}  // namespace motiongan::motion
