// Directed motion: a trained generator is kept as it is, and its noise is chosen so that what it makes meets
// constraints. Not in the papers.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/fields.hpp"
#include "motiongan/direct/checks.hpp"
#include "motiongan/direct/exact.hpp"
#include "motiongan/direct/noise.hpp"
#include "motiongan/direct/objective.hpp"
#include "motiongan/motion/clean.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/optim/adam.hpp"

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

/// How far the optimisation is.
struct DirectProgress {
  std::size_t window = 0, windows = 1;  ///< of a motion that is longer than the model's windows
  std::size_t iteration = 0;
  double excess = 0;  ///< of the worst motion, see ConstraintError
};

struct DirectOptions {
  std::size_t frames = 0;        ///< of each motion; 0: the model's N
  std::size_t starts = 8;        ///< noises that are tried for a motion, side by side
  std::size_t iterations = 300;  ///< at most, for each window
  double learning_rate = 0.1;    ///< of Adam
  double stay = 0.0003;          ///< weight of how far the noise turns away from where it was drawn
  bool exact = false;            ///< correct at last what is a little off, see meet_exactly()
  std::uint64_t seed = 1;
  std::size_t first_sample = 0;  ///< motion i of a seed begins with the noise of samples starts * i and more
  /// Scores of normalised motion [N, B, dof] for its texts, [B], such as SavedCritic: of the starts that meet
  /// everything, the one of the highest score is kept. Not set: the one of the smallest error.
  std::function<std::vector<float>(const Var& motion, const Sentences& text)> score = {};
  std::function<void(const DirectProgress&)> report = {};
  std::function<bool()> should_stop = {};  ///< ends early, with the best so far

  void list_fields(FieldList& list) {
    list.add(starts, {.key = "starts",
                      .help = "noises that are tried for a motion, side by side",
                      .range = Range::between(1, 4096),
                      .saved = false});
    list.add(iterations, {.key = "direct_iterations",
                          .help = "steps of the optimisation at most, for each window",
                          .range = Range::between(1, 1'000'000),
                          .saved = false});
    list.add(
        learning_rate,
        {.key = "direct_rate", .help = "its step size (Adam)", .range = Range::above(0), .saved = false});
    list.add(exact, {.key = "exact",
                     .help = "correct at last what is a little off, so that constraints are met exactly",
                     .saved = false});
    list.add(stay, {.key = "direct_stay",
                    .help = "weight of how far the noise turns away from where it was drawn",
                    .range = Range::at_least(0),
                    .saved = false});
  }
};

