// Cleaning up a motion that was generated or measured: trembling is filtered, floating bodies are put down,
// and feet that touch the floor are held where they stand.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/legs.hpp"
#include "motiongan/motion/percentile.hpp"
#include "motiongan/motion/root_joint.hpp"
#include "motiongan/motion/smooth.hpp"

namespace motiongan::motion {

/// What clean() does. Lengths are in metres, speeds in metres per second.
struct CleanOptions {
  bool smooth = true;                         ///< filter rotations and root with low_pass()
  double cutoff = 2;                          ///< of the filter, Hz
  bool feet = true;                           ///< put the body on the floor and hold standing feet still
  double unit_metres = 0;                     ///< the file's unit in metres; 0: unknown, a leg counts as 1 m
  std::vector<std::string> foot_joints = {};  ///< names of the feet; empty: find_feet()
  std::optional<double> floor = {};           ///< floor height in the file's unit; unset: from the feet
  double touch_height = 0.06,
         leave_height = 0.1;                  ///< a foot comes to stand below the one, until above the other
  double touch_speed = 1.3, leave_speed = 2;  ///< and slower than the one, until faster than the other
  double shortest = 0.1;                      ///< seconds that a foot stands at least
  double blend = 0.12;                        ///< seconds in which a held foot is let go, and taken hold of
  double play = 0.04;                         ///< a standing foot may be that far above or below the floor
  std::size_t given = 0;  ///< first frames, to stay as they are; twice `blend` after them all is changed
  double airborne = 0.7;  ///< seconds after which a body above the floor is not jumping but floating
};

/// Throws Error for options out of range.
inline void check(const CleanOptions& o) {
  require(o.cutoff > 0 && o.unit_metres >= 0 && o.touch_height > 0 && o.leave_height >= o.touch_height &&
              o.touch_speed > 0 && o.leave_speed >= o.touch_speed && o.shortest >= 0 && o.blend >= 0 &&
              o.airborne > 0,
          "cleaning: cutoff ", o.cutoff, ", unit ", o.unit_metres, ", heights ", o.touch_height, " and ",
          o.leave_height, ", speeds ", o.touch_speed, " and ", o.leave_speed, ", times ", o.shortest, ", ",
          o.blend, " and ", o.airborne, "; expected values above 0, each second one no less than the first");
}

namespace clean_detail {

/// Over the ground, per frame: the way over three frames, so that trembling does not count, times
/// `per_frame`.
inline std::vector<double> ground_speeds(const std::vector<Vec3>& places, double per_frame) {
  std::vector<double> out;
  for (std::size_t f = 0; f < places.size(); ++f) {
    const std::size_t before = f > 0 ? f - 1 : 0, after = std::min(f + 1, places.size() - 1);
    const double frames = static_cast<double>(std::max<std::size_t>(after - before, 1));
    out.push_back(std::hypot(places[after][0] - places[before][0], places[after][2] - places[before][2]) /
                  frames * per_frame);
  }
  return out;
}

}  // namespace clean_detail

/// Frames first .. last - 1 in which a foot stands.
struct FootContact {
  std::size_t first = 0, last = 0;
};

/// When a foot stands: it is low and slow, with hysteresis, for at least the shortest time. While it lands
/// and leaves it does not: that is where, at either end, it is much faster or higher than on the whole.
/// `places` are its positions in the world, one per frame, in a unit of 1 / `metre` metres.
inline std::vector<FootContact> foot_contacts(const std::vector<Vec3>& places, double rate, double floor,
                                              double metre, const CleanOptions& options = {}) {
  std::vector<FootContact> out;
  const std::vector<double> speeds = clean_detail::ground_speeds(places, rate / metre);
  const auto height = [&](std::size_t f) { return (places[f][1] - floor) / metre; };
  bool stands = false;
  for (std::size_t f = 0; f < places.size(); ++f) {
    const bool now = height(f) < (stands ? options.leave_height : options.touch_height) &&
                     speeds[f] < (stands ? options.leave_speed : options.touch_speed);
    if (now && !stands) out.push_back({f, f});
    if (now) out.back().last = f + 1;
    stands = now;
  }
  for (FootContact& c : out) {
    std::vector<double> speed, high;
    for (std::size_t f = c.first; f < c.last; ++f) speed.push_back(speeds[f]), high.push_back(height(f));
    const double fastest = 1.5 * percentile(std::move(speed), 0.5) + 0.3,
                 highest = percentile(std::move(high), 0.5) + 0.03;
    const auto moves = [&](std::size_t f) { return speeds[f] > fastest || height(f) > highest; };
    while (c.last > c.first && moves(c.last - 1)) --c.last;
    while (c.last > c.first && moves(c.first)) ++c.first;
  }
  std::erase_if(out, [&](const FootContact& c) {
    return c.last == c.first || static_cast<double>(c.last - c.first) < options.shortest * rate;
  });
  return out;
}

/// The height of the floor that the feet of find_feet() stand on: the 5th percentile of their heights, so
/// that some outliers below do not count. In the file's unit. Throws Error if there are no feet.
inline double floor_under(const Motion& motion, std::span<const std::string> foot_joints = {}) {
  const std::vector<Vec3> places = joint_positions(motion);
  std::vector<double> heights;
  for (const std::size_t foot : find_feet(motion.skeleton, foot_joints))
    for (std::size_t f = 0; f < motion.frames; ++f)
      heights.push_back(places[f * motion.skeleton.size() + foot][1]);
  return percentile(std::move(heights), 0.05);
}

/// Moves `joint` of frame f, and what hangs on it, by a vector of the world.
inline void shift(Motion& motion, std::size_t f, std::size_t joint, Vec3 by) {
  const int parent = motion.skeleton.joints[joint].parent;
  if (parent >= 0)
    by = rotate(inverse(world_joint(motion, f, static_cast<std::size_t>(parent)).rotation), by);
  motion.position(f, joint) = add(motion.position(f, joint), by);
}

/// The same, up by `rise`.
inline void raise(Motion& motion, std::size_t f, std::size_t joint, double rise) {
  shift(motion, f, joint, {0, rise, 0});
}

namespace clean_detail {

/// Largest (sign 1) or smallest (sign -1) value within `reach` frames of each frame.
inline std::vector<double> extremes(const std::vector<double>& values, std::size_t reach, double sign) {
  std::vector<double> out(values.size());
  for (std::size_t f = 0; f < values.size(); ++f) {
    double most = sign * values[f];
    for (std::size_t g = f - std::min(f, reach); g <= std::min(f + reach, values.size() - 1); ++g)
      most = std::max(most, sign * values[g]);
    out[f] = sign * most;
  }
  return out;
}

inline std::vector<double> smoothed(const std::vector<double>& values, double cutoff, double rate) {
  const std::vector<double> kernel = gaussian_kernel(cutoff, rate);
  std::vector<double> out(values.size());
  for (std::size_t f = 0; f < values.size(); ++f)
    out[f] = filtered(kernel, values.size(), f, [&](std::size_t i) { return values[i]; });
  return out;
}

/// 0 .. 1 with a slope of 0 at both ends.
inline double ease(double t) { return t * t * (3 - 2 * t); }

/// One clean-up: the motion, and what is found in it.
class Cleaner {
 public:
  Cleaner(Motion motion, const CleanOptions& options)
      : motion_(std::move(motion)),
        options_(options),
        legs_(find_legs(motion_.skeleton, options.foot_joints)),
        root_(static_cast<std::size_t>(moving_root(motion_))) {
    std::vector<std::size_t> feet;
    for (const Leg& leg : legs_) feet.push_back(leg.foot);
    metre_ = options.unit_metres > 0 ? 1 / options.unit_metres : leg_length(motion_.skeleton, feet);
  }

