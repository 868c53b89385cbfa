// Bodies by joint names, maps of joints, and motion of one body on another one.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <motiongan/motion/motion.hpp>
#include <motiongan/motion/retarget.hpp>

#include "../support/folders.hpp"
#include "../support/messages.hpp"
#include "../support/other_bodies.hpp"

namespace retarget_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

Motion walk(double seconds = 2) { return procedural_motion(0, {.seconds = seconds}).motion; }

constexpr std::array<std::pair<BodyPart, BodyPart>, 8> limbs{{{BodyPart::left_arm, BodyPart::left_forearm},
                                                              {BodyPart::left_forearm, BodyPart::left_hand},
                                                              {BodyPart::left_thigh, BodyPart::left_shin},
                                                              {BodyPart::left_shin, BodyPart::left_foot},
                                                              {BodyPart::right_arm, BodyPart::right_forearm},
                                                              {BodyPart::right_forearm, BodyPart::right_hand},
                                                              {BodyPart::right_thigh, BodyPart::right_shin},
                                                              {BodyPart::right_shin, BodyPart::right_foot}}};

/// The largest angle between the limbs of two motions, in degrees.
double limbs_apart(const Motion& a, const BodyParts& in_a, const Motion& b, const BodyParts& in_b) {
  const std::vector<Vec3> p = joint_positions(a), q = joint_positions(b);
  double most = 0;
  for (std::size_t f = 0; f < a.frames; ++f)
    for (const auto& [part, next] : limbs) {
      const auto bone = [f, from = part, to = next](const std::vector<Vec3>& at, std::size_t joints,
                                                    const BodyParts& body) {
        const Vec3 v = subtract(at[f * joints + joint_of(body, to)], at[f * joints + joint_of(body, from)]);
        return scale(v, 1 / length(v));
      };
      const Vec3 d = subtract(bone(p, a.skeleton.size(), in_a), bone(q, b.skeleton.size(), in_b));
      most = std::max(most, degrees(2 * std::asin(std::min(length(d) / 2, 1.0))));
    }
  return most;
}

double hips_path(const Motion& motion, const BodyParts& body) {
  const std::vector<Vec3> p = joint_positions(motion);
  const std::size_t joints = motion.skeleton.size(), hips = joint_of(body, BodyPart::hips);
  return length(subtract(p[(motion.frames - 1) * joints + hips], p[hips]));
}

}  // namespace

TEST_CASE("bodies are found in the names of many tools") {
  struct Named {
    Skeleton skeleton;
    const char *hips, *chest, *head, *left_arm, *right_shin;
  };
  for (const Named& n :
       {Named{walk().skeleton, "Hips", "Spine2", "Head", "LeftArm", "RightLeg"},
        Named{mixamo(), "mixamorig:Hips", "mixamorig:Spine2", "mixamorig:Head", "mixamorig:LeftArm",
              "mixamorig:RightLeg"},
        Named{unreal(), "pelvis", "spine_03", "head", "upperarm_l", "calf_r"},
        Named{vrm(), "hips", "upperChest", "head", "leftUpperArm", "rightLowerLeg"},
        Named{rigify(), "spine", "spine.003", "spine.005", "upper_arm.L", "shin.R"},
        Named{smpl(), "Pelvis", "Spine2", "Head", "L_Shoulder", "R_Knee"},
        Named{biped(), "Bip01 Pelvis", "Bip01 Spine2", "Bip01 Head", "Bip01 L UpperArm", "Bip01 R Calf"}}) {
    const BodyParts body = find_body(n.skeleton);
    const auto name = [&](std::size_t j) { return n.skeleton.joints[j].name; };
    CHECK(name(joint_of(body, BodyPart::hips)) == n.hips);
    REQUIRE(body.at(BodyPart::spine).size() == 3);
    CHECK(name(body.at(BodyPart::spine).back()) == n.chest);
    CHECK(body.at(BodyPart::neck).size() == 1);
    CHECK(name(joint_of(body, BodyPart::head)) == n.head);
    CHECK(name(joint_of(body, BodyPart::left_arm)) == n.left_arm);
    CHECK(name(joint_of(body, BodyPart::right_shin)) == n.right_shin);
    CHECK(body.size() == 20);
  }
}

