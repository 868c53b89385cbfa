// Upper-body actions with the feet planted: wave, punch, clap, bow, stretch, stand, throw.
#pragma once
#include <cmath>
#include <string>

#include "motiongan/procedural/performer.hpp"

namespace motiongan::motion::procedural {

inline Performance wave_hand(Performer p) {
  const double period = 4.2 / std::sqrt(p.tempo);
  const double beats = std::round(period * 1.7 * p.tempo * 0.62);  // hand movements while the arm is up
  const bool high = p.size > 1;
  const ArmTarget up = high ? ArmTarget{.flexion = 15, .abduction = 128, .twist = 70, .elbow = 42}
                            : ArmTarget{.flexion = 22, .abduction = 62, .twist = 82, .elbow = 108};
  const std::string with = std::string("the ") + p.side_name() + " hand", how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double raised = Curve{{0, 0}, {0.2, 1}, {0.82, 1}, {1, 0}}(beat.phase);
            const double u = (beat.phase - 0.16) / 0.7;
            const double swing = wave(beats * u) * ease(4 * u) * ease(4 * (1 - u)) * beat.strength;
            ArmTarget waving = up;
            waving.elbow += 20 * p.size * swing;
            waving.abduction += 5 * p.size * swing;
            waving.wrist_side = 14 * p.size * wave(beats * u - 0.12) * ease(4 * u) * ease(4 * (1 - u));
            b.arms[p.side] = blend(b.arms[p.side], waving, raised);
            b.side_bend -= 3 * p.sign() * raised * (high ? -1 : 1);
            b.head_turn += 5 * p.sign() * raised;
            return b;
          },
          distinct({join("wave with " + with, how), join("a person waves " + with, how),
                    std::string("wave ") + p.side_name(),
                    p.size_word("a small wave with ", "a big wave with ").empty()
                        ? ""
                        : p.size_word("a small wave with ", "a big wave with ") + with})};
}

inline Performance punch(Performer p) {
  const std::size_t way = p.dice.pick(3);  // 0, 1: one hand, 2: both in turn
  const double period = 1.25 / p.tempo;
  const std::string how = p.tempo_word();
  const std::string with =
      way == 2 ? "with both hands in turn" : std::string("with the ") + p.side_name() + " hand";
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const std::size_t striking = way == 2 && beat.count % 2 != 0 ? 1 - p.side : p.side;
            const double s = striking == 0 ? 1 : -1;
            const double out = Curve{{0.1, 0}, {0.2, -0.12}, {0.42, 1}, {0.5, 1}, {0.82, 0}}(beat.phase) *
                               (0.9 + 0.1 * beat.strength);
            // A boxer's stance: left foot in front, knees soft, trunk slightly turned away.
            b.feet[0].z = 16, b.feet[0].x += 2;
            b.feet[1].z = -16, b.feet[1].x -= 4, b.feet[1].yaw -= 20;
            b.height = 89 + 0.7 * cowave(2 * t * p.tempo);
            b.z = 2 + 5 * out * p.size;
            b.yaw = -14 - 8 * s * out * p.size;
            b.twist -= 2 + 22 * s * out * p.size;
            b.bend += 7 + 5 * out;
            b.head_turn += 13 + 27 * s * out * p.size;
            b.nod += 2;
            for (std::size_t i = 0; i < 2; ++i) {
              const ArmTarget guard{.flexion = 38, .abduction = 12, .twist = -18, .elbow = 128};
              const ArmTarget straight{.flexion = 84, .abduction = 2, .twist = -8, .elbow = 14};
              b.arms[i] =
                  blend(guard, straight, i == striking ? out * std::min(1.0, 0.75 + 0.25 * p.size) : 0);
            }
            return b;
          },
          distinct({join("punch", how), join("a person punches " + with, how), "punch/strike",
                    join("box " + with, how)})};
}

inline Performance clap(Performer p) {
  const double period = 0.62 / p.tempo, start = p.start;
  const double height = p.dice.uniform(-8, 8);
  const std::string how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const double apart = 0.5 + 0.5 * cowave(t / period + start);  // 1: hands furthest apart
            const double wide = 16 * p.size * apart * apart * (3 - 2 * apart);
            for (std::size_t i = 0; i < 2; ++i) {
              const double s = i == 0 ? 1 : -1;
              b.arms[i].reach = true;
              b.arms[i].wrist = {s * (3.2 + wide), -6 + height + 2 * p.size * apart, 30 - 3 * apart};
              b.arms[i].point = {-s * 0.1 * (1 - apart), 0.55, 0.85};
            }
            b.height -= 0.8 * p.size * apart;
            b.bend += 2 + 1.5 * apart;
            b.nod += 3;
            return b;
          },
          distinct({join("clap", how), join("a person claps the hands", how), "clap the hands",
                    p.size_word("clap with small movements", "clap with wide arms")})};
}

