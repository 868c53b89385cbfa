// Standing actions that use the legs: jump, jumping jack, squat, kick, sit.
#pragma once
#include <cmath>
#include <string>

#include "motiongan/procedural/performer.hpp"

namespace motiongan::motion::procedural {

inline Performance jump(Performer p) {
  const bool forward = p.dice.chance(0.5);
  const double rise = 26 * p.size, flight = std::sqrt(8 * rise / 981.0);
  const double crouch = 0.75 / p.tempo, push = 0.24, landing = 0.22, rest = 0.85 / p.tempo;
  const double period = crouch + push + flight + landing + rest;
  const double distance = forward ? 75 * p.size : 0, deep = 20 + 8 * p.size;
  const double take_off = crouch + push, touch = take_off + flight, speed = 981.0 * flight / 2;
  // The legs extend slightly after take-off and bend before touch-down: the feet accelerate more slowly than
  // the body and would hold it back if the legs were straight.
  const double up = 1.5 - 2.5 * p.size, down = -1 - 3 * p.size, drift = (down - up) / flight;
  // Height above standing; the slopes at take-off and touch-down are those of free flight.
  const Curve height{{0.1, 0},
                     {crouch, -deep},
                     {take_off, up, speed + drift},
                     {touch, down, drift - speed},
                     {touch + landing, -deep * 0.8},
                     {period - 0.1, 0}};
  const std::string how = p.tempo_word(), where = forward ? "forward" : "in place";
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const double cycles = t / period + p.start, n = std::floor(cycles), at = (cycles - n) * period;
            const double fly = (at - take_off) / flight, arc = 4 * fly * (1 - fly) * rise;
            const bool airborne = fly > 0 && fly < 1;
            b.height = 96 + (airborne ? up + (down - up) * fly + arc : height(at));
            const double bent =
                Curve{{0.1, 0},         {crouch, 1}, {take_off, 0.05}, {touch, 0.1}, {touch + landing, 0.8},
                      {period - 0.1, 0}}(at);
            const double origin = distance * (n - std::floor(p.start));
            const double gone = ease((at - take_off + 0.12) / (flight + 0.24));
            b.z += origin + distance * gone - 13 * bent;
            b.pitch += 22 * bent;
            b.bend += 20 * bent;
            b.nod -= 16 * bent;
            const double moved = distance * ease(fly);
            const double lift = airborne ? 0.9 * arc * ease(fly / 0.24) * ease((1 - fly) / 0.24) : 0;
            const double point = Curve{{take_off - 0.16, 0},
                                       {take_off, 34, 160},
                                       {take_off + 0.25 * flight, 48},
                                       {touch - 0.1 * flight, 18},
                                       {touch + 0.08, 0}}(at);
            for (FootTarget& f : b.feet) {
              f.z += origin + moved;
              f.lift = lift;
              f.heel_rise = point;
              f.toe_bend = point * (airborne ? 1 - 0.6 * hump(fly) : 1);
            }
            const double swing = Curve{{0.1, 0},
                                       {crouch, -1},
                                       {take_off, 1.6},
                                       {take_off + 0.5 * flight, 1.9},
                                       {touch + landing, 0.5},
                                       {period - 0.1, 0}}(at);
            for (ArmTarget& a : b.arms) {
              a.flexion += 45 * p.size * swing;
              a.elbow += 12 * std::abs(swing) * ease(std::abs(swing));
              a.abduction += 6 * bent;
            }
            return b;
          },
          distinct({join("jump " + where, how), join("a person jumps " + where, how),
                    p.size_word("a small jump ", "a big jump ").empty()
                        ? "jump"
                        : p.size_word("a small jump ", "a big jump ") + where})};
}

inline Performance jumping_jack(Performer p) {
  const double period = 1.25 / p.tempo;
  const std::string how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const double u = fraction(t / period + p.start);
            const double open = Curve{{0.11, 0}, {0.42, 1}, {0.59, 1}, {0.9, 0}}(u);
            const double hop = hump((u - 0.1) / 0.32) + hump((u - 0.58) / 0.32);
            const double dip = cowave(2 * u) * 0.5 + 0.5;  // knees bend at u = 0 and 1/2
            b.height = 95 - 7 * dip + 9 * p.size * hop;
            for (std::size_t i = 0; i < 2; ++i) {
              const double s = i == 0 ? 1 : -1;
              b.feet[i].x = s * (p.stance + 24 * p.size * open);
              b.feet[i].lift = 7 * p.size * hop;
              b.feet[i].heel_rise = b.feet[i].toe_bend = 8 + 16 * hop;
              ArmTarget& a = b.arms[i];
              a.abduction = p.hang + 4 + (96 + 40 * p.size) * open;
              a.twist = -12 + 50 * open;
              a.flexion = 4 + 6 * open;
              a.elbow = p.elbow + 8 * std::sin(pi * open);
            }
            b.z += 3;
            return b;
          },
          distinct({join("jumping jacks", how), join("a person does jumping jacks", how),
                    "exercise - jumping jacks"})};
}

