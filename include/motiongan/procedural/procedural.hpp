// Built-in human motion: captioned clips computed from a few curves, so that training, the demo and the tests
// need no download. The actions are in locomotion.hpp, gestures.hpp and stunts.hpp.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/data/labelled_motion.hpp"
#include "motiongan/procedural/gestures.hpp"
#include "motiongan/procedural/locomotion.hpp"
#include "motiongan/procedural/stunts.hpp"

namespace motiongan::motion {

/// Options of procedural_motions().
struct ProceduralOptions {
  std::size_t clips = 64;  ///< how many
  double seconds = 10;     ///< length of each clip
  double rate = 30;        ///< frames per second
  std::uint64_t seed = 1;  ///< the same seed gives the same clips
};

namespace procedural {

struct Action {
  std::string_view name;
  Performance (*perform)(Performer);
};

inline constexpr std::array<Action, 17> actions{{{"walk", walk},
                                                 {"run", run},
                                                 {"jump", jump},
                                                 {"wave", wave_hand},
                                                 {"squat", squat},
                                                 {"kick", kick},
                                                 {"turn", turn},
                                                 {"punch", punch},
                                                 {"bow", bow},
                                                 {"stand", stand},
                                                 {"clap", clap},
                                                 {"march", march},
                                                 {"sit", sit},
                                                 {"sidestep", sidestep},
                                                 {"stretch", stretch},
                                                 {"jumping_jack", jumping_jack},
                                                 {"throw", throw_ball}}};

}  // namespace procedural

/// Names of the built-in actions; clip i shows action i modulo their number.
inline std::vector<std::string> procedural_actions() {
  std::vector<std::string> names;
  for (const procedural::Action& a : procedural::actions) names.emplace_back(a.name);
  return names;
}

/// Clip number `index` of a set, with id "walk_000", "run_001", ... It depends only on (seed, index); a
/// longer clip or a higher rate shows the same movement. Throws Error unless length and rate give 2 to 100
/// million frames.
inline LabelledMotion procedural_motion(std::size_t index, const ProceduralOptions& options = {}) {
  require(std::isfinite(options.rate) && options.rate > 0 && std::isfinite(options.seconds) &&
              options.seconds * options.rate >= 1.5 && options.seconds * options.rate < 1e8,
          "procedural motion of ", options.seconds, " s at ", options.rate,
          " frames per second: expected positive numbers that give between 2 and 100 million frames");
  const std::size_t count = procedural::actions.size();
  const procedural::Action& action = procedural::actions[index % count];
  const procedural::Performance performance =
      action.perform(procedural::Performer(options.seed, index, index / count));

  LabelledMotion out;
  const std::string number = std::to_string(index);
  out.id =
      std::string(action.name) + "_" + std::string(number.size() < 3 ? 3 - number.size() : 0, '0') + number;
  out.captions = performance.captions;
  Motion& m = out.motion;
  m.skeleton = procedural_skeleton();
  m.rate = options.rate;
  m.frames = static_cast<std::size_t>(std::llround(options.seconds * options.rate));
  const std::size_t joints = m.skeleton.size();
  m.rotations.resize(m.frames * joints);
  m.positions.resize(m.frames * joints);
  for (std::size_t f = 0; f < m.frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) m.position(f, j) = m.skeleton.joints[j].offset;
    const procedural::BodyTarget body = performance.body(static_cast<double>(f) / options.rate);
    m.position(f, 0) = procedural::pose_body(body, &m.rotation(f, 0));
    // q and -q are the same rotation: take the one nearer to the previous frame.
    for (std::size_t j = 0; f > 0 && j < joints; ++j) {
      Quat& q = m.rotation(f, j);
      if (dot(q, m.rotation(f - 1, j)) < 0) q = {-q.w, -q.x, -q.y, -q.z};
    }
  }
  return out;
}

/// `options.clips` captioned clips of human motion, cycling through all actions, on procedural_skeleton(), in
/// centimetres. The same seed gives the same clips (up to rounding of the platform's sine).
inline std::vector<LabelledMotion> procedural_motions(const ProceduralOptions& options = {}) {
  std::vector<LabelledMotion> out;
  out.reserve(options.clips);
  for (std::size_t i = 0; i < options.clips; ++i) out.push_back(procedural_motion(i, options));
  return out;
}

}  // namespace motiongan::motion