inline Performance bow(Performer p) {
  const double period = 4.4 / p.tempo, depth = 62 * p.size;
  const std::string how = p.tempo_word(), deep = p.size_word("a little", "deeply");
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double down = Curve{{0.1, 0}, {0.42, 1}, {0.58, 1}, {0.92, 0}}(beat.phase) * beat.strength;
            b.pitch += 0.55 * depth * down;
            b.bend += 0.45 * depth * down;
            b.z -= 0.22 * depth * down;
            b.nod += 10 * down;
            for (ArmTarget& a : b.arms) {
              a.flexion += 0.45 * depth * down;
              a.abduction -= 2 * down;
            }
            return b;
          },
          distinct({join("bow", how), join("a person bows forward", how), join("a person bows", deep),
                    deep.empty() ? "" : join("bow", deep)})};
}

inline Performance stretch(Performer p) {
  const double period = 5 / p.tempo;
  const bool sideways = p.dice.chance(0.5);  // the arms rise at the sides or in front
  const std::string how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double up = Curve{{0.06, 0}, {0.42, 1}, {0.6, 1}, {0.94, 0}}(beat.phase);
            const double high = up * (0.8 + 0.2 * p.size);
            for (ArmTarget& a : b.arms) {
              ArmTarget top = a;
              top.flexion = sideways ? 10 : 165;
              top.abduction = sideways ? 158 : 12;
              top.twist = sideways ? 40 : -10;
              top.elbow = 12;
              a = blend(a, top, high);
            }
            for (FootTarget& f : b.feet) f.heel_rise = f.toe_bend = 24 * p.size * up * up * beat.strength;
            b.height += 9 * p.size * up * up;
            b.z += 5 * p.size * up * up;
            b.bend -= 10 * high;
            b.nod -= 14 * high;
            return b;
          },
          distinct({join("stretch", how), join("a person raises both arms and stretches", how),
                    sideways ? "raise both arms at the sides" : "raise both arms in front"})};
}

inline Performance stand(Performer p) {
  const bool looking = p.size > 0.9;
  const double period = 5.5 / p.tempo;
  p.restless *= 1.6;
  const std::string how = p.tempo_word();
  std::vector<std::string> captions{"stand", "a person stands and looks around",
                                    join("look around to the left and right", how)};
  if (!looking) captions = {"stand still", "a person stands still", "stand idle"};
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            if (!looking) return b;
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double look =
                Curve{{0, 0}, {0.2, 1}, {0.36, 1}, {0.62, -1}, {0.78, -1}, {1, 0}}(beat.phase) *
                beat.strength * p.size * p.sign();
            b.head_turn += 46 * look;
            b.twist += 16 * look;
            b.yaw += 5 * look;
            b.x += 1.5 * look;
            b.roll += 1.2 * look;
            return b;
          },
          distinct(captions)};
}

inline Performance throw_ball(Performer p) {
  const double period = 3.0 / p.tempo;
  const std::string with = std::string("with the ") + p.side_name() + " hand", how = p.tempo_word();
  return {[=](double t) {
            BodyTarget b = p.standing(t);
            const Beat beat = beat_at(t, period, p.start, p.seed);
            const double s = p.sign(), u = beat.phase;
            const double back = Curve{{0.05, 0}, {0.34, 1}, {0.5, -1}, {0.62, -0.9}, {0.95, 0}}(u)*p.size;
            b.feet[1 - p.side].z = 20;  // the other foot stands in front
            b.feet[p.side].z = -14, b.feet[p.side].yaw += 14 * s;
            b.height = 91;
            b.z = 2 - 7 * back;
            b.yaw = s * (10 + 14 * back);
            b.twist += s * 22 * back;
            b.bend -= 9 * back;
            b.head_turn -= s * (10 + 34 * back);
            ArmTarget& a = b.arms[p.side];
            a.flexion = Curve{{0.05, 4}, {0.34, -12}, {0.5, 72}, {0.62, 58}, {0.95, 4}}(u);
            a.abduction = Curve{{0.05, 10}, {0.34, 94}, {0.46, 84}, {0.62, 8}, {0.95, 10}}(u);
            a.twist = Curve{{0.05, -12}, {0.34, 78}, {0.5, 10}, {0.62, -14}, {0.95, -12}}(u);
            a.elbow = Curve{{0.05, 20}, {0.34, 98}, {0.48, 22}, {0.62, 30}, {0.95, 20}}(u);
            ArmTarget& other = b.arms[1 - p.side];
            const double aim = Curve{{0.05, 0}, {0.32, 1}, {0.55, 0}}(u);
            other = blend(other, {.flexion = 68, .abduction = 14, .twist = -10, .elbow = 28}, aim);
            return b;
          },
          distinct({join("throw", how), join("a person throws a ball " + with, how), "throw " + with,
                    p.size_word("a weak throw", "a strong throw")})};
}

}  // namespace motiongan::motion::procedural
