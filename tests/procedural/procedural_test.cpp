// Built-in motion: feet on the ground that do not slide, knees and elbows that bend the right way, continuous
// velocities, true captions, and the same clips for the same seed.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/motion/motion.hpp"
#include "motiongan/procedural/procedural.hpp"

namespace procedural_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

const std::vector<LabelledMotion>& clips() {
  static const std::vector<LabelledMotion> all =
      procedural_motions({.clips = 6 * procedural_actions().size(), .seconds = 6, .seed = 3});
  return all;
}

std::string action_of(const LabelledMotion& clip) { return clip.id.substr(0, clip.id.rfind('_')); }

bool says(const LabelledMotion& clip, const std::string& word) {
  return std::any_of(clip.captions.begin(), clip.captions.end(),
                     [&](const std::string& c) { return c.find(word) != std::string::npos; });
}

/// Mean speed over the ground from the first to the last frame, cm/s, along the path.
double travel_speed(const Motion& m) {
  double path = 0;
  for (std::size_t f = 1; f < m.frames; ++f)
    path += std::hypot(m.position(f, 0)[0] - m.position(f - 1, 0)[0],
                       m.position(f, 0)[2] - m.position(f - 1, 0)[2]);
  return path * m.rate / static_cast<double>(m.frames - 1);
}

double bend(const Quat& q) { return degrees(angle_between(Quat{}, q)); }

/// Distance from p to the segment a b.
double distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = subtract(b, a);
  const double t = std::clamp(dot(subtract(p, a), ab) / dot(ab, ab), 0.0, 1.0);
  return length(subtract(p, add(a, scale(ab, t))));
}

}  // namespace

TEST_CASE("the skeleton has 22 joints, is symmetric, and stands on the ground at rest") {
  const Skeleton s = procedural_skeleton();
  CHECK(s.size() == 22);
  CHECK(s.channel_count() == 69);
  CHECK(end_site_joints(s).size() == 5);
  for (const Joint& j : s.joints) {
    if (j.name.rfind("Left", 0) != 0) continue;
    const int other = s.find("Right" + j.name.substr(4));
    REQUIRE(other > 0);
    const Joint& right = s.joints[static_cast<std::size_t>(other)];
    CHECK(right.offset == Vec3{-j.offset[0], j.offset[1], j.offset[2]});
    CHECK(right.end_site.has_value() == j.end_site.has_value());
  }
  // The joint indices match the names.
  CHECK(s.find("LeftUpLeg") == int(procedural::up_leg));
  CHECK(s.find("RightFoot") == int(procedural::foot + procedural::leg_stride));
  CHECK(s.find("Spine") == int(procedural::spine));
  CHECK(s.find("Head") == int(procedural::head));
  CHECK(s.find("RightHand") == int(procedural::hand + procedural::arm_stride));
  Motion rest;
  rest.skeleton = s;
  rest.rate = 1, rest.frames = 1;
  rest.rotations.resize(s.size());
  for (const Joint& j : s.joints) rest.positions.push_back(j.offset);
  const GlobalPose g = forward_kinematics(rest);
  for (const Vec3& p : foot_contacts(g, 0, s.size())) CHECK(p[1] == doctest::Approx(0).epsilon(1e-9));
  CHECK(end_site_positions(rest, g)[2][1] == doctest::Approx(173.5).epsilon(0.02));  // the top of the head
}

TEST_CASE("the same seed gives the same clips, whatever the other options") {
  const auto a = procedural_motions({.clips = 20, .seconds = 2, .seed = 9});
  const auto b = procedural_motions({.clips = 3, .seconds = 2, .seed = 9});
  const auto longer = procedural_motions({.clips = 20, .seconds = 3, .rate = 60, .seed = 9});
  const auto other = procedural_motions({.clips = 20, .seconds = 2, .seed = 10});
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].id == longer[i].id);
    CHECK(a[i].captions == longer[i].captions);
    if (i < b.size()) CHECK(a[i].motion.rotations == b[i].motion.rotations);
    CHECK(a[i].motion.rotations != other[i].motion.rotations);
    double worst = 0;  // 60 Hz contains the frames of 30 Hz
    for (std::size_t f = 0; f < a[i].motion.frames; ++f)
      for (std::size_t j = 0; j < 22; ++j)
        worst =
            std::max(worst, angle_between(a[i].motion.rotation(f, j), longer[i].motion.rotation(2 * f, j)));
    CHECK(worst < 1e-7);
  }
  CHECK(a[0].motion.rotations != a[17].motion.rotations);  // two walks differ
  // Fixed values: they must not depend on compiler or library.
  procedural::Dice dice(1, 0);
  CHECK(dice.next() == 0x55C55969ED403149ULL);
  CHECK(dice.next() == 0xFB85AF9C9A7E41F1ULL);
}

