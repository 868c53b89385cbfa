// Directed motion of class-conditioned models: their noise and class are chosen so that what they make meets
// constraints.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "motiongan/direct/action_noise.hpp"
#include "motiongan/direct/checks.hpp"
#include "motiongan/direct/exact.hpp"
#include "motiongan/direct/noise_search.hpp"
#include "motiongan/motion/position_rotations.hpp"

namespace motiongan {

/// A motion of classes that is asked for. Times count from the prior's last frame, as those of a schedule do.
struct ActionDirectTask {
  ActionPrior prior;  ///< the second that it continues
  std::vector<Constraint> constraints = {};
  /// Where the root is in the prior's last frame; not set: where the prior has it.
  std::optional<motion::RootTrack> start = {};
};

/// A motion of classes and how well it meets what was asked for.
struct DirectedAction {
  motion::PositionClip clip;                 ///< the prior, placed as asked, and then what is made
  std::size_t given = 0;                     ///< frames of the prior
  std::vector<ConstraintError> errors = {};  ///< one for each constraint
  std::size_t iterations = 0;

  /// Whether every error is within its tolerance.
  bool met() const { return largest_excess(errors) <= 1; }
};

/// From the prior's last frame on, which is time 0 for constraints.
inline motion::PositionClip from_last_given(const DirectedAction& made) {
  motion::PositionClip out = made.clip;
  const std::size_t left_out = made.given - 1;
  out.positions.erase(out.positions.begin(),
                      out.positions.begin() + static_cast<std::ptrdiff_t>(left_out * out.skeleton.size()));
  out.frames -= left_out;
  return out;
}

/// The prior moved over the ground and turned, so that its last frame stands and faces as `to`.
inline ActionPrior placed_at(ActionPrior prior, const motion::RootTrack& to) {
  const motion::RootTrack last = prior.places.back();
  const double turn = to.yaw - last.yaw;
  const auto move = [&](double& x, double& z) {
    x -= last.x, z -= last.z;
    motion::turn_ground(x, z, turn);
    x += to.x, z += to.z;
  };
  for (motion::Vec3& p : prior.positions) move(p[0], p[2]);
  for (motion::RootTrack& at : prior.places) move(at.x, at.z), at.yaw += turn;
  return prior;
}

namespace detail {

/// Directs several motions of one schedule, a few seconds at a time.
class ActionDirector {
 public:
  ActionDirector(ActionGan& model, const std::vector<ActionDirectTask>& tasks, const ActionSchedule& schedule,
                 const DirectOptions& options)
      : model_(model),
        format_(model.format()),
        body_(directed_body(format_)),
        tasks_(tasks),
        options_(options),
        steps_(steps_of(schedule, format_.frames)) {
    const std::size_t frames = frames_of(schedule);
    require(frames >= 2, "a directed motion has ", frames, " frames, expected at least 2");
    require(options.starts > 0, "starts is 0, expected at least 1");
    seconds_ = static_cast<double>(frames) / format_.rate;
    for (const ActionDirectTask& task : tasks) {
      require(task.prior.poses.size() == format_.frames * format_.dof() && !task.prior.places.empty(),
              "the prior ", task.prior.id, " has ", task.prior.poses.size(), " values, expected ",
              format_.frames, " frames of ", format_.dof());
      const ActionPrior prior = task.start ? placed_at(task.prior, *task.start) : task.prior;
      check_constraints(body_, task.constraints, prior.places.back(), seconds_);
      made_.push_back({.clip = {prior.id, prior.skeleton, format_.rate, format_.frames, prior.positions},
                       .given = format_.frames});
      poses_.push_back(prior.poses);
      tracks_.push_back(prior.places.back());
    }
  }