TEST_CASE("bodies without telling names are found by their rest pose") {
  for (const Skeleton& known :
       {walk().skeleton, mixamo(), unreal(), vrm(), rigify(), smpl(), biped(), in_a_pose()}) {
    CHECK(find_body(without_names(known)) == find_body(known));
    Skeleton turned = without_names(known);  // a body that faces -X
    const auto turn = [](const Vec3& v) { return Vec3{-v[2], v[1], v[0]}; };
    for (Joint& joint : turned.joints) {
      joint.offset = turn(joint.offset);
      if (joint.end_site) joint.end_site = turn(*joint.end_site);
    }
    CHECK(find_body(turned) == find_body(known));
  }
  // Nothing tells how a skeleton lies whose bones all lie along X.
  const Skeleton nameless = without_names(along_x(walk()).skeleton);
  const std::string message = message_of([&] { find_body(nameless); });
  CHECK(says(message, "left upper arm"));
  CHECK(says(message, "Bone3"));
  CHECK(says(message_of([&] { find_joint_map(walk().skeleton, nameless); }),
             "the skeleton that the motion goes to"));
}

TEST_CASE("limbs point the same way on every body, and there and back is the same motion") {
  const Motion source = walk();
  for (const Skeleton& skeleton : {mixamo(), unreal(), vrm(), rigify(), in_a_pose()}) {
    const Retargeter there(source, at_rest(skeleton));
    const Motion made = there.standing(source);
    REQUIRE(made.frames == source.frames);
    CHECK(limbs_apart(source, there.map().from, made, there.map().to) < 1e-6);
    CHECK(hips_path(made, there.map().to) ==
          doctest::Approx(there.length_scale() * hips_path(source, there.map().from)));
    // Bones keep the target's lengths.
    for (std::size_t f = 0; f < made.frames; f += 7)
      for (std::size_t j = 1; j < skeleton.size(); ++j)
        if (j != joint_of(there.map().to, BodyPart::hips))
          REQUIRE(made.position(f, j) == skeleton.joints[j].offset);
    const Retargeter back(at_rest(there.skeleton()), at_rest(source.skeleton));
    const Motion again = back(there(source));
    const std::vector<Vec3> is = joint_positions(again), was = joint_positions(source);
    const std::vector<Quat> turned = joint_rotations(again), before = joint_rotations(source);
    double apart = 0, angle = 0;
    for (std::size_t i = 0; i < is.size(); ++i) {
      apart = std::max(apart, length(subtract(is[i], was[i])));
      angle = std::max(angle, angle_between(turned[i], before[i]));
    }
    CHECK(apart < 1e-6 * leg_length(source.skeleton));
    CHECK(degrees(angle) < 1e-3);
  }
}

TEST_CASE("feet stand on the floor in proportion") {
  const Motion source = walk();
  const Retargeter there(source, at_rest(mixamo()));
  CHECK(there.length_scale() == doctest::Approx(0.012));
  const double floor = floor_under(source);
  CHECK(std::abs(floor_under(there.standing(source)) - 0.012 * floor) < 1e-9);
}

TEST_CASE("pieces of a motion stand on the floor of the first one") {
  const Motion source = walk();
  const Retargeter there(source, at_rest(mixamo()));
  const Motion first = slice(source, 0, 20);
  std::optional<double> rise;
  Motion pieces = there.standing(first, rise);
  REQUIRE(rise.has_value());
  CHECK(std::abs(floor_under(pieces) - 0.012 * floor_under(first)) < 1e-9);
  // What the first piece has set holds for the others.
  *rise += 0.25;
  pieces = there.standing(slice(source, 20, source.frames - 20), rise);
  const Motion raw = there(source);
  const std::size_t hips = joint_of(there.map().to, BodyPart::hips);
  for (std::size_t f = 0; f < pieces.frames; ++f)
    CHECK(pieces.position(f, hips)[1] - raw.position(20 + f, hips)[1] == doctest::Approx(*rise));
}