TEST_CASE("actions cycle, with ids and several captions, none shared with another action") {
  const std::vector<std::string> names = procedural_actions();
  CHECK(names.size() >= 10);
  std::map<std::string, std::string> owner;
  std::set<std::string> ids;
  for (std::size_t i = 0; i < clips().size(); ++i) {
    const LabelledMotion& clip = clips()[i];
    CHECK(action_of(clip) == names[i % names.size()]);
    CHECK(ids.insert(clip.id).second);
    CHECK(clip.motion.frames == 180);
    CHECK(clip.motion.rate == 30);
    CHECK(clip.captions.size() >= 2);
    for (const std::string& c : clip.captions) {
      INFO(clip.id, ": ", c);
      CHECK(!c.empty());
      CHECK(c.front() != ' ');
      CHECK(c.back() != ' ');
      CHECK(std::none_of(c.begin(), c.end(), [](unsigned char ch) { return std::isupper(ch) || ch > 126; }));
      const auto [entry, fresh] = owner.emplace(c, action_of(clip));
      CHECK(entry->second == action_of(clip));
      CHECK(std::count(clip.captions.begin(), clip.captions.end(), c) == 1);
    }
  }
}

TEST_CASE("no foot is below the ground, and one touches it unless the action leaves it") {
  for (const LabelledMotion& clip : clips()) {
    const GlobalPose g = forward_kinematics(clip.motion);
    double least = 1e9, most = -1e9;
    for (std::size_t f = 0; f < clip.motion.frames; ++f) {
      double low = 1e9;
      for (const Vec3& p : foot_contacts(g, f, 22)) low = std::min(low, p[1]);
      least = std::min(least, low), most = std::max(most, low);
    }
    INFO(clip.id, " lowest point from ", least, " to ", most, " cm");
    CHECK(least > -0.01);
    const std::string action = action_of(clip);
    if (action == "run")
      CHECK((most > 1 && most < 12));
    else if (action == "jump")
      CHECK((most > 12 && most < 45));
    else if (action == "jumping_jack")
      CHECK((most > 2 && most < 15));
    else
      CHECK(most < 0.01);
  }
}

TEST_CASE("feet do not slide while they touch the ground") {
  for (const LabelledMotion& clip : clips()) {
    const GlobalPose g = forward_kinematics(clip.motion);
    double slid = 0;
    std::size_t touching = 0;
    for (std::size_t f = 1; f < clip.motion.frames; ++f) {
      const auto before = foot_contacts(g, f - 1, 22), now = foot_contacts(g, f, 22);
      for (std::size_t i = 0; i < 6; ++i) {
        if (before[i][1] > 0.1 || now[i][1] > 0.1) continue;
        slid += std::hypot(now[i][0] - before[i][0], now[i][2] - before[i][2]);
        ++touching;
      }
    }
    REQUIRE(touching > 0);
    const double speed = slid / static_cast<double>(touching) * clip.motion.rate;
    INFO(clip.id, ": points on the ground move at ", speed, " cm/s");
    CHECK(speed < 1.5);
  }
}

TEST_CASE("joint and root velocities are continuous") {
  // At half the time step the change of velocity from frame to frame halves, unless the velocity jumps.
  for (std::size_t i = 0; i < 2 * procedural_actions().size(); ++i) {
    const auto change = [i](double rate) {
      const Motion m = procedural_motion(i, {.seconds = 4, .rate = rate, .seed = 5}).motion;
      double turning = 0, moving = 0;
      for (std::size_t f = 2; f < m.frames; ++f) {
        for (std::size_t j = 0; j < 22; ++j) {
          const auto step = [&](std::size_t at) {
            return expmap_from_quat(multiply(inverse(m.rotation(at - 1, j)), m.rotation(at, j)));
          };
          turning = std::max(turning, rate * degrees(length(subtract(step(f), step(f - 1)))));
        }
        const Vec3 d = subtract(subtract(m.position(f, 0), m.position(f - 1, 0)),
                                subtract(m.position(f - 1, 0), m.position(f - 2, 0)));
        moving = std::max(moving, rate * length(d));
      }
      return std::pair{turning, moving};
    };
    const std::pair<double, double> coarse = change(240), fine = change(480);
    INFO("clip ", i, ": rotation ", coarse.first, " and ", fine.first, " deg/s, root ", coarse.second,
         " and ", fine.second, " cm/s");
    CHECK(fine.first < 0.7 * coarse.first + 0.5);
    CHECK(fine.second < 0.7 * coarse.second + 0.1);
    CHECK(coarse.first < 120);  // 29,000 degrees / s^2
  }
}