  Motion run() {
    if (motion_.frames < 3) return std::move(motion_);
    floor_ = options_.floor.value_or(floor_under(motion_, options_.foot_joints));
    put_down(places());
    const std::vector<std::vector<Vec3>> feet = places();
    std::vector<std::vector<Vec3>> moves;  // of each foot, in each frame
    for (const auto& foot : feet) moves.push_back(holding(foot));
    lower_for(moves);
    for (std::size_t l = 0; l < legs_.size(); ++l)
      for (std::size_t f = 0; f < motion_.frames; ++f) {
        const Leg& leg = legs_[l];
        const Vec3 ankle = world_joint(motion_, f, leg.ankle).position,
                   foot = world_joint(motion_, f, leg.foot).position, wish = add(feet[l][f], moves[l][f]);
        const Vec3 move = subtract(wish, foot);
        if (length(move) > 1e-6 * metre_) reach(motion_, f, leg, add(ankle, move));
      }
    return std::move(motion_);
  }

 private:
  /// Of the feet, in the world: [legs][frames].
  std::vector<std::vector<Vec3>> places() const {
    const std::vector<Vec3> all = joint_positions(motion_);
    std::vector<std::vector<Vec3>> out(legs_.size());
    for (std::size_t l = 0; l < legs_.size(); ++l)
      for (std::size_t f = 0; f < motion_.frames; ++f)
        out[l].push_back(all[f * motion_.skeleton.size() + legs_[l].foot]);
    return out;
  }

