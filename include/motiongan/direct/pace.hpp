// How fast a model moves by itself.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/feet.hpp"
#include "motiongan/motion/percentile.hpp"
#include "motiongan/sample/action_generate.hpp"

namespace motiongan {

namespace detail {

inline constexpr std::size_t pace_samples = 16;

/// The speed over the ground of places [frames]. It is that between points half a second apart, for a body
/// sways.
inline double speed_over(const std::vector<motion::Vec3>& places, double rate) {
  const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(rate / 2)));
  double way = 0, took = 0;
  for (std::size_t f = step; f < places.size(); f += step) {
    const motion::Vec3 &a = places[f - step], &b = places[f];
    way += std::hypot(b[0] - a[0], b[2] - a[2]), took += static_cast<double>(step) / rate;
  }
  return took > 0 ? way / took : 0;
}

/// The seconds that a way takes at a pace. Throws Error, naming what moves, if that is hardly any.
inline double seconds_for_way(const std::string& name, double way, double pace,
                              const motion::Skeleton& skeleton) {
  const double leg = motion::body_unit(skeleton);
  require(pace > 0.1 * leg, "\"", name, "\" moves by ", pace / leg,
          " leg lengths a second, which is too slow to follow a path; give its points times, or the length "
          "of the "
          "motion, or something else to do");
  return way / pace;
}

}  // namespace detail

/// The median speed of the root over the ground in 16 motions of a text, in the model's unit per second.
inline double pace_of(const Dvgan& model, const std::string& text, std::uint64_t seed = 1) {
  const std::size_t root = model.format().layout.root();
  std::vector<double> speeds;
  for (const motion::Motion& m : model.generate(text, {.count = detail::pace_samples, .seed = seed})) {
    std::vector<motion::Vec3> places;
    for (std::size_t f = 0; f < m.frames; ++f) places.push_back(m.position(f, root));
    speeds.push_back(detail::speed_over(places, m.rate));
  }
  return motion::percentile(std::move(speeds), 0.5);
}

/// The same in 16 motions of a class, of three seconds, that continue the priors in turn. Throws Error if
/// there are none.
inline double pace_of(const ActionGan& model, const std::vector<ActionPrior>& priors, std::size_t label,
                      std::uint64_t seed = 1) {
  require(!priors.empty(), "there is no prior to continue");
  std::vector<ActionPrior> some;
  for (std::size_t i = 0; i < detail::pace_samples; ++i) some.push_back(priors[i % priors.size()]);
  const double rate = model.format().rate;
  std::vector<double> speeds;
  for (const motion::PositionClip& clip :
       model.generate(some, ActionSchedule{{label, detail::frames_in(3, rate, "the pace")}},
                      {.with_prior = false, .seed = seed})) {
    std::vector<motion::Vec3> places;
    for (std::size_t f = 0; f < clip.frames; ++f) places.push_back(clip.positions[f * clip.skeleton.size()]);
    speeds.push_back(detail::speed_over(places, rate));
  }
  return motion::percentile(std::move(speeds), 0.5);
}

/// The number of frames that a model takes to go a path of this length at its pace. Throws Error for a text
/// that makes it stand.
inline std::size_t frames_for_way(const Dvgan& model, const std::string& text, double way,
                                  std::uint64_t seed = 1) {
  const double seconds =
      detail::seconds_for_way(text, way, pace_of(model, text, seed), model.format().skeleton());
  return static_cast<std::size_t>(std::ceil(seconds * model.format().rate)) + 1;
}

/// The same for a class, without the prior's frames.
inline std::size_t frames_for_way(const ActionGan& model, const std::vector<ActionPrior>& priors,
                                  std::size_t label, double way, std::uint64_t seed = 1) {
  const double seconds = detail::seconds_for_way(
      model.format().classes.at(label), way, pace_of(model, priors, label, seed), model.format().skeleton());
  return static_cast<std::size_t>(std::ceil(seconds * model.format().rate));
}

}  // namespace motiongan
