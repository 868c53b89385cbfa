// Stepping actions: walk, run, march, turn, sidestep. A gait determines when each foot stands; where it
// stands follows from the path of the body, so feet do not slide at any speed or turn.
#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include "motiongan/procedural/performer.hpp"

namespace motiongan::motion::procedural {

/// A point of the path; `yaw` in degrees.
struct Place {
  double x = 0, z = 0, yaw = 0;
};

struct Gait {
  std::function<Place(double)> path;  ///< of the body, over seconds
  double period = 1.1;                ///< of a left and a right step, seconds
  double duty = 0.62;                 ///< fraction of the period in which a foot stands
  double start = 0;                   ///< phase of the left foot at time 0
  double half_width = 8, toe_out = 7;
  double behind = 5;                 ///< distance of the foot behind the body in mid-stance, cm
  double lift = 5, lift_peak = 0.4;  ///< of the swinging foot, cm, and phase of the swing at its peak
  double push_off = 42, swing_heel = 58,
         strike = 18;   ///< heel rise at push-off and its maximum in the swing; toe rise
  bool always = false;  ///< step even if the path stands still

  /// Phase in [0, 1) of a foot, and the number of its stance.
  Beat beat(double t, std::size_t side) const {
    const double c = t / period + start + (side == 0 ? 0.0 : 0.5), whole = std::floor(c);
    return {.phase = c - whole, .strength = 1, .count = static_cast<std::int64_t>(whole)};
  }

  FootTarget foot(double t, std::size_t side) const {
    const Beat now = beat(t, side);
    const FootTarget here = plant(now.count, side), next = plant(now.count + 1, side);
    const double u = (now.phase - duty) / (1 - duty), moved = ease(u);
    // A foot that stays in place is not lifted.
    const double going = effort(here, next), came = effort(plant(now.count - 1, side), here);
    FootTarget f = here;
    f.x += (next.x - here.x) * moved;
    f.z += (next.z - here.z) * moved;
    f.yaw += (next.yaw - here.yaw) * moved;
    f.lift = going * lift * Curve{{0, 0}, {lift_peak, 1}, {1, 0}}(u);
    const double roll_time = 0.4 * duty;
    f.heel_rise = going * Curve{{duty - roll_time, 0},
                                {duty, push_off, 1.2 * push_off / roll_time},
                                {duty + 0.22 * (1 - duty), swing_heel},
                                {duty + 0.75 * (1 - duty), 0}}(now.phase);
    f.toe_rise = going * strike * Curve{{0.55, 0}, {1, 1}}(u) +
                 came * strike * (1 - ease(now.phase / 0.12)) * (u < 0 ? 1 : 0);
    f.toe_bend = f.heel_rise * (1 - ease(u / 0.6));
    return f;
  }

 private:
  FootTarget plant(std::int64_t count, std::size_t side) const {
    const double cycles = static_cast<double>(count) + duty / 2 - start - (side == 0 ? 0.0 : 0.5);
    const Place p = path(cycles * period);
    const double s = side == 0 ? 1 : -1;
    const Vec3 from_body = rotate(turn_y(p.yaw), {s * half_width, 0, -behind});
    FootTarget f;
    f.x = p.x + from_body[0];
    f.z = p.z + from_body[2];
    f.yaw = p.yaw + s * toe_out;
    return f;
  }

