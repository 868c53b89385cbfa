// Directed motion: a trained generator is kept as it is, and its noise is chosen so that what it makes meets
// constraints. Not in the papers.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/direct/checks.hpp"
#include "motiongan/direct/exact.hpp"
#include "motiongan/direct/noise.hpp"
#include "motiongan/direct/noise_search.hpp"
#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/motion.hpp"

namespace motiongan {

/// A motion that is asked for.
struct DirectTask {
  std::string text;
  std::vector<Constraint> constraints = {};
  std::vector<Constraint> guides = {};  ///< help on the way: not checked, and not measured
  /// Frames that it begins with, at the model's rate and of the model's joints; may have none. If all tasks
  /// have some, of one skeleton, all motions are made for that body.
  motion::Motion given = {};
  /// Where the root is in the first frame, if nothing is given.
  motion::RootTrack start = {};
};

/// A motion and how well it meets what was asked for.
struct DirectedMotion {
  motion::Motion motion;
  std::vector<ConstraintError> errors;  ///< one for each constraint
  std::size_t iterations = 0;           ///< in all windows

  /// Whether every error is within its tolerance.
  bool met() const { return largest_excess(errors) <= 1; }
};

namespace detail {

/// Directs several motions of one length, window by window.
class Director {
 public:
  Director(Dvgan& model, const std::vector<DirectTask>& tasks, const DirectOptions& options)
      : model_(model), format_(model.format()), tasks_(tasks), options_(options) {
    const motion::Skeleton& body = tasks.front().given.skeleton;
    frames_ = options.frames > 0 ? options.frames : format_.frames;
    require(frames_ >= 3, "a directed motion has ", frames_, " frames, expected at least 3");
    require(options.starts > 0, "starts is 0, expected at least 1");
    seconds_ = static_cast<double>(frames_ - 1) / format_.rate;
    for (const DirectTask& task : tasks) {
      require(task.given.frames < frames_, "a motion of ", frames_, " frames cannot begin with ",
              task.given.frames, " given frames");
      require(task.given.frames == tasks.front().given.frames,
              "motions that are directed together begin with equal numbers of given frames");
      if (task.given.frames > 0) format_.require_skeleton(task.given.skeleton, "the given motion");
    }
    if (std::all_of(tasks.begin(), tasks.end(),
                    [&](const DirectTask& t) { return t.given.frames > 0 && t.given.skeleton == body; }))
      format_.layout = format_.layout.of_body(body);
    // An RNN generator continues any motion; windows of a CNN generator overlap.
    overlap_ = std::min<std::size_t>(8, format_.frames / 4);
    for (const DirectTask& task : tasks) {
      check_constraints(directed_body(format_), task.constraints, anchor_of_task(task), seconds_);
      made_.emplace_back();
      made_.back().motion = task.given;
      sentences_.push_back(format_.vocabulary.encode(task.text));
    }
  }

  std::vector<DirectedMotion> run() {
    const Frozen fixed(named_parameters(model_));
    const std::size_t given = tasks_.front().given.frames, length = format_.frames;
    const bool recurrent = model_.is_recurrent();
    // Where windows begin. They end `length` frames later; an RNN generator's after `length` new ones. The
    // last one may end after the motion: critics score whole windows.
    std::vector<std::size_t> firsts{0};
    std::size_t end = recurrent ? given + length : length;
    while (end < frames_) {
      firsts.push_back(end - overlap_);
      end = recurrent ? end + length : firsts.back() + length;
    }
    for (std::size_t w = 0; w < firsts.size(); ++w) {
      const std::size_t next = w + 1 < firsts.size() ? firsts[w + 1] + overlap_ : end;
      direct_window(w, firsts.size(), firsts[w], next - firsts[w]);
    }
    for (std::size_t i = 0; i < made_.size(); ++i) {
      motion::Motion& made = made_[i].motion;
      const std::size_t root = format_.layout.root();
      made = slice(made, 0, frames_);
      if (options_.exact) made = meet_exactly(std::move(made), root, tasks_[i].constraints);
      made_[i].errors = constraint_errors(made, root, tasks_[i].constraints);
    }
    return std::move(made_);
  }

 private:
  /// What is asked of a task's window, besides its own constraints.
  std::vector<Constraint> constraints_of(std::size_t task, std::size_t first) const {
    std::vector<Constraint> out = tasks_[task].constraints;
    const motion::Motion& so_far = made_[task].motion;
    if (first > 0)  // a loop that does not fit into a window ends with the poses that it began with
      for (Constraint& c : out)
        if (const auto* const loop = std::get_if<LoopConstraint>(&c)) {
          const double last = loop->seconds > 0 ? loop->seconds : seconds_;
          c = PoseConstraint{.time = last,
                             .pose = slice(so_far, 0, 2),
                             .weight = loop->weight,
                             .tolerance = loop->tolerance};
        }
    if (!model_.is_recurrent() && so_far.frames > first)
      out.push_back(PoseConstraint{.time = static_cast<double>(first) / format_.rate,
                                   .pose = slice(so_far, first, so_far.frames - first),
                                   .placed = true});
    return out;
  }

