// What the tests of the C interface share: the models, handles that close themselves, values of motions.
#pragma once
#include <doctest/doctest.h>
#include <motiongan.h>

#include <motiongan/motion/kinematics.hpp>
#include <string>
#include <vector>

#include "../support/folders.hpp"
#include "models.hpp"

namespace motiongan::testing {

/// The models, written once.
inline const ModelFiles& files() {
  static const Scratch folder;
  static const ModelFiles all = [] {
    write_models({folder.path});
    return ModelFiles{folder.path};
  }();
  return all;
}

/// A handle that is closed at the end.
struct Handle {
  std::uint64_t value = 0;
  Handle() = default;
  explicit Handle(std::uint64_t v) : value(v) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { motiongan_close(value); }
  operator std::uint64_t() const { return value; }
};

#define CHECK_OK(call) CHECK_MESSAGE((call) == MOTIONGAN_OK, motiongan_last_error())
#define REQUIRE_OK(call) REQUIRE_MESSAGE((call) == MOTIONGAN_OK, motiongan_last_error())

inline std::uint64_t open(const std::string& path) {
  motiongan_model model = 0;
  REQUIRE_OK(motiongan_model_open(path.c_str(), nullptr, &model));
  return model;
}
inline std::uint64_t read(const std::string& path) {
  motiongan_clip clip = 0;
  REQUIRE_OK(motiongan_clip_read(path.c_str(), &clip));
  return clip;
}

/// A motion's values as the C interface gives them.
struct Values {
  std::vector<float> rotations, positions, global;
  bool operator==(const Values&) const = default;
};
inline void append(Values& out, const motion::Motion& m) {
  for (const motion::Quat& q : m.rotations)
    for (const double v : {q.x, q.y, q.z, q.w}) out.rotations.push_back(static_cast<float>(v));
  for (const motion::Vec3& p : m.positions)
    for (const double v : p) out.positions.push_back(static_cast<float>(v));
  for (const motion::Vec3& p : motion::joint_positions(m))
    for (const double v : p) out.global.push_back(static_cast<float>(v));
}

inline motiongan_start start_of(const char* prompt, std::uint32_t sample, motiongan_clip from = 0) {
  motiongan_start out{};
  out.prompt = prompt;
  out.seed = 7;
  out.sample = sample;
  out.prior = from;
  return out;
}

}  // namespace motiongan::testing