  /// Takes away the height of the lower foot above the floor where it stays up for longer than a jump takes:
  /// an opening (Serra 1982), which keeps shorter rises as they are. Feet below the floor are raised.
  void put_down(const std::vector<std::vector<Vec3>>& feet) {
    std::vector<double> lowest(motion_.frames);
    for (std::size_t f = 0; f < motion_.frames; ++f) {
      lowest[f] = feet[0][f][1];
      for (const auto& foot : feet) lowest[f] = std::min(lowest[f], foot[f][1]);
      lowest[f] -= floor_;
    }
    const auto reach = static_cast<std::size_t>(std::round(options_.airborne * motion_.rate / 2));
    std::vector<double> rise = extremes(extremes(lowest, reach, -1), reach, 1);
    for (double& r : rise)
      r = std::max(r - options_.play * metre_, std::min(r + options_.play * metre_, 0.0));
    rise = smoothed(rise, 1 / options_.airborne, motion_.rate);
    for (std::size_t f = 0; f < motion_.frames; ++f) raise(motion_, f, root_, -rise[f]);
  }

  /// How far a foot has to move in each frame to stand still where it stands; between two stands it is let go
  /// and taken hold of smoothly, and it never goes below the floor.
  std::vector<Vec3> holding(const std::vector<Vec3>& foot) const {
    const std::vector<FootContact> contacts = foot_contacts(foot, motion_.rate, floor_, metre_, options_);
    std::vector<Vec3> out(motion_.frames, Vec3{});
    const std::vector<double> speeds = ground_speeds(foot, motion_.rate / metre_);
    for (const FootContact& c : contacts) {
      Vec3 middle{};  // where it is slow counts more
      double weights = 0;
      for (std::size_t f = c.first; f < c.last; ++f) {
        const double slow = 1 / (speeds[f] + 0.1), weight = slow * slow;
        middle = add(middle, scale(foot[f], weight));
        weights += weight;
      }
      middle = scale(middle, 1 / weights);
      middle[1] = std::max(middle[1], floor_);
      for (std::size_t f = c.first; f < c.last; ++f) out[f] = subtract(middle, foot[f]);
    }
    const double blend = options_.blend * motion_.rate;
    for (std::size_t c = 0; c <= contacts.size() && !contacts.empty(); ++c) {
      const std::size_t begin = c > 0 ? contacts[c - 1].last : 0,
                        end = c < contacts.size() ? contacts[c].first : motion_.frames;
      const double most = std::min(blend, static_cast<double>(end - begin + 1) / 2);
      const auto share = [&](std::size_t distance) {  // of a move, that many frames from where it is whole
        const double t = std::clamp(1 - static_cast<double>(distance) / (most + 0.5), 0.0, 1.0);
        return ease(t);
      };
      for (std::size_t f = begin; f < end; ++f) {
        if (c > 0) out[f] = add(out[f], scale(out[begin - 1], share(f - begin + 1)));
        if (c < contacts.size()) out[f] = add(out[f], scale(out[end], share(end - f)));
      }
    }
    for (std::size_t f = 0; f < motion_.frames; ++f) out[f][1] = std::max(out[f][1], floor_ - foot[f][1]);
    return out;
  }