/// A motion and how well it meets what was asked for.
struct DirectedMotion {
  motion::Motion motion;
  std::vector<ConstraintError> errors;  ///< one for each constraint
  std::size_t iterations = 0;           ///< in all windows

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
      check_constraints(format_, task.constraints, anchor_of_task(task), seconds_);
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
  static constexpr std::size_t check_every = 10;  // iterations

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
    Adam adam(noise.parameters(), {.learning_rate = options_.learning_rate, .beta1 = 0.9, .beta2 = 0.99});
    best_.assign(batch, {});
    // What a window leaves undone the next one has to mend, with its own constraints to meet.
    const double aim = window + 1 < windows ? 0.5 : 1;
    std::size_t iteration = 0;
    for (;; ++iteration) {
      const Var made = noise.motion();
      if (iteration == 0) objective.keep_moving(made);
      const bool last = iteration == options_.iterations || (options_.should_stop && options_.should_stop());
      if (last || iteration % check_every == 0) {
        const double worst = keep_best(made, first, frames);
        if (options_.report) options_.report({window, windows, iteration, worst});
        if (last || enough(aim)) break;
      }
      const Var loss = weighted_sum(objective(made), 1, noise.turned_away(), options_.stay);
      // Smaller and smaller steps, so that the last ones settle.
      adam.set_rate_factor(0.5 + 0.5 * std::cos(motion::pi * static_cast<double>(iteration) /
                                                static_cast<double>(options_.iterations)));
      adam.step(grad(loss, {noise.variable()}));
    }
    choose(text, first, iteration, aim);
  }

  /// The frames before the window that an RNN generator continues, normalised [n, B, dof].
  Var given_poses(std::size_t first) const {
    if (!model_.is_recurrent() || made_.front().motion.frames <= first) return {};
    std::vector<std::vector<float>> all;
    for (const DirectedMotion& made : made_) {
      const std::size_t frames = made.motion.frames - first;
      all.insert(all.end(), options_.starts, format_.encode_window(slice(made.motion, first, frames)));
    }
    return batch_of(all);
  }

  /// Samples [frames, dof] as one batch [frames, B, dof].
  Var batch_of(const std::vector<std::vector<float>>& samples) const {
    const std::size_t batch = samples.size(), dof = format_.dof(), frames = samples.front().size() / dof;
    std::vector<float> all(frames * batch * dof);
    for (std::size_t b = 0; b < batch; ++b)
      for (std::size_t f = 0; f < frames; ++f)
        std::copy_n(samples[b].begin() + static_cast<std::ptrdiff_t>(f * dof), dof,
                    all.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof));
    return Var::constant(Tensor::from(model_.context(), {frames, batch, dof}, all));
  }

  /// A start's best so far.
  struct Best {
    double excess = 0;
    std::vector<float> poses;  // normalised, [frames, dof]; empty: none yet
  };

  motion::Motion placed(const std::vector<float>& poses, std::size_t task) const {
    return motion::placed_at(format_.to_motion(poses), format_.layout.root(), anchors_[task], true);
  }

  /// Measures all starts; returns the excess of the worst task's best start.
  double keep_best(const Var& made, std::size_t first, std::size_t frames) {
    const std::size_t batch = best_.size(), dof = format_.dof();
    const std::vector<float> all = made.value().to_host();
    std::vector<double> of_task(tasks_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t b = 0; b < batch; ++b) {
      std::vector<float> poses(frames * dof);
      for (std::size_t f = 0; f < frames; ++f)
        std::copy_n(all.begin() + static_cast<std::ptrdiff_t>((f * batch + b) * dof), dof,
                    poses.begin() + static_cast<std::ptrdiff_t>(f * dof));
      const std::size_t task = b / options_.starts;
      const double excess = largest_excess(
          constraint_errors(placed(poses, task), format_.layout.root(), asked_[task], first, seconds_));
      if (best_[b].poses.empty() || excess < best_[b].excess) best_[b] = {excess, std::move(poses)};
      of_task[task] = std::min(of_task[task], best_[b].excess);
    }
    return *std::max_element(of_task.begin(), of_task.end());
  }

  /// Whether half of every task's starts have no larger excess.
  bool enough(double aim) const {
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      std::size_t met = 0;
      for (std::size_t s = 0; s < options_.starts; ++s) met += best_[i * options_.starts + s].excess <= aim;
      if (2 * met < options_.starts) return false;
    }
    return true;
  }

  /// Scores of the best of all starts, [B]; empty without a critic.
  std::vector<float> scores(const Sentences& text) const {
    if (!options_.score) return {};
    std::vector<std::vector<float>> all;
    for (const Best& best : best_) all.push_back(best.poses);
    const NoGrad values_only;
    return options_.score(batch_of(all), text);
  }

  /// Appends every task's best start to its motion.
  void choose(const Sentences& text, std::size_t first, std::size_t iterations, double aim) {
    const std::vector<float> score = scores(text);
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      std::size_t best = i * options_.starts;
      const auto better = [&](std::size_t a, std::size_t b) {
        if (!score.empty() && best_[a].excess <= aim && best_[b].excess <= aim) return score[a] > score[b];
        return best_[a].excess < best_[b].excess;
      };
      for (std::size_t s = 1; s < options_.starts; ++s)
        if (better(i * options_.starts + s, best)) best = i * options_.starts + s;
      append(made_[i].motion, placed(best_[best].poses, i), first);
      made_[i].iterations += iterations;
    }
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
  std::vector<Best> best_;
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