  std::vector<DirectedAction> run() {
    const Frozen fixed(named_parameters(model_));
    const std::size_t windows = (steps_.size() + steps_together - 1) / steps_together;
    for (std::size_t w = 0; w < windows; ++w) {
      const std::size_t first = w * steps_together, count = std::min(steps_together, steps_.size() - first);
      direct_steps({w, windows}, first,
                   {steps_.begin() + static_cast<std::ptrdiff_t>(first),
                    steps_.begin() + static_cast<std::ptrdiff_t>(first + count)});
    }
    for (std::size_t i = 0; i < made_.size(); ++i) {
      DirectedAction& made = made_[i];
      if (options_.exact) correct(made, tasks_[i].constraints);
      made.errors = constraint_errors(format_, from_last_given(made), tasks_[i].constraints);
    }
    return std::move(made_);
  }

 private:
  static constexpr std::size_t steps_together = 4;  // seconds that are searched for at once

  /// Of positions [frames, joints] from frame `first` on.
  std::vector<ConstraintError> errors_of(const std::vector<motion::Vec3>& positions,
                                         const motion::Skeleton& skeleton,
                                         const std::vector<Constraint>& constraints,
                                         std::size_t first) const {
    return ErrorMeter(world_poses(format_.layout, positions), skeleton, format_.rate, body_.read, first,
                      seconds_)(constraints);
  }

  /// What is asked of a task's frames from `first` on. A loop that began before them ends with the poses that
  /// it began with.
  std::vector<Constraint> constraints_of(std::size_t task, std::size_t first) const {
    std::vector<Constraint> out = tasks_[task].constraints;
    if (first == 0) return out;
    for (Constraint& c : out)
      if (const auto* const loop = std::get_if<LoopConstraint>(&c))
        c = PoseConstraint{.time = loop->seconds > 0 ? loop->seconds : seconds_,
                           .pose = slice(motion_from_positions(from_last_given(made_[task])), 0, 2),
                           .weight = loop->weight,
                           .tolerance = loop->tolerance};
    return out;
  }

  void direct_steps(const SearchWindow& window, std::size_t step, const ActionSchedule& steps) {
    const Context& context = model_.context();
    const std::size_t tasks = tasks_.size(), starts = options_.starts, batch = tasks * starts,
                      dof = format_.dof(), second = format_.frames;
    const std::size_t first = made_.front().clip.frames - second;  // of the last frame that is known
    std::size_t frames = 1;
    for (const ActionPiece& s : steps) frames += s.frames;
    DirectObjective objective(context, format_, frames, batch, first);
    std::vector<std::vector<Constraint>> asked;
    std::vector<std::vector<float>> priors;
    for (std::size_t i = 0; i < tasks; ++i) {
      asked.push_back(constraints_of(i, first));
      const motion::RootTrack anchor = facing(made_[i].clip);
      for (std::size_t s = 0; s < starts; ++s) objective.add(i * starts + s, asked[i], anchor, seconds_);
      priors.insert(priors.end(), starts,
                    {poses_[i].end() - static_cast<std::ptrdiff_t>(second * dof), poses_[i].end()});
    }
    objective.finish(context);
    const RandomKey key{.seed = options_.seed,
                        .first_sample = static_cast<std::uint32_t>(options_.first_sample * starts),
                        .first_frame = static_cast<std::int32_t>(step)};
    ActionNoise noise(model_, steps, batch_of(context, priors, dof), key);
    NoiseSearch search(options_, tasks);
    const std::size_t iterations =
        search.run(noise, objective, window, [&](std::size_t task, const std::vector<float>& poses) {
          const motion::PositionClip& clip = made_[task].clip;
          std::vector<motion::Vec3> positions{
              clip.positions.end() - static_cast<std::ptrdiff_t>(clip.skeleton.size()), clip.positions.end()};
          motion::RootTrack track = tracks_[task];
          const std::vector<motion::Vec3> next = format_.decode(std::span(poses).subspan(dof), &track);
          positions.insert(positions.end(), next.begin(), next.end());
          return largest_excess(errors_of(positions, clip.skeleton, asked[task], first));
        });
    const std::vector<float> scores = scores_of(search, priors, steps);
    for (std::size_t i = 0; i < tasks; ++i) {
      const std::span<const float> next = std::span(search.chosen(i, scores, window)).subspan(dof);
      const std::vector<motion::Vec3> positions = format_.decode(next, &tracks_[i]);
      motion::PositionClip& clip = made_[i].clip;
      clip.positions.insert(clip.positions.end(), positions.begin(), positions.end());
      clip.frames += frames - 1;
      poses_[i].insert(poses_[i].end(), next.begin(), next.end());
      made_[i].iterations += iterations;
    }
  }

