// Differences between two skeletons, and their messages.
#include "motiongan/motion/skeleton_match.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "../support/messages.hpp"

namespace skeleton_match_test {

using namespace motiongan;
using namespace motiongan::motion;
using motiongan::testing::message_of, motiongan::testing::says;

namespace {

Skeleton body() {
  Skeleton s;
  for (const auto& [name, parent] : std::vector<std::pair<std::string, int>>{
           {"Hips", -1}, {"LeftLeg", 0}, {"RightLeg", 0}, {"Spine", 0}, {"Head", 3}})
    s.joints.push_back({name, parent, {1, 2, 3}, {}, {}});
  return s;
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("bone lengths, end sites and channels may differ") {
  Skeleton other = body();
  other.joints[4].offset = {7, 8, 9};
  other.joints[4].end_site = Vec3{1, 1, 1};
  other.joints[0].channels = {Channel::x_position};
  CHECK(joint_differences(body(), other).empty());
  CHECK_NOTHROW(require_same_joints(body(), other, "the prior"));
}

TEST_CASE("joints that are missing, extra, renamed or under another parent are named") {
  Skeleton other = body();
  other.joints[0].name = "Pelvis";
  CHECK(joint_differences(body(), other) == Texts{"'Hips' is called 'Pelvis'"});  // and not its children
  other = body();
  other.joints.pop_back();
  CHECK(joint_differences(body(), other) == Texts{"'Head' is missing"});
  CHECK(joint_differences(other, body()) == Texts{"'Head' is extra"});
  other = body();
  other.joints[4].parent = 0;
  CHECK(joint_differences(body(), other) == Texts{"'Head' has parent 'Hips', expected parent 'Spine'"});
  other = body();
  other.joints.insert(other.joints.begin(), {"World", -1, {}, {}, {}});
  for (std::size_t j = 1; j < other.size(); ++j) ++other.joints[j].parent;
  CHECK(joint_differences(body(), other) ==
        Texts{"'Hips' has parent 'World', expected no parent", "'World' is extra"});
  other = body();
  std::swap(other.joints[1], other.joints[2]);
  CHECK(joint_differences(body(), other) ==
        Texts{"joint 1 is 'RightLeg', expected 'LeftLeg': different order",
              "joint 2 is 'LeftLeg', expected 'RightLeg': different order"});
  other = body();
  other.joints.push_back(other.joints[4]);
  CHECK(joint_differences(body(), other) == Texts{"6 joints, expected 5: joint names are not unique"});
}

TEST_CASE("the error lists eight differences and counts the rest") {
  Skeleton long_one = body();
  for (int i = 0; i < 11; ++i) long_one.joints.push_back({"Tail" + std::to_string(i), 0, {}, {}, {}});
  const std::string text = message_of([&] { require_same_joints(body(), long_one, "the prior walk.bvh"); });
  CHECK(
      says(text, "the prior walk.bvh has a different skeleton (16 joints, expected 5): 'Tail0' is extra; "));
  CHECK(says(text, "'Tail7' is extra; and 3 more. Use motion"));
  CHECK(!says(text, "Tail8"));
}

}  // namespace skeleton_match_test