TEST_CASE("a skeleton that is no body without rotations takes its reference from a motion") {
  const Motion source = walk(), strange = along_x(source);
  // The same motion in other local axes.
  const std::vector<Vec3> a = joint_positions(source), b = joint_positions(strange);
  for (std::size_t i = 0; i < a.size(); ++i) REQUIRE(length(subtract(a[i], b[i])) < 1e-9);
  CHECK(says(message_of([&] { Retargeter(slice(strange, 0, 0), at_rest(mixamo())); }),
             "does not stand upright"));
  const Retargeter there(strange, at_rest(mixamo()));
  const Motion made = there.standing(strange);
  CHECK(limbs_apart(strange, there.map().from, made, there.map().to) < 1e-6);
  const Retargeter back(
      RetargetBody{there.skeleton(), reference_pose(there.skeleton(), there.map().to)},
      RetargetBody{strange.skeleton, reference_pose(strange.skeleton, there.map().from, strange)},
      {there.map().to, there.map().from});
  const std::vector<Vec3> again = joint_positions(back(there(strange)));
  for (std::size_t i = 0; i < again.size(); ++i) REQUIRE(length(subtract(again[i], b[i])) < 1e-6);
}

TEST_CASE("feet point as the source's, however they stand in the frame that is the reference") {
  // One frame, in which the body stands on one leg and points the other foot down.
  Motion pointing = slice(walk(), 0, 1);
  for (Quat& q : pointing.rotations) q = {};
  const auto foot = static_cast<std::size_t>(pointing.skeleton.find("RightFoot"));
  pointing.rotation(0, foot) = axis_rotation(0, 1.0);
  const Motion source = walk(), strange = along_x(pointing);
  const Retargeter there(source, strange);
  const Motion made = there(source);
  const std::vector<Vec3> was = joint_positions(source), is = joint_positions(made);
  const std::size_t joints = source.skeleton.size(), other = made.skeleton.size();
  for (const auto& [part, next] : {std::pair{BodyPart::left_foot, BodyPart::left_toe},
                                   std::pair{BodyPart::right_foot, BodyPart::right_toe}})
    for (std::size_t f = 0; f < source.frames; f += 5) {
      const Vec3 a = subtract(was[f * joints + joint_of(there.map().from, next)],
                              was[f * joints + joint_of(there.map().from, part)]),
                 b = subtract(is[f * other + joint_of(there.map().to, next)],
                              is[f * other + joint_of(there.map().to, part)]);
      CHECK(dot(a, b) > (1 - 1e-9) * length(a) * length(b));
    }
}