TEST_CASE("joints stay within anatomical limits") {
  using namespace procedural;
  EulerOrder hinge;
  hinge.axes = {0, 2, 1}, hinge.count = 3;
  for (const LabelledMotion& clip : clips()) {
    const Motion& m = clip.motion;
    double knee_low = 180, knee_high = 0, sideways = 0, ankle_low = 180, ankle_high = -180, elbow = 0;
    double trunk = 0, wrist = 0, head_turn = 0;
    for (std::size_t f = 0; f < m.frames; ++f) {
      trunk = std::max(trunk, bend(m.rotation(f, spine)));
      head_turn = std::max(head_turn, bend(m.rotation(f, head)));
      for (std::size_t side = 0; side < 2; ++side) {
        const Quat& knee = m.rotation(f, lower_leg + side * leg_stride);
        const Vec3 k = expmap_from_quat(knee);
        knee_low = std::min(knee_low, degrees(k[0])), knee_high = std::max(knee_high, degrees(k[0]));
        sideways = std::max({sideways, std::abs(k[1]), std::abs(k[2])});
        const double ankle = degrees(euler_from_quat(hinge, m.rotation(f, foot + side * leg_stride))[0]);
        ankle_low = std::min(ankle_low, ankle), ankle_high = std::max(ankle_high, ankle);
        // The left elbow bends about -y, the right one about +y.
        const Vec3 e = expmap_from_quat(m.rotation(f, fore_arm + side * arm_stride));
        const double flexed = degrees(side == 0 ? -e[1] : e[1]);
        CHECK(flexed > 0);
        elbow = std::max(elbow, flexed);
        wrist = std::max(wrist, bend(m.rotation(f, hand + side * arm_stride)));
      }
    }
    INFO(clip.id, ": knees ", knee_low, " to ", knee_high, ", ankles ", ankle_low, " to ", ankle_high,
         ", elbow to ", elbow, ", spine ", trunk, ", wrist ", wrist, ", head ", head_turn);
    CHECK(knee_low > 3);  // never straight, never backwards
    CHECK(knee_high < 150);
    CHECK(sideways < 1e-9);
    CHECK(ankle_low > -45);
    CHECK(ankle_high < 60);
    CHECK(elbow < 150);
    CHECK(trunk < 25);
    CHECK(wrist < 75);
    CHECK(head_turn < 45);
  }
}

TEST_CASE("arms and legs do not intersect the body or each other") {
  using namespace procedural;
  for (const LabelledMotion& clip : clips()) {
    const GlobalPose g = forward_kinematics(clip.motion);
    double arms = 1e9, ankles = 1e9, knees = 1e9;
    for (std::size_t f = 0; f < clip.motion.frames; ++f) {
      const Vec3* p = &g.positions[f * 22];
      for (std::size_t side = 0; side < 2; ++side)
        for (const std::size_t j : {fore_arm, procedural::hand})
          arms = std::min(arms, distance(p[j + side * arm_stride], p[hips], p[neck]));
      ankles = std::min(ankles, length(subtract(p[foot], p[foot + leg_stride])));
      knees = std::min(knees, length(subtract(p[lower_leg], p[lower_leg + leg_stride])));
    }
    INFO(clip.id, ": arms ", arms, ", ankles ", ankles, ", knees ", knees, " cm apart");
    CHECK(arms > 13);
    CHECK(ankles > 7);
    CHECK(knees > 7);
  }
}