  /// Where the last frame is and faces.
  motion::RootTrack facing(const motion::PositionClip& clip) const {
    const WorldPose last =
        world_poses(format_.layout, std::span(clip.positions).last(clip.skeleton.size())).front();
    return {last.x, last.z, last.yaw, true};
  }

  /// The critic's mean score of the seconds that were made whole, [samples]; empty without a critic, or
  /// without such a second.
  std::vector<float> scores_of(const NoiseSearch& search, const std::vector<std::vector<float>>& priors,
                               const ActionSchedule& steps) const {
    if (!options_.score_pairs) return {};
    const Context& context = model_.context();
    const NoGrad values_only;
    std::vector<std::vector<float>> all = search.best();
    for (std::size_t b = 0; b < all.size(); ++b)  // the prior's last frame is in both
      all[b].insert(all[b].begin(), priors[b].begin(),
                    priors[b].end() - static_cast<std::ptrdiff_t>(format_.dof()));
    const Var motion = batch_of(context, all, format_.dof());
    std::vector<float> out;
    std::size_t at = 0;
    for (const ActionPiece& step : steps) {
      if (step.frames == format_.frames) {
        const std::vector<std::size_t> labels(all.size(), step.label);
        const std::vector<float> own =
            options_.score_pairs(slice(motion, 0, at, 2 * format_.frames),
                                 Var::constant(one_hot(context, labels, format_.classes.size())));
        out.resize(own.size());
        for (std::size_t b = 0; b < own.size(); ++b) out[b] += own[b];
      }
      at += step.frames;
    }
    return out;
  }

  /// Meets the constraints exactly, by the rotations of what was made.
  void correct(DirectedAction& made, const std::vector<Constraint>& constraints) const {
    const std::size_t joints = made.clip.skeleton.size();
    const std::vector<motion::Vec3> corrected =
        motion::joint_positions(meet_exactly(motion_from_positions(from_last_given(made)), 0, constraints));
    std::copy(corrected.begin() + static_cast<std::ptrdiff_t>(joints), corrected.end(),
              made.clip.positions.begin() + static_cast<std::ptrdiff_t>(made.given * joints));
  }

  ActionGan& model_;
  const motion::PositionFormat& format_;
  DirectedBody body_;
  const std::vector<ActionDirectTask>& tasks_;
  const DirectOptions& options_;
  ActionSchedule steps_;
  double seconds_ = 0;
  // So far, for each task: the motion, its normalised poses, and where the root's track has got to.
  std::vector<DirectedAction> made_;
  std::vector<std::vector<float>> poses_;
  std::vector<motion::RootTrack> tracks_;
};

}  // namespace detail

/// Directs one motion for each task, all by one schedule of classes; they share the batch. A model without
/// noise (noise_dim 0) has its class alone to choose, which does not lead far: train with --noise. The same
/// tasks, options and device give the same bits. The model's weights do not change. Throws Error as
/// check_constraints() does, and for a model without the root's track.
inline std::vector<DirectedAction> direct(ActionGan& model, const std::vector<ActionDirectTask>& tasks,
                                          const ActionSchedule& schedule, const DirectOptions& options = {}) {
  if (tasks.empty()) return {};
  return detail::ActionDirector(model, tasks, schedule, options).run();
}

}  // namespace motiongan