inline Performance squat(Performer p) {
  const double period = 2.9 / p.tempo, depth = 40 * p.size;
  const bool arms_out = p.dice.chance(0.7);
  const std::string how = p.tempo_word(), deep = p.size_word("a little", "deeply");
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double down =
                Curve{{0.05, 0}, {0.45, 1}, {0.55, 1}, {0.95, 0}}(beat.phase) * (0.5 + 0.5 * beat.strength);
            b.height -= std::min(depth, 52.0) * down;
            b.z -= 15 * p.size * down;
            b.pitch += 24 * p.size * down;
            b.bend += 12 * down;
            b.nod -= 18 * down;
            for (std::size_t i = 0; i < 2; ++i) {
              const double s = i == 0 ? 1 : -1;
              b.feet[i].x += 5 * s, b.feet[i].yaw += 8 * s;
              ArmTarget& a = b.arms[i];
              const ArmTarget ahead{.flexion = 98, .abduction = 4, .twist = -6, .elbow = 14};
              const ArmTarget hanging{.flexion = 34, .abduction = 14, .twist = -12, .elbow = 40};
              a = blend(a, arms_out ? ahead : hanging, down);
            }
            return b;
          },
          distinct({join("squat", how), join("a person squats down and rises", how),
                    join("a person squats", deep),
                    arms_out ? "squat with the arms stretched out" : "knee bends"})};
}

inline Performance kick(Performer p) {
  const double period = 3.0 / p.tempo, angle = 42 + 24 * p.size;  // of the leg from hanging, degrees
  const double far = 86 * std::sin(radians(angle)), high = 88 - 86 * std::cos(radians(angle));
  const std::string leg = std::string("the ") + p.side_name() + " leg", how = p.tempo_word();
  const std::string size = p.size_word("a low kick with ", "a high kick with ");
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double u = beat.phase, s = p.sign();
            const double shift = Curve{{0, 0}, {0.2, 1}, {0.66, 1}, {0.9, 0}}(u);
            const double out = Curve{{0.32, 0}, {0.46, 1}, {0.6, 0}}(u);
            const double back = Curve{{0.12, 0}, {0.31, 1}, {0.43, 0}}(u);
            b.x -= s * (p.stance - 2) * shift;
            b.height -= 1.5 * shift;
            FootTarget& f = b.feet[p.side];
            f.z = Curve{{0.12, 0}, {0.31, -32}, {0.46, far}, {0.62, 18}, {0.8, 0}}(u);
            f.x -= s * 3 * shift;
            f.lift = Curve{{0.12, 0}, {0.31, 20}, {0.46, high}, {0.62, 16}, {0.8, 0}}(u);
            f.heel_rise = 58 * back;
            f.toe_rise = 0.55 * angle * out;
            f.toe_bend = f.heel_rise * (1 - ease((u - 0.16) / 0.12));
            b.pitch += 8 * back - 13 * out;
            b.bend += -4 * back + 8 * out;
            b.yaw -= s * 9 * (out - back);
            b.twist += s * 20 * (out - back);
            b.roll -= s * 3 * shift;
            b.side_bend += s * 3 * shift;
            ArmTarget &same = b.arms[p.side], &other = b.arms[1 - p.side];
            same.flexion += 22 * back - 30 * out;
            other.flexion += -16 * back + 42 * out;
            for (ArmTarget& a : b.arms) a.abduction += 16 * shift, a.elbow += 16 * shift;
            return b;
          },
          distinct({join("kick with " + leg, how), join("a person kicks " + leg + " forward", how),
                    std::string("kick ") + p.side_name(), size.empty() ? "" : size + leg})};
}

inline Performance sit(Performer p) {
  const double period = 6.4 / p.tempo, seat = 52;  // height of the root when seated
  const bool hands_on_knees = p.dice.chance(0.6);
  const std::string how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double u = beat.phase;
            const double seated = Curve{{0.08, 0}, {0.3, 1}, {0.62, 1}, {0.84, 0}}(u);
            const double lean = hump((u - 0.08) / 0.28) + hump((u - 0.56) / 0.28);
            b.height += (seat - b.height) * seated;
            b.z -= 37 * ease(seated * 1.15);
            b.pitch += 27 * lean * (0.7 + 0.3 * p.size) - 6 * seated;
            b.bend += 14 * lean + 3 * seated;
            b.nod -= 16 * lean;
            for (std::size_t i = 0; i < 2; ++i) {
              const double s = i == 0 ? 1 : -1;
              b.feet[i].x += 3 * s;
              ArmTarget& a = b.arms[i];
              const ArmTarget resting{.flexion = 38, .abduction = 8, .twist = -14, .elbow = 40};
              const ArmTarget beside{.flexion = 2, .abduction = 14, .twist = -8, .elbow = 24};
              a = blend(a, hands_on_knees ? resting : beside, seated);
              a.flexion += 24 * lean;
              a.elbow += 8 * lean;
            }
            return b;
          },
          distinct({join("sit down and stand up", how), join("a person sits down and gets up again", how),
                    hands_on_knees ? "sit with the hands on the knees" : "sit on a chair"})};
}

}  // namespace motiongan::motion::procedural
