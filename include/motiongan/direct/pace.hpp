// How fast a model moves by itself.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "motiongan/models/dvgan.hpp"
#include "motiongan/motion/feet.hpp"

namespace motiongan {

/// The median speed of the root over the ground in 16 motions of a text, in the model's unit per second.
inline double pace_of(const Dvgan& model, const std::string& text, std::uint64_t seed = 1) {
  const std::size_t root = model.format().layout.root();
  std::vector<double> speeds;
  for (const motion::Motion& m : model.generate(text, {.count = 16, .seed = seed})) {
    // The way between points half a second apart: the body sways.
    const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(m.rate / 2)));
    double way = 0, took = 0;
    for (std::size_t f = step; f < m.frames; f += step) {
      const motion::Vec3 &a = m.position(f - step, root), &b = m.position(f, root);
      way += std::hypot(b[0] - a[0], b[2] - a[2]), took += static_cast<double>(step) / m.rate;
    }
    speeds.push_back(took > 0 ? way / took : 0);
  }
  std::nth_element(speeds.begin(), speeds.begin() + 8, speeds.end());
  return speeds[8];
}

/// The number of frames that a model takes to go a path of this length at its pace. Throws Error for a text
/// that makes it stand.
inline std::size_t frames_for_way(const Dvgan& model, const std::string& text, double way,
                                  std::uint64_t seed = 1) {
  const double pace = pace_of(model, text, seed), leg = motion::body_unit(model.format().skeleton());
  require(
      pace > 0.1 * leg, "\"", text, "\" moves by ", pace / leg,
      " leg lengths a second, which is too slow to follow a path; give its points times, or the number of "
      "frames, or another text");
  return static_cast<std::size_t>(std::ceil(way / pace * model.format().rate)) + 1;
}

}  // namespace motiongan
