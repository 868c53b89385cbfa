// Clips cut into the parts that captions describe.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/caption_file.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/motion/motion.hpp"

namespace motiongan::motion {

/// The frames of a part, first .. second - 1: those at begin <= t < end. Counted in a motion of `frames`
/// frames that lacks the first `dropped` frames of its file.
inline std::pair<std::size_t, std::size_t> frames_of_part(const CaptionPart& part, double rate,
                                                          std::size_t dropped, std::size_t frames) {
  const auto frame = [&](double seconds) {  // the first at or after this time
    const double at = std::ceil(seconds * rate - 1e-3) - static_cast<double>(dropped);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(frames)));
  };
  const std::size_t first = frame(part.begin);
  return {first, std::max(first, frame(part.end))};
}

namespace caption_detail {

/// Seconds with one to three decimals: "2.0", "4.25"; "end" for infinity.
inline std::string seconds_in_id(double seconds) {
  if (std::isinf(seconds)) return "end";
  char text[64];
  std::snprintf(text, sizeof text, "%.3f", seconds);
  std::string out = text;
  while (out.back() == '0' && out[out.size() - 2] != '.') out.pop_back();
  return out;
}

/// A clip of which several sources are parts: loaded once and kept until all of them have been.
class SharedClip {
 public:
  SharedClip(ClipSource source, std::size_t users) : source_(std::move(source)), users_(users) {}

  LoadedMotion whole(const LoadChange& change) { return *take(change); }

  /// The part; dropped frames and notes are those of the whole clip and stay with it.
  LoadedMotion part(const CaptionPart& part, const LoadChange& change) {
    const std::shared_ptr<const LoadedMotion> loaded = take(change);
    const Motion& motion = loaded->motion;
    const auto [first, end] = frames_of_part(part, motion.rate, loaded->dropped, motion.frames);
    LoadedMotion out;
    out.motion = slice(motion, first, end - first);
    out.up = loaded->up;
    return out;
  }

 private:
  std::shared_ptr<const LoadedMotion> take(const LoadChange& change) {
    const std::lock_guard lock(mutex_);
    if (!loaded_ || change_ != change) {
      loaded_ = std::make_shared<const LoadedMotion>(source_.load(change));
      change_ = change;
      left_ = users_;
    }
    std::shared_ptr<const LoadedMotion> loaded = loaded_;
    if (--left_ == 0) loaded_.reset();
    return loaded;
  }

  ClipSource source_;
  std::size_t users_, left_ = 0;
  std::shared_ptr<const LoadedMotion> loaded_;
  LoadChange change_;
  std::mutex mutex_;
};

}  // namespace caption_detail

/// Whether the parts leave no stretch of begin .. end (seconds) that is as long as `window`.
inline bool parts_cover(std::vector<CaptionPart> parts, double begin, double end, double window) {
  std::sort(parts.begin(), parts.end());
  double reached = begin;
  for (const CaptionPart& part : parts) {
    if (std::min(part.begin, end) - reached >= window * (1 - 1e-9)) return false;
    reached = std::max(reached, part.end);
  }
  return end - reached < window * (1 - 1e-9);
}

/// The sources with the captions `of_clip`, which replace their own, each followed by its captioned parts in
/// the order of their times.
inline std::vector<ClipSource> with_captions(std::vector<ClipSource> sources,
                                             std::span<const std::vector<Caption>> of_clip) {
  std::vector<ClipSource> out;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    ClipSource source = std::move(sources[i]);
    std::vector<std::string> whole;
    std::map<CaptionPart, std::vector<std::string>> parts;
    for (const Caption& caption : of_clip[i])
      (caption.part ? parts[*caption.part] : whole).push_back(caption.text);
    if (!whole.empty()) source.captions = std::move(whole);
    if (parts.empty()) {
      out.push_back(std::move(source));
      continue;
    }
    const auto shared = std::make_shared<caption_detail::SharedClip>(source, parts.size() + 1);
    const std::string id = source.id, name = source.name;
    source.load = [shared](const LoadChange& change) { return shared->whole(change); };
    if (source.captions.empty())
      for (const auto& [part, captions] : parts) source.parts.push_back(part);
    out.push_back(std::move(source));
    for (auto& [part, captions] : parts)
      out.push_back({concat(id, "@", caption_detail::seconds_in_id(part.begin), "-",
                            caption_detail::seconds_in_id(part.end)),
                     name, std::move(captions),
                     [shared, own = part](const LoadChange& change) { return shared->part(own, change); },
                     id});
  }
  return out;
}

}  // namespace motiongan::motion