TEST_CASE("walking and running follow the heading, at the speed given by the captions") {
  double slow = 0, quick = 1e9, fastest_walk = 0, slowest_run = 1e9;
  const auto many = procedural_motions({.clips = 40 * procedural_actions().size(), .seconds = 4, .seed = 7});
  for (const LabelledMotion& clip : many) {
    const std::string action = action_of(clip);
    const double speed = travel_speed(clip.motion);
    INFO(clip.id, " ", clip.captions.front(), ": ", speed, " cm/s");
    if (action == "walk" || action == "run") {
      double ahead = 0;  // travel along the pelvis's forward direction
      for (std::size_t f = 1; f < clip.motion.frames; ++f)
        ahead += dot(subtract(clip.motion.position(f, 0), clip.motion.position(f - 1, 0)),
                     rotate(clip.motion.rotation(f, 0), {0, 0, 1}));
      CHECK((says(clip, "backwards") ? -ahead : ahead) > 0);
    }
    if (action == "walk" && says(clip, "forward") && !says(clip, "bent")) {
      CHECK(speed > 75);
      CHECK(speed < 190);
      if (says(clip, "slowly")) slow = std::max(slow, speed);
      if (says(clip, "quickly")) quick = std::min(quick, speed);
      fastest_walk = std::max(fastest_walk, speed);
    } else if (action == "run") {
      CHECK(speed > 180);
      CHECK(speed < 420);
      slowest_run = std::min(slowest_run, speed);
    } else if (action != "walk" && action != "sidestep" && action != "jump") {
      const Vec3 gone = subtract(clip.motion.position(clip.motion.frames - 1, 0), clip.motion.position(0, 0));
      CHECK(std::hypot(gone[0], gone[2]) < 60);
    }
  }
  CHECK(slow > 0);
  CHECK(quick < 1e9);
  CHECK(slow < quick);
  CHECK(fastest_walk < slowest_run + 20);
}

TEST_CASE("left and right in the captions are the body's left and right") {
  using namespace procedural;
  std::set<std::string> seen;
  for (const LabelledMotion& clip : clips()) {
    const std::string action = action_of(clip);
    const bool left = says(clip, "left"), right = says(clip, "right");
    if (left == right) continue;
    const Motion& m = clip.motion;
    const GlobalPose g = forward_kinematics(m);
    const auto highest = [&](std::size_t joint) {
      double y = -1e9;
      for (std::size_t f = 0; f < m.frames; ++f) y = std::max(y, g.positions[f * 22 + joint][1]);
      return y;
    };
    double sign = 0;
    if (action == "kick") sign = highest(foot) - highest(foot + leg_stride);
    if (action == "wave" || action == "throw")
      sign = highest(procedural::hand) - highest(procedural::hand + arm_stride);
    if (action == "sidestep") sign = m.position(m.frames - 1, 0)[0] - m.position(0, 0)[0];
    if (action == "turn" || action == "walk" || action == "run")
      for (std::size_t f = 1; f < m.frames; ++f)
        sign += expmap_from_quat(multiply(m.rotation(f, 0), inverse(m.rotation(f - 1, 0))))[1];
    if (sign == 0) continue;
    INFO(clip.id, ": ", clip.captions.front());
    CHECK((sign > 0) == left);
    seen.insert(action + (left ? " left" : " right"));
  }
  for (const char* action : {"kick", "wave", "throw", "turn", "sidestep"}) {
    CHECK(seen.count(action + std::string(" left")) == 1);
    CHECK(seen.count(action + std::string(" right")) == 1);
  }
}

TEST_CASE("a clip survives conversion to Euler channels, as for BVH files") {
  for (std::size_t i = 0; i < procedural_actions().size(); ++i) {
    const Motion m = procedural_motion(i, {.seconds = 2}).motion;
    const Motion back = to_motion(to_clip(m, "x"));
    double worst = 0;
    for (std::size_t k = 0; k < m.rotations.size(); ++k)
      worst = std::max(worst, angle_between(m.rotations[k], back.rotations[k]));
    CHECK(worst < 1e-7);
  }
}

TEST_CASE("lengths and rates that give no motion are errors") {
  CHECK_THROWS_WITH_AS(procedural_motions({.seconds = 0}), doctest::Contains("0 s at 30"), Error);
  CHECK_THROWS_WITH_AS(procedural_motions({.rate = -1}), doctest::Contains("positive"), Error);
  CHECK_THROWS_AS(procedural_motions({.seconds = std::nan("")}), Error);
  CHECK(procedural_motions({.clips = 0}).empty());
  CHECK(procedural_motion(5, {.seconds = 0.05, .rate = 30}).motion.frames == 2);
}

}  // namespace procedural_test
