// Writes the motion of RNN models while it is generated.
#include "generate/streaming.hpp"

#include <cmath>
#include <memory>

#include "motiongan/formats/bvh.hpp"
#include "motiongan/formats/bvh_stream.hpp"
#include "motiongan/motion/body.hpp"
#include "motiongan/train/progress.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t at_a_time = 64;  // motions per stream, and frames per step

/// A BVH file written piece by piece, resampled to the file's rate.
class GrowingFile {
 public:
  GrowingFile(const fs::path& path, const motion::Skeleton& skeleton, std::size_t frames, double from,
              double to)
      : resampler_(frames, from, to), writer_(path, skeleton, to, resampler_.total()) {}
  void append(const motion::Motion& piece) { writer_.append(resampler_.append(piece)); }
  void finish() { writer_.finish(); }

 private:
  motion::Resampler resampler_;
  motion::BvhStreamWriter writer_;
};

struct Growing {
  CharacterId id;
  std::unique_ptr<GrowingFile> file;
  DriftMeter drift;
  motion::Motion kept;
};

/// Runs the job for `count` motions from `first` on. Returns false if a signal requested a stop.
bool write_some(const Dvgan& model, const StreamJob& job, std::size_t first, std::size_t count,
                DriftReport* drift, const std::function<void(std::size_t)>& made,
                std::vector<motion::Motion>& all_kept) {
  const double rate = model.format().rate;
  const auto offset = static_cast<std::ptrdiff_t>(first);
  MotionStream stream(model);
  const std::vector<CharacterId> ids = stream.add(std::vector(
      job.characters.begin() + offset, job.characters.begin() + offset + static_cast<std::ptrdiff_t>(count)));
  const bool begun = job.before.frames > 0;
  const std::size_t keep = job.finish ? job.before.frames + job.frames : job.kept;
  std::vector<Growing> growing;
  for (std::size_t i = 0; i < count; ++i) {
    const motion::Skeleton& skeleton = begun ? job.before.skeleton : model.format().skeleton();
    growing.push_back({ids[i],
                       job.finish ? nullptr
                                  : std::make_unique<GrowingFile>(
                                        job.files[first + i], scaled(skeleton, job.scale),
                                        job.before.frames + job.frames, rate, job.rate > 0 ? job.rate : rate),
                       DriftMeter(model.format()),
                       {}});
    if (!begun) continue;
    if (!job.finish) growing.back().file->append(motion::scaled(job.before, job.scale));
    growing.back().kept = slice(job.before, 0, std::min(keep, job.before.frames));
  }
  for (std::size_t at = 0; at < job.frames; at += at_a_time) {
    if (stop_requested()) return false;
    const std::size_t frames = std::min(at_a_time, job.frames - at);
    stream.step(frames);
    for (Growing& g : growing) {
      const motion::Motion piece = stream.motion(g.id);
      if (!job.finish) g.file->append(motion::scaled(piece, job.scale));
      if (drift != nullptr) g.drift.add(stream.poses(g.id), frames);
      const std::size_t wanted = std::min(frames, keep - std::min(keep, g.kept.frames));
      if (wanted == 0) continue;
      g.kept =
          g.kept.frames == 0 ? slice(piece, 0, wanted) : join(std::move(g.kept), slice(piece, 0, wanted));
    }
    made(frames);
  }
  for (std::size_t i = 0; i < count; ++i) {
    Growing& g = growing[i];
    if (job.finish) {
      g.kept = job.finish(std::move(g.kept));
      const motion::Motion sized = motion::scaled(g.kept, job.scale);
      motion::write_bvh(job.files[first + i], job.rate > 0 ? motion::resample(sized, job.rate) : sized);
    } else {
      g.file->finish();
    }
    if (drift != nullptr) drift->add(g.drift);
    all_kept.push_back(std::move(g.kept));
  }
  return true;
}

}  // namespace

std::optional<std::vector<motion::Motion>> write_streamed(const Dvgan& model, const StreamJob& job,
                                                          DriftReport* drift) {
  const std::size_t motions = job.characters.size();
  const std::size_t total = job.frames * ((motions + at_a_time - 1) / at_a_time);
  ProgressBar bar(total, {.label = "frame"});
  const bool shows = total >= 1000;
  if (shows) bar.start(total);
  std::size_t done = 0;
  const auto made = [&](std::size_t frames) {
    done += frames;
    if (shows) bar.update(done);
  };
  std::vector<motion::Motion> kept;
  for (std::size_t first = 0; first < motions; first += at_a_time)
    if (!write_some(model, job, first, std::min(at_a_time, motions - first), drift, made, kept))
      return std::nullopt;
  if (shows) bar.finish();
  return kept;
}

std::size_t shown_frames(double model_rate, double rate) {
  if (rate <= 0) return most_shown;
  return static_cast<std::size_t>(std::ceil(static_cast<double>(most_shown) * model_rate / rate)) + 1;
}

int stopped(std::size_t complete) {
  fmt::print(stderr, "\nmotiongan: stopped; {} complete, incomplete files are not kept\n",
             complete == 1 ? "1 file is" : fmt::format("{} files are", complete));
  return 128 + caught_signal();
}

}  // namespace motiongan::command
