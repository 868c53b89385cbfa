// Skeletons of HumanML3D and KIT-ML, and joint positions read with them.
#include <doctest/doctest.h>

#include <cmath>
#include <motiongan/formats/known_skeletons.hpp>
#include <motiongan/formats/position_npy.hpp>
#include <motiongan/motion/body_side.hpp>
#include <set>
#include <string>
#include <vector>

#include "../support/messages.hpp"
#include "../support/npz_bytes.hpp"

namespace known_skeletons_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

/// The joints of a branch, from `joint` up to the root.
std::vector<std::string> branch(const Skeleton& skeleton, const char* joint) {
  std::vector<std::string> out;
  for (int j = skeleton.find(joint); j >= 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent)
    out.push_back(skeleton.joints[static_cast<std::size_t>(j)].name);
  return out;
}

void check_tree(const Skeleton& skeleton) {
  std::set<std::string> names;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    names.insert(joint.name);
    CHECK((joint.parent == -1) == (j == 0));
    CHECK(joint.parent < static_cast<int>(j));
    CHECK(joint.offset == Vec3{});
    CHECK(joint.channels.empty());
  }
  CHECK(names.size() == skeleton.size());
}

}  // namespace

TEST_CASE("the joints of HumanML3D and KIT-ML") {
  check_tree(humanml3d_skeleton());
  check_tree(kit_ml_skeleton());
  using Names = std::vector<std::string>;
  const Skeleton& h = humanml3d_skeleton();
  CHECK(branch(h, "left_foot") == Names{"left_foot", "left_ankle", "left_knee", "left_hip", "pelvis"});
  CHECK(branch(h, "right_wrist") == Names{"right_wrist", "right_elbow", "right_shoulder", "right_collar",
                                          "spine3", "spine2", "spine1", "pelvis"});
  CHECK(branch(h, "head") == Names{"head", "neck", "spine3", "spine2", "spine1", "pelvis"});
  CHECK(h.find("right_foot") == 11);
  CHECK(h.find("left_wrist") == 20);
  const Skeleton& k = kit_ml_skeleton();
  CHECK(branch(k, "upper_neck") == Names{"upper_neck", "lower_neck", "torso", "pelvis", "root"});
  CHECK(branch(k, "left_wrist") ==
        Names{"left_wrist", "left_elbow", "left_shoulder", "lower_neck", "torso", "pelvis", "root"});
  CHECK(branch(k, "right_foot") ==
        Names{"right_foot", "right_midfoot", "right_ankle", "right_knee", "right_hip", "root"});
  CHECK(k.find("right_hip") == 11);
  CHECK(k.find("left_foot") == 20);
  CHECK(side_of("upper_neck") == Side::centre);
}

TEST_CASE("skeletons by their number of joints") {
  REQUIRE(known_skeleton(22));
  CHECK(*known_skeleton(22) == humanml3d_skeleton());
  REQUIRE(known_skeleton(21));
  CHECK(*known_skeleton(21) == kit_ml_skeleton());
  for (const std::size_t joints : {0, 20, 23, 24, 52}) CHECK(!known_skeleton(joints));
}

TEST_CASE("an array of HumanML3D is read without a bone list") {
  std::vector<double> values;
  for (int f = 0; f < 2; ++f)
    for (int j = 0; j < 22; ++j) values.insert(values.end(), {j * 0.1 + f, 0.5 * j, -0.25 * j});
  const std::string bytes = npy_file("<f4", "(2, 22, 3)", floats(values));
  const auto header = npy_detail::parse_npy_header(bytes, "000021.npy");
  REQUIRE(known_skeleton(header.shape[1]));
  const PositionClip clip =
      parse_position_npy(bytes, *known_skeleton(header.shape[1]), humanml3d_rate, "000021.npy");
  CHECK(clip.frames == 2);
  CHECK(clip.rate == 20);
  CHECK(clip.positions[22 + 21][0] == doctest::Approx(3.1));
  // right_wrist (21) from right_elbow (19): two steps of (0.1, 0.5, -0.25)
  CHECK(length(clip.skeleton.joints[21].offset) == doctest::Approx(2 * std::sqrt(0.3225)));
}

TEST_CASE("feature vectors are refused") {
  const auto told = [](std::vector<std::size_t> shape) {
    return message_of([&] { refuse_feature_vectors(shape, "000021.npy"); });
  };
  CHECK(
      says(told({199, 263}), "000021.npy: the shape is [199, 263]: these are feature vectors of HumanML3D"));
  CHECK(says(told({199, 263}), "give the files of the folder new_joints"));
  CHECK(says(told({199, 251}), "these are feature vectors of KIT-ML"));
  CHECK(told({199, 22, 3}) == "no error");
  CHECK(told({199, 66}) == "no error");
  CHECK(told({263}) == "no error");
}

}  // namespace known_skeletons_test