  motion::RootTrack anchor_of(std::size_t task, std::size_t first) const {
    const motion::Motion& so_far = made_[task].motion;
    return so_far.frames > first ? track_at(so_far, first) : tasks_[task].start;
  }
  motion::RootTrack anchor_of_task(const DirectTask& task) const {
    return task.given.frames > 0 ? track_at(task.given, 0) : task.start;
  }
  motion::RootTrack track_at(const motion::Motion& motion, std::size_t frame) const {
    const WorldPose pose = world_pose(motion, frame, format_.layout.root());
    return {pose.x, pose.z, pose.yaw, true};
  }

  void direct_window(std::size_t window, std::size_t windows, std::size_t first, std::size_t frames) {
    const std::size_t tasks = tasks_.size(), starts = options_.starts, batch = tasks * starts;
    const Context& context = model_.context();
    std::vector<std::vector<int>> texts;
    DirectObjective objective(context, format_, frames, batch, first);
    asked_.clear(), anchors_.clear();
    for (std::size_t i = 0; i < tasks; ++i) {
      asked_.push_back(constraints_of(i, first));
      anchors_.push_back(anchor_of(i, first));
      for (std::size_t s = 0; s < starts; ++s) {
        texts.push_back(sentences_[i]);
        objective.add(i * starts + s, asked_[i], anchors_[i], seconds_);
        objective.add(i * starts + s, tasks_[i].guides, anchors_[i], seconds_);
      }
    }
    objective.finish(context);
    const Sentences text(context, texts, format_.vocabulary.size());
    const RandomKey key{.seed = options_.seed,
                        .step = static_cast<std::uint32_t>(window),
                        .first_sample = static_cast<std::uint32_t>(options_.first_sample * starts)};
    NoiseVariable noise(model_, text, key, frames, given_poses(first));
    const SearchWindow place{window, windows};
    NoiseSearch search(options_, tasks);
    const std::size_t iterations =
        search.run(noise, objective, place, [&](std::size_t task, const std::vector<float>& poses) {
          return largest_excess(
              constraint_errors(placed(poses, task), format_.layout.root(), asked_[task], first, seconds_));
        });
    std::vector<float> scores;
    if (options_.score) {
      const NoGrad values_only;
      scores = options_.score(batch_of(context, search.best(), format_.dof()), text);
    }
    for (std::size_t i = 0; i < tasks; ++i) {
      append(made_[i].motion, placed(search.chosen(i, scores, place), i), first);
      made_[i].iterations += iterations;
    }
  }

  /// The frames before the window that an RNN generator continues, normalised [n, B, dof].
  Var given_poses(std::size_t first) const {
    if (!model_.is_recurrent() || made_.front().motion.frames <= first) return {};
    std::vector<std::vector<float>> all;
    for (const DirectedMotion& made : made_) {
      const std::size_t frames = made.motion.frames - first;
      all.insert(all.end(), options_.starts, format_.encode_window(slice(made.motion, first, frames)));
    }
    return batch_of(model_.context(), all, format_.dof());
  }

  motion::Motion placed(const std::vector<float>& poses, std::size_t task) const {
    return motion::placed_at(format_.to_motion(poses), format_.layout.root(), anchors_[task], true);
  }

  /// Replaces the frames from `first` on; those that both have fade from one to the other. An RNN generator
  /// hands on what it continues as it is, but for bone lengths.
  void append(motion::Motion& so_far, motion::Motion next, std::size_t first) const {
    if (so_far.frames == 0) {
      so_far = std::move(next);
      return;
    }
    const std::size_t both = so_far.frames - first;
    const motion::Motion old = slice(so_far, first, both);
    for (std::size_t f = 0; f < both; ++f)
      motion::clean_detail::blend_frame(
          old, next, f,
          model_.is_recurrent()
              ? 0
              : motion::clean_detail::ease(static_cast<double>(f + 1) / static_cast<double>(both + 1)));
    motion::Motion head = slice(so_far, 0, first);
    head.skeleton = next.skeleton;
    so_far = first == 0 ? std::move(next) : join(std::move(head), next);
  }

  Dvgan& model_;
  motion::MotionFormat format_;
  const std::vector<DirectTask>& tasks_;
  const DirectOptions& options_;
  std::size_t frames_, overlap_ = 0;
  double seconds_;
  std::vector<std::vector<int>> sentences_;
  std::vector<DirectedMotion> made_;  // so far
  // Of the window that is being made:
  std::vector<std::vector<Constraint>> asked_;
  std::vector<motion::RootTrack> anchors_;
};

}  // namespace detail

/// Directs one motion for each task, all of options.frames frames and begun with equal numbers of given
/// frames; they share the batch, which makes many cheaper than one by one. The same tasks, options and device
/// give the same bits. The model's weights do not change. Throws Error for sizes that
/// do not fit, and as check_constraints() does.
inline std::vector<DirectedMotion> direct(Dvgan& model, const std::vector<DirectTask>& tasks,
                                          const DirectOptions& options = {}) {
  if (tasks.empty()) return {};
  return detail::Director(model, tasks, options).run();
}

}  // namespace motiongan
