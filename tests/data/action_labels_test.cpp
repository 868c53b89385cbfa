// Labels from files, folders and names, and splits by class and by subject.
#include "motiongan/data/action_labels.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "motiongan/data/action_split.hpp"

namespace action_labels_test {

using namespace motiongan;
using namespace motiongan::motion;

TEST_CASE("a label file") {
  const ActionLabels labels = parse_action_labels(
      "\xEF\xBB\xBF# clip id\tlabel\r\n01_01\tjump\r\n\n 02_01 \t slow walk \n01_01\tjump", "labels.tsv");
  CHECK(labels == ActionLabels{{"01_01", "jump"}, {"02_01", "slow walk"}});
  const auto fails = [](const char* text, const char* message) {
    CHECK_THROWS_WITH_AS((void)parse_action_labels(text, "labels.tsv"), doctest::Contains(message), Error);
  };
  fails("a\twalk\nb walk\n", "labels.tsv:2: found no tab in 'b walk'");
  fails("\n\twalk\n", "labels.tsv:2: found no clip id");
  fails("a\t \n", "labels.tsv:1: clip 'a' has no label");
  fails("a\twalk\n#\na\trun\n",
        "labels.tsv:3: clip 'a' has the label 'run', but in line 1 'walk'; a clip has one label");
  fails("a\tw\xFF\n", "labels.tsv:1: found text that is not UTF-8");
  CHECK_THROWS_AS((void)read_action_labels("no/such/file.tsv"), Error);
}

TEST_CASE("folder names as labels") {
  CHECK(label_from_folder("data/walk/01.bvh", "data") == "walk");
  CHECK(label_from_folder("data/walk/subject1/01.bvh", "data/") == "walk");
  CHECK_THROWS_WITH_AS((void)label_from_folder("data/01.bvh", "data"), doctest::Contains("data/01.bvh"),
                       Error);
}

TEST_CASE("patterns extract labels and subjects from names") {
  const auto parse = [](const char* pattern, const char* name) {
    const NameParts parts = NamePattern(pattern).parse(name);
    return parts.label + "|" + parts.subject;
  };
  CHECK(parse("dataset-1_*_{label}_*", "dataset-1_walk_happy_001") == "happy|");
  CHECK(parse("dataset-2_{label}_*", "dataset-2_raise-up-both-hands_active_001") == "raise-up-both-hands|");
  CHECK(parse("{subject}_{label}_*", "anna_walk_3_b") == "walk|anna");
  CHECK(parse("{label}", "walk") == "walk|");
  CHECK(parse("*{label}.{subject}", "x_y_walk.4.5") == "walk|4.5");
  CHECK(parse("S{subject}-*", "S07-run-2") == "|07");
  // Matching may have to backtrack: "aXb" is "a", then "X", then "b".
  CHECK(parse("{label}X{subject}", "aXbXc") == "a|bXc");
  CHECK(parse("*_{label}", "a_b_c") == "c|");

  CHECK_THROWS_WITH_AS((void)NamePattern("a_{label}").parse("b_walk"),
                       doctest::Contains("the name 'b_walk' does not match the pattern 'a_{label}'"), Error);
  CHECK_THROWS_AS((void)NamePattern("{label}").parse("a_b"), Error);
  CHECK_THROWS_AS((void)NamePattern("{label}_x").parse("_x"), Error);
  CHECK_THROWS_AS((void)NamePattern("{label}_{subject}").parse(""), Error);
  CHECK_THROWS_WITH_AS(NamePattern("{label}_{label}"), doctest::Contains("twice"), Error);
  CHECK_THROWS_WITH_AS(NamePattern("{label}{subject}"), doctest::Contains("nothing between"), Error);
  CHECK_THROWS_WITH_AS(NamePattern("{style}_*"), doctest::Contains("{style}_*"), Error);
  CHECK_THROWS_AS(NamePattern(""), Error);
  CHECK(NamePattern("{subject}_*").has_subject());
  CHECK_FALSE(NamePattern("{subject}_*").has_label());
}

TEST_CASE("subjects from names") {
  CHECK(subject_from_name("07_01") == "07");
  CHECK_THROWS_AS((void)subject_from_name("walk"), Error);
  CHECK_THROWS_AS((void)subject_from_name("_walk"), Error);
}

TEST_CASE("each class is split separately") {
  std::vector<SplitClip> clips;
  for (std::size_t i = 0; i < 33; ++i) clips.push_back({i < 21 ? 0u : i < 30 ? 1u : i < 32 ? 2u : 3u, ""});
  const std::vector<bool> a = split_by_class(clips, 4, 0.67, 5);
  const auto trained = [&](const std::vector<bool>& is_train, std::size_t c) {
    int n = 0;
    for (std::size_t i = 0; i < clips.size(); ++i) n += clips[i].label == c && is_train[i];
    return n;
  };
  CHECK(trained(a, 0) == 14);
  CHECK(trained(a, 1) == 6);
  CHECK(trained(a, 2) == 1);
  CHECK(trained(a, 3) == 1);
  CHECK(split_by_class(clips, 4, 0.67, 5) == a);
  CHECK(split_by_class(clips, 4, 0.67, 6) != a);
}

TEST_CASE("splits keep subjects whole") {
  // Class 1 has a training subject only if "b" or "c" is one; sizes 5, 3, 2, 2.
  std::vector<SplitClip> clips;
  for (int i = 0; i < 5; ++i) clips.push_back({0, "a"});
  for (int i = 0; i < 3; ++i) clips.push_back({std::size_t(i > 0), "b"});
  for (int i = 0; i < 2; ++i) clips.push_back({std::size_t(i > 0), "c"});
  for (int i = 0; i < 2; ++i) clips.push_back({0, "d"});
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const std::vector<bool> is_train = split_by_subject(clips, 2, 0.67, seed);
    for (std::size_t i = 1; i < clips.size(); ++i)
      if (clips[i].subject == clips[i - 1].subject) CHECK(is_train[i] == is_train[i - 1]);
    CHECK(std::count(is_train.begin(), is_train.end(), true) == 8);  // 0.67 * 12 = 8.04
    CHECK(is_train[6] != is_train[9]);                               // both parts have both classes
    CHECK(split_by_subject(clips, 2, 0.67, seed) == is_train);
  }
  CHECK_THROWS_AS((void)split_by_subject(clips, 2, 0, 1), Error);
  const std::vector<SplitClip> one(3, SplitClip{0, "a"});
  CHECK(split_by_subject(one, 1, 0.5, 1) == std::vector<bool>(3, true));
  // Two subjects always go to different parts.
  const std::vector<SplitClip> two{{0, "a"}, {0, "b"}};
  const std::vector<bool> both = split_by_subject(two, 1, 1.0, 1);
  CHECK(both[0] != both[1]);

  const std::vector<bool> named = split_off_subjects(clips, {"d", "b"});
  for (std::size_t i = 0; i < clips.size(); ++i)
    CHECK(named[i] == (clips[i].subject == "a" || clips[i].subject == "c"));
  CHECK_THROWS_WITH_AS((void)split_off_subjects(clips, {"e"}), doctest::Contains("a (5 clips), b (3 clips)"),
                       Error);
  CHECK_THROWS_AS((void)split_off_subjects(clips, {"a", "b", "c", "d"}), Error);
}

}  // namespace action_labels_test
