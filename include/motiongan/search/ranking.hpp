// Ranks clips by the distances of their windows to the hypotheses.
#pragma once
#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "motiongan/distributed/communicator.hpp"
#include "motiongan/search/index.hpp"
#include "motiongan/search/windows.hpp"

namespace motiongan {

/// A hypothesis and its distance to a window.
struct SearchNeighbour {
  std::size_t hypothesis = 0;
  int shift = 0;        ///< frame t of the hypothesis matches frame t + shift of the window
  double distance = 0;  ///< search_distance()
};

/// A search result: a window and its one or two nearest hypotheses, nearest first.
struct SearchHit {
  SearchWindow window;
  std::vector<SearchNeighbour> nearest;
  double distance() const { return nearest.front().distance; }
};

/// What a search found.
struct SearchRanking {
  std::vector<SearchHit> hits;  ///< nearest first
  double median = 0;            ///< median distance of all clips (or windows), for comparison
  std::size_t windows = 0;      ///< number of windows compared
};

/// Options of rank_clips().
struct SearchOptions {
  std::size_t top = 10;       ///< number of results
  std::size_t hop = 0;        ///< frames between windows of a clip; 0: half a window
  bool every_window = false;  ///< rank windows rather than clips: a clip may appear more than once
};

/// The number of frames between windows of a clip, with the default resolved.
inline std::size_t search_hop(const motion::MotionFormat& format, const SearchOptions& options) {
  return options.hop > 0 ? options.hop : std::max<std::size_t>(1, format.frames / 2);
}

/// The `top` nearest clips, each by its nearest window, or, with `every_window`, the nearest windows of all
/// clips. The distances of the results are recomputed in double by search_distance() and determine the order;
/// ties are in the order of clips and frames. Throws Error if `found` does not fit windows and hypotheses.
inline SearchRanking rank(const SearchIndex& index, const std::vector<SearchWindow>& windows,
                          const WindowDistances& found, const std::vector<std::vector<float>>& hypotheses,
                          std::size_t top, bool every_window = false) {
  const std::size_t count = found.hypotheses;
  require(count == hypotheses.size() && count > 0 && found.distance.size() == windows.size() * count,
          "distances of ", found.distance.size(), " pairs do not fit ", windows.size(), " windows and ",
          hypotheses.size(), " hypotheses");
  struct Candidate {
    float distance;
    std::size_t window;
    bool operator<(const Candidate& other) const {
      return std::tie(distance, window) < std::tie(other.distance, other.window);
    }
  };
  std::vector<Candidate> candidates;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    const float* const row = &found.distance[w * count];
    const Candidate here{*std::min_element(row, row + count), w};
    const bool same_clip = !candidates.empty() && windows[candidates.back().window].clip == windows[w].clip;
    if (every_window || !same_clip)
      candidates.push_back(here);
    else
      candidates.back() = std::min(candidates.back(), here);
  }
  SearchRanking out;
  if (candidates.empty()) return out;
  const auto middle = candidates.begin() + static_cast<std::ptrdiff_t>(candidates.size() / 2);
  std::nth_element(candidates.begin(), middle, candidates.end());
  out.median = static_cast<double>(middle->distance);

  // Keep some spare candidates: near 0 the device's distances are inexact.
  const std::size_t kept = std::min(candidates.size(), top + 16);
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(kept),
                    candidates.end());
  candidates.resize(kept);
  for (const Candidate& candidate : candidates) {
    const std::vector<float> poses = index.poses(windows[candidate.window]);
    std::vector<Candidate> near;
    for (std::size_t h = 0; h < count; ++h) near.push_back({found.distance[candidate.window * count + h], h});
    const std::size_t most = std::min<std::size_t>(2, count);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
    SearchHit hit{windows[candidate.window], {}};
    for (std::size_t i = 0; i < most; ++i) {
      const std::size_t h = near[i].window;
      const int shift = found.shift[candidate.window * count + h];
      hit.nearest.push_back({h, shift, search_distance(index.format(), poses, hypotheses[h], shift)});
    }
    std::stable_sort(hit.nearest.begin(), hit.nearest.end(),
                     [](const auto& a, const auto& b) { return a.distance < b.distance; });
    out.hits.push_back(std::move(hit));
  }
  std::sort(out.hits.begin(), out.hits.end(), [](const SearchHit& a, const SearchHit& b) {
    return std::tuple(a.distance(), a.window.clip, a.window.frame) <
           std::tuple(b.distance(), b.window.clip, b.window.frame);
  });
  if (out.hits.size() > top) out.hits.resize(top);
  return out;
}

namespace search_detail {

/// The distances of all windows, of which every rank computes a share: equal bits on equal devices, however
/// many they are.
inline WindowDistances distances(const Context& context, const SearchIndex& index,
                                 const std::vector<SearchWindow>& windows,
                                 const std::vector<std::vector<float>>& hypotheses, Communicator* ranks) {
  const std::size_t rank = ranks ? ranks->rank() : 0, size = ranks ? ranks->size() : 1,
                    first = windows.size() * rank / size, end = windows.size() * (rank + 1) / size;
  const std::vector<SearchWindow> mine(windows.begin() + static_cast<std::ptrdiff_t>(first),
                                       windows.begin() + static_cast<std::ptrdiff_t>(end));
  const SearchWindows compared(context, index.format(), index.frames(), index.starts(mine),
                               {.keep_bytes = 0});
  WindowDistances found = compared(hypotheses);
  if (ranks == nullptr) return found;
  // Sums with zeros are exact, and so are shifts as floats.
  const std::size_t all = windows.size() * hypotheses.size(), at = first * hypotheses.size();
  std::vector<float> values(2 * all, 0);
  std::copy(found.distance.begin(), found.distance.end(), values.begin() + static_cast<std::ptrdiff_t>(at));
  std::copy(found.shift.begin(), found.shift.end(), values.begin() + static_cast<std::ptrdiff_t>(all + at));
  ranks->all_reduce(values);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(all);
  found.distance.assign(values.begin(), middle);
  found.shift.assign(middle, values.end());
  return found;
}

}  // namespace search_detail

/// Searches an index for the clips nearest to the hypotheses, normalised poses [N, dof] each, as made by
/// Dvgan::generate_poses(). Distances are computed on the context's device; with `ranks`, which all call this
/// with the same index and hypotheses, each compares a share of the windows. Throws Error without hypotheses.
inline SearchRanking rank_clips(const Context& context, const SearchIndex& index,
                                const std::vector<std::vector<float>>& hypotheses,
                                const SearchOptions& options = {}, Communicator* ranks = nullptr) {
  const std::vector<SearchWindow> windows = index.windows(search_hop(index.format(), options));
  SearchRanking out =
      rank(index, windows, search_detail::distances(context, index, windows, hypotheses, ranks), hypotheses,
           options.top, options.every_window);
  out.windows = windows.size();
  return out;
}

}  // namespace motiongan