  double effort(const FootTarget& a, const FootTarget& b) const {
    return always ? 1 : ease(std::hypot(b.x - a.x, b.z - a.z) / 15 + std::abs(b.yaw - a.yaw) / 25);
  }
};

/// How the trunk and arms move with the steps.
struct Carriage {
  double pelvis_turn = 5, pelvis_drop = 3, sway = 2.2;
  double arm_swing = 22, arm_base = 2, elbow = 22, elbow_swing = 12;
  double lean = 2;
  double bounce = 0, height = 96.5;  ///< bounce: highest between two stances, cm
};

/// A body in a gait: standing posture, feet from the gait, trunk and arms swinging in opposition.
inline BodyTarget stepping(const Performer& p, const Gait& gait, const Carriage& c, double t) {
  BodyTarget b = p.standing(t);
  const Place place = gait.path(t);
  const double left = gait.beat(t, 0).phase, middle = gait.duty / 2;
  const double stance = cowave(left - middle);  // +1 in the middle of the left foot's stance
  const double stride = cowave(left);           // +1 when the left foot strikes
  const Vec3 side = rotate(turn_y(place.yaw), {c.sway * stance, 0, 0});
  b.x = place.x + side[0];
  b.z = place.z + side[2];
  b.height = c.height - c.bounce * cowave(2 * (left - middle));
  b.yaw = place.yaw - c.pelvis_turn * stride;
  b.roll = c.pelvis_drop * cowave(left - 0.2);
  b.pitch = 0.4 * c.lean + 1;
  b.bend += 0.6 * c.lean;
  b.nod -= 0.7 * c.lean;
  b.side_bend -= 1.2 * b.roll;
  b.twist += 1.9 * c.pelvis_turn * stride;
  b.head_turn -= 0.8 * c.pelvis_turn * stride;
  for (std::size_t i = 0; i < 2; ++i) {
    const double forward = (i == 0 ? -1 : 1) * cowave(left - 0.04);  // the arm lags a little
    b.arms[i].flexion = c.arm_base + c.arm_swing * forward;
    b.arms[i].elbow = c.elbow + c.elbow_swing * (1 + cowave(left - 0.1) * (i == 0 ? -1 : 1));
    b.feet[i] = gait.foot(t, i);
  }
  return b;
}

/// A path with forward speed `speed` (cm/s) and turning rate `turn` (degrees per second).
inline std::function<Place(double)> arc_path(double speed, double turn) {
  return [speed, rate = radians(turn)](double t) {
    if (std::abs(rate) < 1e-9) return Place{0, speed * t, 0};
    const double r = speed / rate, a = rate * t;
    return Place{r * (1 - std::cos(a)), r * std::sin(a), degrees(a)};
  };
}

inline Performance walk(Performer p) {
  const std::size_t way = p.dice.pick(4);  // 0, 1 straight, 2 in a circle, 3 backwards
  const double speed = (way == 3 ? -65 : 122) * p.tempo * (way == 2 ? 0.85 : 1);
  const double turn = way == 2 ? p.sign() * p.dice.uniform(22, 38) : 0;
  Gait gait;
  gait.path = arc_path(speed, turn);
  gait.period = 1.1 * std::pow(p.tempo, -0.55);
  gait.start = p.start;
  gait.half_width = p.stance - 2;
  gait.toe_out = p.toe_out;
  Carriage c;
  c.arm_swing = 24 * p.size * std::sqrt(p.tempo);
  c.elbow = p.elbow;
  c.pelvis_turn = 3 + 2.5 * p.tempo;
  const bool stooped = way < 2 && p.dice.chance(0.2);
  c.lean = stooped ? 32 : 1 + 3 * p.tempo;
  if (way == 3) gait.behind = 2, gait.strike = 0, gait.push_off = 24, gait.swing_heel = 30, gait.lift = 7;
  const std::string how = p.tempo_word();
  std::vector<std::string> captions;
  if (way < 2) {
    captions = {join("walk", how), join("a person walks forward", how)};
    if (how.empty()) captions.push_back("a person walks at a normal pace");
    if (p.tempo > 1.15) captions.push_back("brisk walk");
    if (stooped) captions = {join("walk bent over", how), "a person walks forward bent over"};
    const std::string arms = p.size_word("hardly moving the arms", "swinging the arms wide");
    if (!arms.empty()) captions.push_back(join("a person walks", arms));
  } else if (way == 2) {
    const std::string to = std::string("to the ") + p.side_name();
    captions = {join("walk in a circle " + to, how), "a person walks in a curve " + to};
  } else {
    captions = {join("walk backwards", how), join("a person walks backwards", how)};
  }
  return {[p, gait, c, turn](double t) {
            BodyTarget b = stepping(p, gait, c, t);
            b.roll -= 0.06 * turn;  // into the curve
            b.head_turn += 0.4 * turn;
            return b;
          },
          distinct(captions)};
}

inline Performance run(Performer p) {
  const bool curve = p.dice.chance(0.25);
  const double speed = 265 * p.tempo, turn = curve ? p.sign() * p.dice.uniform(28, 45) : 0;
  Gait gait;
  gait.path = arc_path(speed, turn);
  gait.period = 0.74 * std::pow(p.tempo, -0.35);
  gait.duty = 0.4 - 0.05 * p.tempo;
  gait.start = p.start;
  gait.half_width = 5;
  gait.toe_out = 0.5 * p.toe_out;
  gait.behind = 9;
  gait.lift = 17 + 9 * p.tempo;
  gait.push_off = 50;
  gait.swing_heel = 78;
  gait.strike = 6;
  const Carriage c{.pelvis_turn = 7,
                   .pelvis_drop = 4,
                   .sway = 0.8,
                   .arm_swing = 34 * p.size,
                   .arm_base = -6,
                   .elbow = 72,
                   .elbow_swing = 12,
                   .lean = 6 + 6 * p.tempo,
                   .bounce = 3.8,
                   .height = 90};
  const std::string how = p.tempo_word();
  std::vector<std::string> captions;
  if (curve)
    captions = {join("run in a circle to the " + std::string(p.side_name()), how),
                "a person runs in a curve to the " + std::string(p.side_name())};
  else
    captions = {join("run", how), join("a person runs forward", how), p.tempo < 0.92 ? "jog" : "run/jog",
                p.tempo > 1.15 ? "sprint" : "",
                join("a person runs", p.size_word("with small arm swings", "with big arm swings"))};
  return {[p, gait, c, turn](double t) {
            BodyTarget b = stepping(p, gait, c, t);
            b.roll -= 0.1 * turn;
            return b;
          },
          distinct(captions)};
}

inline Performance march(Performer p) {
  Gait gait;
  gait.path = [](double) { return Place{}; };
  gait.period = 1.15 / p.tempo;
  gait.duty = 0.58;
  gait.start = p.start;
  gait.half_width = p.stance - 1;
  gait.toe_out = p.toe_out;
  gait.behind = 1;
  gait.lift = 23.5 * p.size;
  gait.lift_peak = 0.5;
  gait.push_off = 20;
  gait.swing_heel = 30 + 18 * p.size;
  gait.strike = 0;
  gait.always = true;
  const Carriage c{.pelvis_turn = 2, .sway = 4, .arm_swing = 34 * p.size, .elbow = 40 + p.elbow, .lean = 1};
  const std::string how = p.tempo_word();
  return {[p, gait, c](double t) { return stepping(p, gait, c, t); },
          distinct({join("march in place", how), join("a person steps in place", how),
                    p.size_word("step in place with low knees", "march in place with high knees")})};
}

inline Performance turn(Performer p) {
  const double angle = p.side == 0 ? 90 : -90, cycle = 3.2 / p.tempo, share = 0.62;
  const double start = p.start;
  const auto yaw = [=](double t) {
    const double c = t / cycle + start, n = std::floor(c);
    return angle * (n + ease((c - n) / share));
  };
  const double first = yaw(0);
  Gait gait;
  gait.path = [=](double t) { return Place{0, 0, yaw(t) - first}; };
  gait.period = 1.0 / std::sqrt(p.tempo);
  gait.duty = 0.6;
  gait.start = p.start;
  gait.half_width = p.stance;
  gait.toe_out = p.toe_out;
  gait.behind = 1;
  gait.push_off = gait.swing_heel = 22;
  gait.strike = 0;
  const Carriage c{
      .pelvis_turn = 0, .pelvis_drop = 1.5, .sway = 3, .arm_swing = 5, .elbow_swing = 3, .lean = 0};
  const std::string to = std::string("to the ") + p.side_name(), how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = stepping(p, gait, c, t);
            const double ahead = yaw(t + 0.25) - yaw(t);  // the head leads
            b.head_turn += 0.9 * ahead;
            b.twist += 0.35 * ahead;
            return b;
          },
          distinct({join(std::string("turn ") + p.side_name(), how), join("a person turns " + to, how),
                    "turn around " + to})};
}

