// What comes between two clips.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "motiongan/direct/direct.hpp"

namespace motiongan {

/// A gap between two motions, at the model's rate and of its joints.
struct Gap {
  std::string text;  ///< what happens in the gap
  motion::Motion before, after;
  double seconds = 1;  ///< from the last frame of one to the first of the other
  /// Where the second motion is stays as it is. Otherwise it begins where the first one gets to.
  bool placed = true;
};

/// A motion over a gap.
struct InBetween {
  motion::Motion motion;             ///< all of it: before, the frames between, after
  std::size_t first = 0, count = 0;  ///< the frames between
  ConstraintError error;             ///< of the poses after the gap, before they were met exactly
  std::size_t iterations = 0;
};

/// The frames between two poses, each the first frame of its motion, if every joint turns evenly from one to
/// the other (slerp) and the root moves evenly.
inline motion::Motion straight_way(const motion::Motion& from, const motion::Motion& to, std::size_t frames) {
  motion::Motion out = slice(from, 0, 1);
  out.frames = frames;
  out.rotations.clear(), out.positions.clear();
  for (std::size_t f = 0; f < frames; ++f) {
    const double t = static_cast<double>(f + 1) / static_cast<double>(frames + 1);
    for (std::size_t j = 0; j < from.skeleton.size(); ++j) {
      out.rotations.push_back(motion::slerp(from.rotation(0, j), to.rotation(0, j), t));
      out.positions.push_back(
          motion::add(motion::scale(from.position(0, j), 1 - t), motion::scale(to.position(0, j), t)));
    }
  }
  return out;
}

namespace detail {

/// Frames on either side of a gap that the motion between has to fit.
inline constexpr std::size_t gap_context = 4;

inline std::size_t frames_between(const Gap& gap, double rate) {
  const std::size_t steps = frame_at(gap.seconds, rate);
  require(gap.before.frames > 0 && gap.after.frames > 0, "a gap needs a motion on either side");
  require(steps >= 2, "a gap of ", gap.seconds, " s has no frames between, at ", rate,
          " per second; expected at least ", 2 / rate, " s");
  return steps - 1;
}

/// `after`, moved over the ground and turned so that its first frame stands and faces as frame `f` of `made`.
inline motion::Motion moved_to(motion::Motion after, const motion::Motion& made, std::size_t f,
                               std::size_t root) {
  const WorldPose to = world_pose(made, f, root);
  return motion::placed_at(std::move(after), root, {to.x, to.z, to.yaw, true}, true);
}

}  // namespace detail

/// Fills gaps of equal length, with the noise chosen so that the motion leads from one clip into the other,
/// not far from the straight way, and at last corrected so that the clips stay as they are. Bodies are those
/// of the motions before. Throws Error as direct() does, and for a gap without frames.
inline std::vector<InBetween> fill_gaps(Dvgan& model, const std::vector<Gap>& gaps, DirectOptions options) {
  const motion::MotionFormat& format = model.format();
  const std::size_t root = format.layout.root();
  std::vector<DirectTask> tasks;
  std::size_t between = 0;
  for (const Gap& gap : gaps) {
    require(gap.seconds == gaps.front().seconds, "gaps that are filled together have equal lengths");
    between = detail::frames_between(gap, format.rate);
    DirectTask task{.text = gap.text};
    const std::size_t before = std::min(detail::gap_context, gap.before.frames),
                      after = std::min(detail::gap_context, gap.after.frames);
    task.given = slice(gap.before, gap.before.frames - before, before);
    options.frames = before + between + after;
    const double time = static_cast<double>(before + between) / format.rate;
    PoseConstraint end{.time = time, .pose = slice(gap.after, 0, after), .placed = gap.placed};
    if (gap.placed) {  // the straight way, as long as nothing speaks against it
      const WorldPose a = world_pose(task.given, before - 1, root), b = world_pose(end.pose, 0, root);
      if (std::hypot(b.x - a.x, b.z - a.z) > 0.5 * motion::body_unit(format.skeleton()))
        task.guides.push_back(PathConstraint{
            .points = {{a.x, a.z, static_cast<double>(before - 1) / format.rate}, {b.x, b.z, time}},
            .weight = 0.1});
    }
    task.guides.push_back(
        PoseConstraint{.time = static_cast<double>(before) / format.rate,
                       .pose = straight_way(slice(task.given, before - 1, 1), slice(end.pose, 0, 1), between),
                       .weight = 0.01});
    task.constraints.push_back(std::move(end));
    tasks.push_back(std::move(task));
  }
  options.exact = false;  // both sides are put in place below
  std::vector<DirectedMotion> made = direct(model, tasks, options);
  std::vector<InBetween> out;
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const Gap& gap = gaps[i];
    const std::size_t before = tasks[i].given.frames, end = before + between;
    motion::Motion& all = made[i].motion;
    motion::Motion after = gap.placed ? gap.after : detail::moved_to(gap.after, all, end, root);
    after.skeleton = gap.before.skeleton;
    const std::vector<Constraint> sides{
        PoseConstraint{.pose = tasks[i].given, .placed = true},
        PoseConstraint{.time = static_cast<double>(end) / format.rate,
                       .pose = slice(after, 0, std::min(detail::gap_context, after.frames)),
                       .placed = true}};
    all.skeleton = gap.before.skeleton;
    // What is off on one side changes evenly into what is off on the other.
    all = meet_exactly(std::move(all), root, sides, std::max(gap.seconds, 0.4));
    out.push_back({.motion = join(join(gap.before, slice(all, before, between)), after),
                   .first = gap.before.frames,
                   .count = between,
                   .error = made[i].errors.front(),
                   .iterations = made[i].iterations});
  }
  return out;
}

}  // namespace motiongan
