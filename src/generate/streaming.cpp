// Writes the motion of RNN models while it is generated.
#include "generate/streaming.hpp"

#include <algorithm>
#include <cmath>
#include <list>

#include "motiongan/motion/body.hpp"
#include "motiongan/train/progress.hpp"
#include "shared/motion_files.hpp"
#include "shared/signals.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t at_a_time = 64;  // motions per stream, and frames per step

/// One motion of a job.
class Growing {
 public:
  Growing(CharacterId id, fs::path path, const StreamJob& job, double rate, std::size_t frames)
      : id_(id), path_(std::move(path)), job_(job), rate_(rate), frames_(frames) {
    if (job.clean) cleaner_.emplace(*job.clean);
  }

  CharacterId id() const { return id_; }

  void append(const motion::Motion& piece) {
    const motion::Motion made = job_.body != nullptr ? job_.body->put_piece(piece, rise_) : piece;
    write(cleaner_ ? cleaner_->push(made) : made);
  }

  /// Completes the file and returns the first frames of the motion.
  motion::Motion finish() {
    if (cleaner_) write(cleaner_->finish());
    file_->finish();
    return std::move(kept_);
  }

 private:
  void write(const motion::Motion& piece) {
    if (piece.frames == 0) return;
    if (!file_)
      file_.emplace(path_, motion::scaled(piece.skeleton, job_.scale), frames_, rate_,
                    job_.rate > 0 ? job_.rate : rate_, job_.unit_metres,
                    job_.body != nullptr ? job_.body->character() : nullptr);
    file_->append(motion::scaled(piece, job_.scale));
    const std::size_t wanted = std::min(piece.frames, job_.kept - kept_.frames);
    if (wanted == 0) return;
    motion::Motion first = slice(piece, 0, wanted);
    kept_ = kept_.frames == 0 ? std::move(first) : join(std::move(kept_), first);
  }

  CharacterId id_;
  fs::path path_;
  const StreamJob& job_;
  double rate_;
  std::size_t frames_;
  std::optional<GrowingFile> file_;
  std::optional<double> rise_;  // see TargetBody::put_piece()
  std::optional<motion::CleanStream> cleaner_;
  motion::Motion kept_;
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
  std::list<Growing> growing;
  std::vector<DriftMeter> drifts(count, DriftMeter(model.format()));
  for (std::size_t i = 0; i < count; ++i) {
    growing.emplace_back(ids[i], job.files[first + i], job, rate, job.before.frames + job.frames);
    if (job.before.frames > 0) growing.back().append(job.before);
  }
  for (std::size_t at = 0; at < job.frames; at += at_a_time) {
    if (stop_requested()) return false;
    const std::size_t frames = std::min(at_a_time, job.frames - at);
    stream.step(frames);
    for (Growing& g : growing) g.append(stream.motion(g.id()));
    for (std::size_t i = 0; drift != nullptr && i < count; ++i) drifts[i].add(stream.poses(ids[i]), frames);
    made(frames);
  }
  for (Growing& g : growing) all_kept.push_back(g.finish());
  for (std::size_t i = 0; drift != nullptr && i < count; ++i) drift->add(drifts[i]);
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