inline Performance sidestep(Performer p) {
  const double speed = 48 * p.sign() * p.tempo * p.size;
  Gait gait;
  gait.path = [speed](double t) { return Place{speed * t, 0, 0}; };
  gait.period = 1.15 / std::sqrt(p.tempo);
  gait.duty = 0.6;
  gait.start = p.start;
  gait.half_width = 9 + std::abs(speed) * gait.period / 4;  // the feet never cross
  gait.toe_out = 3;
  gait.behind = 1;
  gait.lift = 7;
  gait.push_off = gait.swing_heel = 20;
  gait.strike = 0;
  const Carriage c{
      .pelvis_turn = 0, .pelvis_drop = 1, .sway = 2, .arm_swing = 4, .elbow = 30, .lean = 4, .height = 92};
  const std::string to = std::string("to the ") + p.side_name();
  const std::string how = p.tempo_word(), steps = p.size_word("small side steps", "large side steps");
  return {[=](double t) {
            BodyTarget b = stepping(p, gait, c, t);
            const double open = cowave(gait.beat(t, p.side).phase - 0.1);
            for (ArmTarget& a : b.arms) a.abduction += 8 + 7 * open;
            b.head_turn += 10 * p.sign();
            return b;
          },
          distinct({join("sidestep " + to, how), join("a person steps sideways " + to, how),
                    steps.empty() ? "" : steps + " " + to})};
}

}  // namespace motiongan::motion::procedural