  /// Lowers the body, smoothly, where a leg would not reach its foot.
  void lower_for(const std::vector<std::vector<Vec3>>& moves) {
    std::vector<double> drop(motion_.frames, 0);
    for (std::size_t l = 0; l < legs_.size(); ++l)
      for (std::size_t f = 0; f < motion_.frames; ++f) {
        if (length(moves[l][f]) < 1e-6 * metre_) continue;
        const Leg& leg = legs_[l];
        const Vec3 hip = world_joint(motion_, f, leg.thigh).position,
                   knee = world_joint(motion_, f, leg.knee).position,
                   ankle = world_joint(motion_, f, leg.ankle).position, target = add(ankle, moves[l][f]);
        const double most = most_stretch * (length(subtract(knee, hip)) + length(subtract(ankle, knee)));
        const double across = std::hypot(hip[0] - target[0], hip[2] - target[2]), above = hip[1] - target[1];
        if (std::hypot(across, above) <= most || across >= most || above <= 0) continue;
        drop[f] = std::max(drop[f], above - std::sqrt(most * most - across * across));
      }
    const auto reach = static_cast<std::size_t>(std::round(options_.blend * motion_.rate));
    const std::vector<double> smooth =
        smoothed(extremes(drop, reach, 1), 1 / (2 * std::max(options_.blend, 1e-3)), motion_.rate);
    for (std::size_t f = 0; f < motion_.frames; ++f) raise(motion_, f, root_, -std::max(smooth[f], 0.0));
  }

  Motion motion_;
  CleanOptions options_;
  std::vector<Leg> legs_;
  std::size_t root_ = 0;
  double metre_ = 1, floor_ = 0;
};

/// Moves frame f of `to` towards the same frame of `from`, which it becomes where `share` is 0.
inline void blend_frame(const Motion& from, Motion& to, std::size_t f, double share) {
  for (std::size_t j = 0; j < to.skeleton.size(); ++j) {
    to.rotation(f, j) = slerp(from.rotation(f, j), to.rotation(f, j), share);
    to.position(f, j) = add(scale(from.position(f, j), 1 - share), scale(to.position(f, j), share));
  }
}

/// `to`, with the first `given` frames of `from` and a smooth change over `blend` frames after them. Both
/// begin with frame `first` of a longer motion, which `given` counts in; 0: `to` as it is.
inline Motion after_given(const Motion& from, Motion to, std::size_t given, double blend,
                          std::size_t first = 0) {
  for (std::size_t f = 0; given > 0 && f < to.frames; ++f) {
    const double t =
        first + f < given ? 0 : std::min((static_cast<double>(first + f - given) + 1) / (blend + 1), 1.0);
    if (t == 1) break;
    blend_frame(from, to, f, ease(t));
  }
  return to;
}

}  // namespace clean_detail

/// The motion cleaned up: low_pass(), which leaves what follows alone; then the body is put down where it
/// floats, and feet are held still while they stand, by bending the legs. Works on any skeleton with two
/// legs. Throws Error for options out of range and, with `feet`, for a skeleton without legs.
inline Motion clean(const Motion& motion, const CleanOptions& options = {}) {
  check_motion(motion);
  check(options);
  Motion out = options.smooth ? low_pass(motion, options.cutoff) : motion;
  if (options.feet) out = clean_detail::Cleaner(std::move(out), options).run();
  return clean_detail::after_given(motion, std::move(out), options.given, 2 * options.blend * motion.rate);
}

}  // namespace motiongan::motion
