// AMASS: joint positions against independent values, all pose layouts, the mean body, and errors.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <map>
#include <motiongan/formats/amass.hpp>
#include <motiongan/formats/bvh.hpp>
#include <motiongan/motion/kinematics.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../support/expmap_files.hpp"
#include "../support/messages.hpp"
#include "../support/npz_bytes.hpp"

namespace amass_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

using Arrays = std::map<std::string, std::string>;

std::string npz_file(const Arrays& arrays, bool compress = false) {
  std::vector<ZipPart> parts;
  for (const auto& [name, bytes] : arrays) parts.push_back({name + ".npy", bytes});
  return zip_file(parts, compress);
}

std::string refusal(const Arrays& arrays) {
  return message_of([&] { parse_amass(npz_file(arrays), "a.npz"); });
}

/// Two frames of `width` pose parameters, [2, width]: in the first some joints turn, in the second the body
/// stands upright. `hand` is the first parameter of the right hand's index finger, if there are hands.
std::vector<double> two_poses(std::size_t width, std::size_t hand) {
  std::vector<double> out(2 * width, 0);
  const auto set = [&](std::size_t joint, const Vec3& turn) {
    for (std::size_t k = 0; k < 3; ++k) out[3 * joint + k] = turn[k];
  };
  set(0, {0.3, -0.5, 0.8});   // pelvis
  set(1, {0.4, 0.1, -0.2});   // left hip
  set(4, {1.1, 0, 0});        // left knee
  set(14, {0, 0, 0.3});       // right collar
  set(17, {0.2, -0.7, 0.5});  // right shoulder
  if (hand > 0) set(hand, {0, 0.6, 0.1});
  out[width] = pi / 2;
  return out;
}

const std::vector<double> two_places{0.5, -1.25, 0.9, 1, 2, 3};

Arrays good_arrays(std::size_t width = 156, std::size_t hand = 37) {
  return {{"poses", npy_file("<f8", "(2, " + std::to_string(width) + ")", doubles(two_poses(width, hand)))},
          {"trans", npy_file("<f8", "(2, 3)", doubles(two_places))},
          {"mocap_framerate", npy_file("<f8", "()", doubles({120}))},
          {"gender", npy_file("<U4", "()", std::string(16, 'x'))},
          {"betas", npy_file("<f8", "(1,)", doubles({0.7}))}};
}

void check_near(const Vec3& found, const Vec3& expected) {
  for (std::size_t k = 0; k < 3; ++k) CHECK(found[k] == doctest::Approx(expected[k]).epsilon(1e-9));
}

Vec3 place(const Motion& motion, std::size_t frame, const char* joint) {
  const int j = motion.skeleton.find(joint);
  REQUIRE(j >= 0);
  return joint_positions(motion)[frame * motion.skeleton.size() + static_cast<std::size_t>(j)];
}

// Computed with NumPy: rotation matrices by Rodrigues' formula, G(pelvis) = U R with U: (x, y, z) -> (x, z,
// -y), the pelvis at U trans, and along each branch p(child) = p + 1.70 G offset with the published fractions
// of stature (hip joints 0.191 / 4 beside and 0.020 below the pelvis, thigh 0.245, shank 0.246; spine
// (0.818 - 0.550) / 4, collar 0.030, shoulder 0.129, upper arm 0.186, forearm 0.146, hand 0.108).
void check_first_frame(const Motion& motion) {
  check_near(place(motion, 0, "pelvis"), {0.5, 0.9, 1.25});
  check_near(place(motion, 0, "left_knee"), {0.849470600464, 0.735522055071, 1.457821343393});
  check_near(place(motion, 0, "left_ankle"), {0.959278038239, 0.352731108319, 1.330131650408});
  check_near(place(motion, 0, "right_wrist"), {0.247947123253, 0.325318933514, 1.327746736522});
}

}  // namespace

TEST_CASE("SMPL-H poses on the mean body, stored and deflated") {
  for (const bool compress : {false, true}) {
    const Motion motion = parse_amass(npz_file(good_arrays(), compress), "a.npz");
    CHECK(motion.rate == 120);
    CHECK(motion.frames == 2);
    CHECK(motion.skeleton.size() == 52);
    check_first_frame(motion);
    check_near(place(motion, 0, "right_index2"), {0.281582362178, 0.243871775841, 1.424877175874});
  }
}

TEST_CASE("an upright body of z-up data is upright with y up") {
  const Motion motion = parse_amass(npz_file(good_arrays()), "a.npz");
  check_near(place(motion, 1, "pelvis"), {1, 3, -2});
  CHECK(angle_between(motion.rotation(1, 0), {}) < 1e-12);
  // 0.870 - 0.550 of the stature above the pelvis
  check_near(place(motion, 1, "head"), {1, 3 + 1.70 * 0.320, -2});
  CHECK(place(motion, 1, "left_wrist")[0] > 1.7);      // left at +x
  CHECK(place(motion, 1, "left_foot")[2] > -2 + 0.1);  // facing +z
}

