// The style of one clip, and the stance that every action starts from.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/procedural/body.hpp"

namespace motiongan::motion::procedural {

/// One clip: the body at any time (seconds, from 0) and its captions.
struct Performance {
  std::function<BodyTarget(double)> body;
  std::vector<std::string> captions;
};

/// The style of one clip. Captions mention it if it is slow, fast, small or big.
struct Performer {
  Dice dice;
  std::uint64_t seed = 0;  ///< for variation between repetitions
  std::size_t side = 0;    ///< 0 left, 1 right
  double tempo = 1;        ///< 0.72 to 1.4
  double size = 1;         ///< 0.65 to 1.35
  double start = 0;        ///< phase of the action at time 0
  double stance = 10;      ///< from the centre line to either foot, cm
  double toe_out = 8, hang = 8, elbow = 16, stoop = 3, restless = 1;
  std::array<double, 4> drift{};  ///< phases of slow movements

  /// `repetition` is the number of earlier clips of the action: sides and the slow, middle and fast thirds of
  /// the tempo alternate, so that even a small set has them all.
  Performer(std::uint64_t set_seed, std::size_t index, std::size_t repetition)
      : dice(set_seed, index), seed(dice.next()), side(repetition % 2) {
    tempo = third(repetition / 2 + dice.pick(2), 0.72, 1.4);
    size = third(dice.pick(3), 0.65, 1.35);
    start = dice.uniform(0, 1);
    stance = dice.uniform(8.5, 12);
    toe_out = dice.uniform(4, 13);
    hang = dice.uniform(6, 11);
    elbow = dice.uniform(10, 26);
    stoop = dice.uniform(0, 7);
    restless = dice.uniform(0.5, 1.5);
    for (double& d : drift) d = dice.uniform(0, 1);
  }

  double sign() const { return side == 0 ? 1 : -1; }
  const char* side_name() const { return side == 0 ? "left" : "right"; }

  const char* tempo_word() const { return tempo < 0.92 ? "slowly" : tempo > 1.15 ? "quickly" : ""; }
  /// `small` or `big` by size; empty for middle sizes.
  std::string size_word(const char* small, const char* big) const {
    return size < 0.87 ? small : size > 1.13 ? big : "";
  }

  /// Standing at ease, feet side by side: breathing, shifting weight slightly, never quite still.
  BodyTarget standing(double t) const {
    const double breath = wave(0.27 * t + drift[0]), sway = wave(0.11 * t + drift[1]);
    const double glance = wave(0.07 * t + drift[2]), slow = wave(0.16 * t + drift[3]);
    BodyTarget b;
    b.x = 0.9 * restless * sway;
    b.z = -1 + 0.5 * restless * slow;
    b.pitch = 1.5;
    b.roll = -0.7 * restless * sway;
    b.bend = stoop + 0.8 * breath;
    b.side_bend = 0.8 * restless * sway;
    b.twist = 1.5 * restless * glance;
    b.nod = -0.6 * stoop - 0.6 * breath + 1.5 * restless * slow;
    b.head_turn = 4 * restless * glance;
    b.head_tilt = 1.2 * restless * slow;
    for (std::size_t i = 0; i < 2; ++i) {
      const double s = i == 0 ? 1 : -1;
      b.feet[i].x = s * stance;
      b.feet[i].yaw = s * toe_out;
      b.arms[i] = {.flexion = 2 + 1.2 * restless * s * slow,
                   .abduction = hang + 0.6 * breath,
                   .twist = -12,
                   .elbow = elbow + 1.5 * restless * sway,
                   .wrist_side = 4,
                   .wrist_flexion = 4};
    }
    return b;
  }

 private:
  double third(std::size_t which, double low, double high) {
    const double step = (high - low) / 3;
    const double at = low + step * static_cast<double>(which % 3);
    return dice.uniform(at, at + step);
  }
};

/// "walk" and "slowly" to "walk slowly"; an empty word adds nothing.
inline std::string join(const std::string& text, const std::string& word) {
  return word.empty() ? text : text + " " + word;
}

/// The captions without empty ones and duplicates, in order.
inline std::vector<std::string> distinct(std::vector<std::string> captions) {
  std::vector<std::string> out;
  for (std::string& c : captions)
    if (!c.empty() && std::find(out.begin(), out.end(), c) == out.end()) out.push_back(std::move(c));
  return out;
}

/// Linear interpolation between two arm poses given by angles: a at w = 0, b at w = 1.
inline ArmTarget blend(const ArmTarget& a, const ArmTarget& b, double w) {
  const auto mix = [w](double x, double y) { return x + w * (y - x); };
  return {.flexion = mix(a.flexion, b.flexion),
          .abduction = mix(a.abduction, b.abduction),
          .twist = mix(a.twist, b.twist),
          .elbow = mix(a.elbow, b.elbow),
          .wrist_side = mix(a.wrist_side, b.wrist_side),
          .wrist_flexion = mix(a.wrist_flexion, b.wrist_flexion)};
}

}  // namespace motiongan::motion::procedural