TEST_CASE("spines of other lengths share the bend; what the source lacks keeps its rest") {
  // A motion that bends only its spine, on a body with one spine joint less and one more.
  Motion bent = slice(walk(), 0, 1);
  for (Quat& q : bent.rotations) q = {};
  for (const char* name : {"Spine", "Spine1", "Spine2"})
    bent.rotation(0, static_cast<std::size_t>(bent.skeleton.find(name))) = quat_from_expmap({0.2, 0, 0});
  const auto with_spine = [&](std::size_t count) {
    Skeleton out;
    std::map<int, int> at;
    int last = -1;
    for (std::size_t j = 0; j < bent.skeleton.size(); ++j) {
      Joint joint = bent.skeleton.joints[j];
      if (joint.name.starts_with("Spine")) {
        if (joint.name == "Spine")
          for (std::size_t k = 0; k < count; ++k) {
            Joint piece = joint;
            piece.name = "Spine" + std::to_string(k);
            piece.parent = k == 0 ? 0 : static_cast<int>(out.size()) - 1;
            piece.offset = {0, 33.0 / static_cast<double>(count), 0};
            out.joints.push_back(piece);
          }
        last = static_cast<int>(out.size()) - 1;
        at[static_cast<int>(j)] = last;
        continue;
      }
      joint.parent = joint.parent < 0 ? -1 : at.at(joint.parent);
      at[static_cast<int>(j)] = static_cast<int>(out.size());
      out.joints.push_back(joint);
    }
    return out;
  };
  for (const std::size_t count : {1u, 2u, 3u, 5u, 7u}) {
    const Skeleton other = with_spine(count);
    const Retargeter there(bent, at_rest(other));
    const Motion made = there(bent);
    const std::vector<Quat> world = joint_rotations(made);
    double most = 0;
    for (std::size_t j = 0; j < other.size(); ++j) {
      const double angle = angle_between(made.rotation(0, j), Quat{});
      if (other.joints[j].name.starts_with("Spine")) most = std::max(most, angle);
    }
    CHECK(angle_between(world[joint_of(there.map().to, BodyPart::head)],
                        joint_rotations(bent)[joint_of(there.map().from, BodyPart::head)]) < 1e-6);
    if (count >= 3) CHECK(most < 0.201);  // no joint bends more than the source's
  }
  const Skeleton mannequin = unreal();
  const Motion made = Retargeter(walk(), at_rest(mannequin))(walk());
  const auto twist = static_cast<std::size_t>(mannequin.find("upperarm_twist_01_l"));
  CHECK(angle_between(made.rotation(9, twist), Quat{}) < 1e-12);
  CHECK(made.rotation(9, 0) == Quat{});
}

TEST_CASE("maps are written, edited and read; mistakes are named") {
  const Scratch scratch;
  std::filesystem::create_directories(scratch.path);
  const auto file = scratch.path / "map.tsv";
  const Skeleton from = walk().skeleton, to = unreal();
  const JointMap found = find_joint_map(from, to);
  write_joint_map(file, found, from, to);
  const JointMap read = read_joint_map(file, from, to);
  CHECK(read.from == found.from);
  CHECK(read.to == found.to);
  const auto edited = [&](const std::string& text) {
    std::ofstream(file) << "part\tto\tfrom\n# mine\n\nhips\tpelvis\tHips\n" << text;
    return message_of([&] { read_joint_map(file, from, to); });
  };
  CHECK(says(edited("left elbow\tlowerarm_l\tLeftForeArm\n"), "map.tsv:5: there is no part 'left elbow'"));
  CHECK(says(edited("spine\tspine_09\tSpine\n"), "goes to has no joint 'spine_09'"));
  CHECK(says(edited("spine\tspine_01\tBack\n"), "comes from has no joint 'Back'"));
  CHECK(says(edited("spine\ta\tb\tc\n"), "4 columns"));
  CHECK(says(edited("head\thead\tHead\n"), "has no joint for the left thigh"));
  // Without the arms, arms keep their rest.
  std::ofstream(file)
      << "hips\tpelvis\tHips\nleft thigh\tthigh_l\tLeftUpLeg\nright thigh\tthigh_r\tRightUpLeg\n"
         "left shin\tcalf_l\tLeftLeg\nright shin\tcalf_r\tRightLeg\nleft foot\tfoot_l\tLeftFoot\n"
         "right foot\tfoot_r\tRightFoot\n";
  const Motion made = Retargeter(walk(), at_rest(to), read_joint_map(file, from, to))(walk());
  CHECK(made.rotation(5, static_cast<std::size_t>(to.find("upperarm_l"))) == Quat{});
  CHECK(made.rotation(5, static_cast<std::size_t>(to.find("thigh_l"))) != Quat{});
}

}  // namespace retarget_test