TEST_CASE("poses of SMPL, SMPL-X and of the body only") {
  const std::vector<std::pair<std::size_t, std::size_t>> layouts{{66, 0}, {72, 0}, {165, 40}};
  for (const auto& [width, hand] : layouts) {
    const Motion motion = parse_amass(npz_file(good_arrays(width, hand)), "a.npz");
    CHECK(motion.skeleton.size() == (width == 165 ? 52 : 22));
    check_first_frame(motion);
    if (width == 165)
      check_near(place(motion, 0, "right_index2"), {0.281582362178, 0.243871775841, 1.424877175874});
  }
}

TEST_CASE("other numbers and names in the arrays") {
  Arrays arrays = good_arrays();
  arrays.erase("mocap_framerate");
  arrays["mocap_frame_rate"] = npy_file("<i8", "()", little(60, 8));
  arrays["trans"] = npy_file("<f8", "(2, 3)", doubles({0.5, 1, -1.25, 2, 0.9, 3}), true);
  const ExpmapFolder folder;
  folder.write("a.npz", npz_file(arrays, true));
  const Motion motion = read_amass(folder.path() / "a.npz");
  CHECK(motion.rate == 60);
  check_first_frame(motion);
  CHECK(says(message_of([] { read_amass("absent.npz"); }), "absent.npz does not exist"));
}

TEST_CASE("the mean body") {
  const Skeleton body = mean_body_skeleton(true), without = mean_body_skeleton(false);
  CHECK(without.size() == 22);
  CHECK(body.channel_count() == 3 + 3 * 52);
  for (const Joint& joint : body.joints) {
    if (!joint.name.starts_with("left_")) continue;
    const int other = body.find("right_" + joint.name.substr(5));
    REQUIRE(other >= 0);
    const Joint& right = body.joints[static_cast<std::size_t>(other)];
    CHECK(right.offset == Vec3{-joint.offset[0], joint.offset[1], joint.offset[2]});
    CHECK(right.end_site.has_value() == joint.end_site.has_value());
  }
  Motion rest;
  rest.skeleton = without;
  rest.rate = 1;
  rest.frames = 1;
  rest.rotations.resize(22);
  for (const Joint& joint : without.joints) rest.positions.push_back(joint.offset);
  const GlobalPose pose = forward_kinematics(rest);
  const std::vector<Vec3> ends = end_site_positions(rest, pose);  // toes, toes, top of the head, hand, hand
  REQUIRE(ends.size() == 5);
  CHECK(ends[2][1] - ends[0][1] == doctest::Approx(1.70 * (1 - 0.012)));
  CHECK(ends[3][0] - ends[4][0] == doctest::Approx(2 * 1.70 * (0.129 + 0.186 + 0.146 + 0.108)));
  CHECK(parse_hierarchy(format_hierarchy(body), "body") == body);
}

TEST_CASE("files that are not AMASS motions are errors") {
  Arrays arrays = good_arrays();
  arrays.erase("poses");
  CHECK(
      says(refusal(arrays), "a.npz: there is no array 'poses'; the file has betas, gender, mocap_framerate"));
  arrays = good_arrays();
  arrays["poses"] = npy_file("<f8", "(2, 4)", doubles(std::vector<double>(8)));
  CHECK(says(refusal(arrays), "a.npz: 'poses' has the shape [2, 4], expected [frames, 156] (SMPL-H)"));
  arrays["poses"] = npy_file("<f8", "(0, 156)", "");
  CHECK(says(refusal(arrays), "a.npz: 'trans' has the shape [2, 3], expected [0, 3]"));
  arrays["trans"] = npy_file("<f8", "(0, 3)", "");
  CHECK(says(refusal(arrays), "a.npz: found no frames"));
  arrays = good_arrays();
  arrays["trans"] = npy_file("<f8", "(6,)", doubles(two_places));
  CHECK(says(refusal(arrays), "'trans' has the shape [6], expected [2, 3]"));
  arrays = good_arrays();
  arrays.erase("mocap_framerate");
  CHECK(says(refusal(arrays), "there is no array 'mocap_framerate'"));
  arrays["mocap_framerate"] = npy_file("<f8", "()", doubles({0}));
  CHECK(says(refusal(arrays),
             "'mocap_framerate' has the shape [] and begins with 0, expected one number above 0"));
  arrays = good_arrays();
  std::vector<double> poses = two_poses(156, 37);
  poses[156 + 3 * 4] = std::numeric_limits<double>::quiet_NaN();
  arrays["poses"] = npy_file("<f8", "(2, 156)", doubles(poses));
  CHECK(says(refusal(arrays), "a.npz: frame 2, left_knee: found nan, expected a finite number"));
  arrays = good_arrays();
  arrays["trans"] =
      npy_file("<f8", "(2, 3)", doubles({0, std::numeric_limits<double>::infinity(), 0, 0, 0, 0}));
  CHECK(says(refusal(arrays), "a.npz: frame 1, trans: found inf"));
}

}  // namespace amass_test
